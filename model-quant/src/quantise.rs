//! From a float checkpoint to a model image.
//!
//! Weights: 8 bits per output channel, the largest one at 127. Activations: 16 bits per layer, the largest value of
//! the calibration set (no percentile: the tail is the signal) plus a sixteenth at full scale. The friction
//! network is calibrated on what the quantised collision network gives. Biases and accumulators: 32 bits.

use crate::checkpoint::Checkpoint;
use crate::draw::{Draw, Purpose};
use crate::net::{Net, Taps, Trace};
use crate::round::{level, step, steps};
use crate::rows::{Row, rows};
use crate::window::{friction_over, history};
use inference::encode::{ConvolutionParts, HeadParts, NetworkParts, write};
use inference::features::quantise as quantise_features;
use inference::layout::{
    CHANNELS, COLLISION_TAPS, FRICTION_TAPS, HEAD_WEIGHTS, IMAGE_LENGTH, KERNEL, WINDOW,
};
use inference::{ContactState, Header, ImageError, Model, Stream};

/// Rows of the calibration set.
pub const CALIBRATION_ROWS: usize = 1 << 14;
/// Full scale of a layer over its largest activation in the calibration set.
const HEADROOM: f64 = 17.0 / 16.0;
const FULL_SCALE: f64 = 32767.0;

/// Why a checkpoint could not be quantised.
#[derive(Debug, thiserror::Error)]
pub enum QuantiseError {
    /// A layer's factor does not fit its 32 bits: the weights and the activations do not belong together.
    #[error(
        "convolution {layer}, channel {channel}: requantisation factor is {factor:e}, expected 2^-32 to 0.5"
    )]
    Factor {
        /// Index of the convolution.
        layer: usize,
        /// Output channel.
        channel: usize,
        /// The factor.
        factor: f64,
    },
    /// The image was refused by the code that runs it.
    #[error("{0}")]
    Image(#[from] ImageError),
}

/// Largest activation after each convolution.
type Largest = [f32; 3];

fn watch<const T: usize>(net: &Net<T>, columns: &[f32], trace: &mut Trace, largest: &mut Largest) {
    net.forward(columns, trace);
    let layers = [trace.first.as_flattened(), trace.second.as_flattened(), trace.third.as_flattened()];
    for (largest, layer) in largest.iter_mut().zip(layers) {
        *largest = layer.iter().fold(*largest, |a, &b| a.max(b));
    }
}

fn bias_level(bias: f32, scale: f64) -> i32 {
    libm::round(f64::from(bias) / scale) as i32
}

fn convolution<const T: usize>(
    layer: usize,
    taps: &Taps<T>,
    bias: &[f32; CHANNELS],
    input_scale: f64,
    output_scale: f64,
) -> Result<ConvolutionParts<T>, QuantiseError> {
    let steps = steps(taps);
    let mut parts =
        ConvolutionParts { biases: [0; CHANNELS], multipliers: [0; CHANNELS], weights: [[0; T]; CHANNELS] };
    for channel in 0..CHANNELS {
        let scale = input_scale * f64::from(steps[channel]);
        parts.biases[channel] = bias_level(bias[channel], scale);
        let factor = scale / output_scale;
        let multiplier = libm::round(factor * 4_294_967_296.0);
        if !(multiplier >= 1.0 && multiplier <= f64::from(i32::MAX)) {
            return Err(QuantiseError::Factor { layer, channel, factor });
        }
        parts.multipliers[channel] = multiplier as i32;
        for (weight, row) in parts.weights[channel].iter_mut().zip(taps) {
            *weight = level(row[channel], steps[channel]) as i8;
        }
    }
    Ok(parts)
}

fn network<const T: usize>(net: &Net<T>, largest: Largest) -> Result<NetworkParts<T>, QuantiseError> {
    let scales = largest.map(|largest| (f64::from(largest).max(1e-6) * HEADROOM) / FULL_SCALE);
    let head_step = step(net.head.iter().copied());
    let head_scale = scales[2] * f64::from(head_step);
    let mut weights = [0; HEAD_WEIGHTS];
    for (slot, &weight) in weights.iter_mut().zip(&net.head) {
        *slot = level(weight, head_step) as i8;
    }
    Ok(NetworkParts {
        first: convolution(0, &net.first, &net.first_bias, 1.0 / FULL_SCALE, scales[0])?,
        second: convolution(1, &net.second, &net.second_bias, scales[0], scales[1])?,
        third: convolution(2, &net.third, &net.third_bias, scales[1], scales[2])?,
        head: HeadParts { scale: head_scale as f32, bias: bias_level(net.head_bias[0], head_scale), weights },
    })
}

/// A network that gives 0, to stand in while the other one is calibrated.
fn silent<const T: usize>() -> NetworkParts<T> {
    fn layer<const T: usize>() -> ConvolutionParts<T> {
        ConvolutionParts { biases: [0; CHANNELS], multipliers: [1; CHANNELS], weights: [[0; T]; CHANNELS] }
    }
    let head = HeadParts { scale: 1.0, bias: 0, weights: [0; HEAD_WEIGHTS] };
    NetworkParts { first: layer(), second: layer(), third: layer(), head }
}

/// The histories of the calibration rows.
fn calibration(checkpoint: &Checkpoint, header: &Header) -> Vec<(Row, [ContactState; WINDOW])> {
    let recipe = &checkpoint.recipe;
    let drawn =
        rows(checkpoint.bearing, recipe.range, recipe.seed, Purpose::CalibrationRows, CALIBRATION_ROWS);
    (drawn.into_iter().enumerate())
        .map(|(index, row)| {
            let mut draw = Draw::new(recipe.seed, Purpose::FixedHistories, 1 << 32 | index as u64);
            let states = history(header, &row, &mut draw);
            (row, states)
        })
        .collect()
}

/// Quantises both networks of a checkpoint, whose file has this training id, and checks that the image loads.
pub fn quantise(checkpoint: &Checkpoint, training_id: u64) -> Result<Box<[u8; IMAGE_LENGTH]>, QuantiseError> {
    let header = Header { training_id, ..checkpoint.header() };
    let set = calibration(checkpoint, &header);
    let mut trace = Trace::default();

    let mut largest = Largest::default();
    for (_, states) in &set {
        let columns = states.map(|state| header.collision_column(&state).inputs);
        watch(&checkpoint.collision.tuned, columns.as_flattened(), &mut trace, &mut largest);
    }
    let collision = network(&checkpoint.collision.tuned, largest)?;
    let mut image = Box::new([0; IMAGE_LENGTH]);
    write(&header, &collision, &silent::<FRICTION_TAPS>(), &mut image);

    let mut largest = Largest::default();
    {
        let model = Model::load(image.as_slice())?;
        let mut stream = Stream::<COLLISION_TAPS>::default();
        for (_, states) in &set {
            let roots = states.map(|state| {
                let column = header.collision_column(&state);
                let (raw, _) = stream.step(model.collision(), &quantise_features(&column.inputs));
                raw.max(0) as f32 * model.collision().head.scale() * column.root_force_factor
            });
            let window = friction_over(&header, states, &roots, 0.0);
            watch(&checkpoint.friction.tuned, window.columns.as_flattened(), &mut trace, &mut largest);
        }
    }
    let friction = network(&checkpoint.friction.tuned, largest)?;
    write(&header, &collision, &friction, &mut image);
    Model::load(image.as_slice())?;
    Ok(image)
}

const _: () = assert!(COLLISION_TAPS.is_multiple_of(KERNEL));
