//! Quantisation: from a float checkpoint to a model image.
//!
//! The full scale of each layer's activations is the largest value over the calibration set plus a
//! sixteenth. It is not a percentile, because the largest forces matter most. The friction network
//! is calibrated with the outputs of the quantised collision network. Modes with 8-bit weights take
//! the weights that were trained on the grid, the reference mode takes the float weights.

mod error;
pub(crate) mod fixed_point;
pub(crate) mod head_sums;
pub mod image;
pub mod mode;
pub(crate) mod weight_grid;

pub(crate) use error::QuantiseError;

use crate::data::draw::{Draw, HistorySet, Purpose};
use crate::data::features::FloatFeatures;
use crate::data::rows::draw_rows;
use crate::data::window::draw_history;
use crate::network::checkpoint::{Checkpoint, Trained};
use crate::network::{Network, NetworkKind};
use crate::quantise::fixed_point::{Activations, Layer, quantise_layers};
use crate::quantise::image::{AlignedImage, AnyModel};
use crate::quantise::mode::{Mode, Plan};
use inference::chain::Sums;
use inference::features::{FULL_SCALE, Features};
use inference::fixed::scaled_root;
use inference::image::write::{image, image_length};
use inference::model::{Between, CONVOLUTIONS};
use inference::{ContactState, Header, Model, Streaming, WINDOW};

/// Number of calibration rows: enough that the largest activation is stable to a few percent.
pub(crate) const CALIBRATION_ROWS: usize = 1 << 14;

/// Largest activation after each convolution.
type Largest = [f32; CONVOLUTIONS];

/// A finished image with the formats of its activations.
#[derive(Clone, Debug)]
pub struct Quantised {
    /// The image.
    pub image: AlignedImage,
    /// Formats after the convolutions of the collision and of the friction network.
    pub activations: [[Activations; CONVOLUTIONS]; 2],
}

fn update_maxima(network: &Network, columns: &[f32], largest: &mut Largest) {
    for (largest, layer) in largest.iter_mut().zip(network.activations(columns)) {
        *largest = layer.iter().fold(*largest, |a, &b| a.max(b));
    }
}

/// Weights of a network that a mode quantises.
pub(crate) fn weights(trained: &Trained, mode: Mode) -> &Network {
    if mode.has_narrow_weights() { &trained.tuned } else { &trained.float }
}

/// Histories of the calibration rows.
fn calibration(checkpoint: &Checkpoint, features: &FloatFeatures) -> Vec<[ContactState; WINDOW]> {
    let recipe = &checkpoint.recipe;
    let drawn =
        draw_rows(checkpoint.bearing, recipe.range, recipe.seed, Purpose::CalibrationRows, CALIBRATION_ROWS);
    (drawn.iter().enumerate())
        .map(|(index, row)| {
            let mut draw = Draw::history(recipe.seed, HistorySet::Calibration, index as u64);
            draw_history(features, row, &mut draw)
        })
        .collect()
}

fn assemble(header: &Header, collision: &[Layer], friction: &[Layer]) -> Result<AlignedImage, QuantiseError> {
    let parts: Vec<_> = collision.iter().chain(friction).map(Layer::parts).collect();
    let mut written = AlignedImage::zeros(image_length(parts.iter().map(|part| &part.shape)));
    image(header, &parts, written.bytes_mut())?;
    Ok(written)
}

/// Runs a quantised collision network along histories and passes on the square roots of the normal
/// force in N, times 2^16.
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
            scaled_root(model.collision().scale().apply(sum, 16), column.root_force_factor_q30)
        });
        found(states, roots);
    }
}

/// Largest activations of the friction network fed by a quantised collision network.
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
        update_maxima(network, columns.as_flattened(), &mut largest);
    });
    largest
}

/// Quantises both networks of a checkpoint with the given training id and checks that the image
/// loads.
///
/// # Errors
///
/// The image format cannot represent the weights.
pub fn quantise(checkpoint: &Checkpoint, training_id: u64, plan: Plan) -> Result<Quantised, QuantiseError> {
    let header = Header { training_id, ..checkpoint.header() };
    let features = FloatFeatures::from_header(&header);
    let set = calibration(checkpoint, &features);
    let collision_net = weights(&checkpoint.collision, plan.mode);
    let friction_net = weights(&checkpoint.friction, plan.mode);

    let mut largest = Largest::default();
    for states in &set {
        let columns = states.map(|state| features.collision(&state).inputs);
        update_maxima(collision_net, columns.as_flattened(), &mut largest);
    }
    let collision = quantise_layers(collision_net, &largest, plan)?;
    // A network of zeros takes the place of the friction network until that is calibrated.
    let stand_in =
        quantise_layers(&Network::zero(NetworkKind::Friction.shape()), &[1.0; CONVOLUTIONS], plan)?;
    let half_done = assemble(&header, &collision, &stand_in)?;
    let largest_friction = match AnyModel::load(&half_done)? {
        AnyModel::Sixteen(model) => calibrate_friction(friction_net, &model, &set),
        AnyModel::Eight(model) => calibrate_friction(friction_net, &model, &set),
    };
    let friction = quantise_layers(friction_net, &largest_friction, plan)?;
    let image = assemble(&header, &collision, &friction)?;
    AnyModel::load(&image)?;
    let activations =
        [largest, largest_friction].map(|largest| largest.map(|l| Activations::up_to(l, plan.mode)));
    Ok(Quantised { image, activations })
}
