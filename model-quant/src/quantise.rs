//! From a float checkpoint to a model image.
//!
//! Activations: the largest value of the calibration set (no percentile: the tail is the signal) plus a sixteenth at full
//! scale, per layer. The friction network is calibrated on what the quantised collision network gives. Modes with 8-bit
//! weights take the weights that were trained on to their grid, the reference mode takes the free ones.

use crate::checkpoint::Checkpoint;
use crate::draw::{Draw, Purpose};
use crate::features::FloatFeatures;
use crate::image::{AlignedImage, AnyModel};
use crate::mode::{Mode, Plan};
use crate::network::Network;
use crate::parameters::{Activations, Layer, network};
use crate::rows::rows;
use crate::shapes::{self, CONVOLUTIONS};
use crate::train::Trained;
use crate::window::history;
use inference::chain::Sums;
use inference::features::{FULL_SCALE, Features};
use inference::image::write::{WriteError, image, image_length};
use inference::model::Between;
use inference::{ContactState, Header, ImageError, Model, Streaming, WINDOW};

/// Rows of the calibration set.
pub const CALIBRATION_ROWS: usize = 1 << 14;

/// Why a checkpoint could not be quantised.
#[derive(Debug, thiserror::Error)]
pub enum QuantiseError {
    /// A layer's factor does not fit its 32 bits: the weights and the activations do not belong together.
    #[error(
        "layer {layer}, channel {channel}: factor between the scales is {factor:e}, expected 2^-32 to 0.5"
    )]
    Factor {
        /// Index of the layer.
        layer: usize,
        /// Output channel.
        channel: usize,
        /// The factor.
        factor: f64,
    },
    /// Weights over the inputs' full scale, or what comes out of a layer, are beyond f32.
    #[error("layer {layer}: {what} beyond the range of f32, expected finite ones")]
    Infinite {
        /// Index of the layer.
        layer: usize,
        /// Weights or activations.
        what: &'static str,
    },
    /// A layer is larger than an image can say.
    #[error("layer {layer}: {what}: found {size}, more than the image's field holds")]
    Size {
        /// Index of the layer.
        layer: usize,
        /// Which size.
        what: &'static str,
        /// The size.
        size: usize,
    },
    /// The image was refused by the code that runs it.
    #[error("{0}")]
    Image(#[from] ImageError),
    /// The image could not be written.
    #[error("{0}")]
    Write(#[from] WriteError),
}

/// Largest activation after each convolution.
type Largest = [f32; CONVOLUTIONS];

/// A finished image and the scales that it was made with.
#[derive(Clone, Debug)]
pub struct Quantised {
    /// The image.
    pub image: AlignedImage,
    /// Activations behind the convolutions of the collision and of the friction network.
    pub activations: [[Activations; CONVOLUTIONS]; 2],
}

fn watch(network: &Network, columns: &[f32], largest: &mut Largest) {
    for (largest, layer) in largest.iter_mut().zip(network.activations(columns)) {
        *largest = layer.iter().fold(*largest, |a, &b| a.max(b));
    }
}

/// The weights of a network that a mode starts from.
pub fn weights(trained: &Trained, mode: Mode) -> &Network {
    if mode.has_narrow_weights() { &trained.tuned } else { &trained.float }
}

/// The histories of the calibration rows.
fn calibration(checkpoint: &Checkpoint, features: &FloatFeatures) -> Vec<[ContactState; WINDOW]> {
    let recipe = &checkpoint.recipe;
    let drawn =
        rows(checkpoint.bearing, recipe.range, recipe.seed, Purpose::CalibrationRows, CALIBRATION_ROWS);
    (drawn.iter().enumerate())
        .map(|(index, row)| {
            let mut draw = Draw::new(recipe.seed, Purpose::FixedHistories, 1 << 32 | index as u64);
            history(features, row, &mut draw)
        })
        .collect()
}

fn assemble(header: &Header, collision: &[Layer], friction: &[Layer]) -> Result<AlignedImage, QuantiseError> {
    let parts: Vec<_> = collision.iter().chain(friction).map(Layer::parts).collect();
    let mut written = AlignedImage::zeros(image_length(parts.iter().map(|part| &part.shape)));
    image(header, &parts, written.bytes_mut())?;
    Ok(written)
}

/// The square roots of the normal force in N, times 2^16, that a quantised collision network gives along histories.
pub(crate) fn roots<'s, B: Between>(
    model: &Model<'_, B>,
    histories: impl IntoIterator<Item = &'s [ContactState; WINDOW]>,
    mut found: impl FnMut(&'s [ContactState; WINDOW], [u32; WINDOW]),
) {
    let features = Features::new(model.header());
    let mut stream = Streaming::<_, i16, _>::new(*model.collision());
    for states in histories {
        let roots = states.map(|state| {
            let column = features.collision(&state.sample().unwrap_or_default());
            let (Sums([sum]), _) = stream.push(&column.inputs);
            let root = u64::from(model.collision().scale().apply(sum, 16));
            u32::try_from((root * u64::from(column.root_force_factor_q30)) >> 30).unwrap_or(u32::MAX)
        });
        found(states, roots);
    }
}

/// Largest activations of the friction network behind a quantised collision network.
fn calibrate_friction<B: Between>(
    network: &Network,
    model: &Model<'_, B>,
    set: &[[ContactState; WINDOW]],
) -> Largest {
    let features = Features::new(model.header());
    let mut largest = Largest::default();
    roots(model, set, |states, roots| {
        let columns: [_; WINDOW] = core::array::from_fn(|k| {
            let speed = states[k].sample().unwrap_or_default().sliding_speed_nm_s;
            features.friction(roots[k], speed).map(|level| f32::from(level) / f32::from(FULL_SCALE))
        });
        watch(network, columns.as_flattened(), &mut largest);
    });
    largest
}

/// Quantises both networks of a checkpoint, whose file has this training id, and checks that the image loads.
///
/// # Errors
///
/// Weights that the image cannot hold.
pub fn quantise(checkpoint: &Checkpoint, training_id: u64, plan: Plan) -> Result<Quantised, QuantiseError> {
    let header = Header { training_id, ..checkpoint.header() };
    let features = FloatFeatures::of(&header);
    let set = calibration(checkpoint, &features);
    let collision_net = weights(&checkpoint.collision, plan.mode);
    let friction_net = weights(&checkpoint.friction, plan.mode);

    let mut largest = Largest::default();
    for states in &set {
        let columns = states.map(|state| features.collision(&state).inputs);
        watch(collision_net, columns.as_flattened(), &mut largest);
    }
    let collision = network(collision_net, &largest, plan)?;
    // A network of zeros stands in for the friction network until that is calibrated.
    let stand_in = network(&Network::zero(shapes::friction()), &[1.0; CONVOLUTIONS], plan)?;
    let half_done = assemble(&header, &collision, &stand_in)?;
    let largest_friction = match AnyModel::load(&half_done)? {
        AnyModel::Sixteen(model) => calibrate_friction(friction_net, &model, &set),
        AnyModel::Eight(model) => calibrate_friction(friction_net, &model, &set),
    };
    let friction = network(friction_net, &largest_friction, plan)?;
    let image = assemble(&header, &collision, &friction)?;
    AnyModel::load(&image)?;
    let activations =
        [largest, largest_friction].map(|largest| largest.map(|l| Activations::up_to(l, plan.mode)));
    Ok(Quantised { image, activations })
}
