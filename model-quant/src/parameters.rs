//! One network in whole numbers: weights on grids per output channel, biases, multipliers.
//!
//! | weights | step of a channel |
//! |---|---|
//! | 8 bits | its largest weight is 127 steps: the grid that the training put the weights on |
//! | up to 16 bits | the smallest for which no weight exceeds 32767 steps and \|bias\| + sum \|weight\| 2^15 stays below 2^31 |

use crate::mode::{Mode, Packing, Plan};
use crate::network::Network;
use crate::quantise::QuantiseError;
use crate::round::{level, step};
use inference::Scale;
use inference::image::write::LayerParts;
use inference::image::{LayerKind, LayerShape, WeightForm};

/// Full scale of a layer over its largest activation in the calibration set.
const HEADROOM: f64 = 17.0 / 16.0;

/// Activations of a layer in whole numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Activations {
    /// Width in bits.
    pub bits: u8,
    /// What one count is worth.
    pub step: f64,
}

impl Activations {
    /// Features: 16 bits, 1 at full scale.
    pub const FEATURES: Self = Self { bits: 16, step: 1.0 / 32767.0 };

    /// Activations with their largest value, plus a sixteenth, at full scale.
    pub fn up_to(largest: f32, mode: Mode) -> Self {
        let bits: u8 = if mode == Mode::W8a8 { 8 } else { 16 };
        Self { bits, step: f64::from(largest).max(1e-6) * HEADROOM / f64::from((1u32 << (bits - 1)) - 1) }
    }

    /// Largest number of counts.
    pub fn full_scale(&self) -> f64 {
        f64::from((1u32 << (self.bits - 1)) - 1)
    }
}

/// Weights and bias of one output channel in whole numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// What one count of a weight is worth.
    pub step: f64,
    /// The weights.
    pub weights: Vec<i16>,
    /// The bias, at the sum's scale.
    pub bias: i32,
}

/// Bias in counts of the sum.
fn bias_level(bias: f32, inputs: &Activations, step: f64) -> f64 {
    libm::round(f64::from(bias) / (inputs.step * step))
}

impl Channel {
    /// The finest step that a channel's weights may have.
    fn finest_step(weights: &[f32], bias: f32, inputs: &Activations, mode: Mode) -> f64 {
        if mode.has_narrow_weights() {
            return f64::from(step(weights.iter().copied()));
        }
        let room = f64::from(i32::MAX);
        let lowest = libm::exp2(f64::from(inputs.bits) - 1.0);
        let fits = |step: f64| {
            let levels = || weights.iter().map(|&weight| libm::round(f64::from(weight) / step).abs());
            let sum: f64 = levels().sum();
            let largest = levels().fold(0.0, f64::max);
            largest <= f64::from(i16::MAX) && bias_level(bias, inputs, step).abs() + sum * lowest <= room
        };
        let magnitude = |weight: &f32| f64::from(weight.abs());
        let largest = weights.iter().map(magnitude).fold(0.0, f64::max);
        let sum: f64 = weights.iter().map(magnitude).sum();
        let needed = (sum * lowest + f64::from(bias).abs() / inputs.step) / room;
        // A bound without the rounding; a step or two of 2^-12 make room for it.
        let mut step = (largest / f64::from(i16::MAX)).max(needed).max(1e-9);
        while !fits(step) {
            step *= 1.0 + 1.0 / 4096.0;
        }
        step
    }

    /// Puts a channel's weights on a grid.
    fn on(step: f64, weights: &[f32], bias: f32, inputs: &Activations, mode: Mode) -> Self {
        let levels = weights.iter().map(|&weight| {
            if mode.has_narrow_weights() {
                level(weight, step as f32) as i16
            } else {
                libm::round(f64::from(weight) / step) as i16
            }
        });
        Self { step, weights: levels.collect(), bias: bias_level(bias, inputs, step) as i32 }
    }

    /// Puts a channel's weights on their own grid.
    pub fn of(weights: &[f32], bias: f32, inputs: &Activations, mode: Mode) -> Self {
        Self::on(Self::finest_step(weights, bias, inputs, mode), weights, bias, inputs, mode)
    }
}

/// The channels of one layer of a network on their grids. A head has one grid for all its outputs, because it has one scale.
pub fn channels(network: &Network, layer: usize, inputs: &Activations, mode: Mode) -> Vec<Channel> {
    let Some(found) = network.layers().get(layer) else { return Vec::new() };
    let outputs = found.biases.len();
    let weights =
        |output: usize| -> Vec<f32> { found.weights.iter().skip(output).step_by(outputs).copied().collect() };
    let mut steps: Vec<f64> = (found.biases.iter().enumerate())
        .map(|(output, &bias)| Channel::finest_step(&weights(output), bias, inputs, mode))
        .collect();
    if layer + 1 == network.layers().len() {
        let coarsest = steps.iter().copied().fold(0.0, f64::max);
        steps.fill(coarsest);
    }
    (found.biases.iter().zip(steps).enumerate())
        .map(|(output, (&bias, step))| Channel::on(step, &weights(output), bias, inputs, mode))
        .collect()
}

/// Puts weights back into a layer of a float network: every channel's weights, in floats again.
pub fn put_back(network: &mut Network, layer: usize, channels: &[Channel]) {
    let Some(slice) = network.slices_mut().nth(2 * layer) else { return };
    for (tap, row) in slice.chunks_mut(channels.len().max(1)).enumerate() {
        for (slot, channel) in row.iter_mut().zip(channels) {
            let level = channel.weights.get(tap).copied().unwrap_or_default();
            *slot = (f64::from(level) * channel.step) as f32;
        }
    }
}

/// One layer in whole numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    shape: LayerShape,
    biases: Vec<i32>,
    multipliers: Vec<i32>,
    scale: Scale,
    weights: Vec<i16>,
}

impl Layer {
    /// The layer as the image writer takes it.
    pub fn parts(&self) -> LayerParts<'_> {
        LayerParts {
            shape: self.shape,
            biases: &self.biases,
            multipliers: &self.multipliers,
            scale: self.scale,
            weights: &self.weights,
        }
    }
}

/// A scale with full precision.
fn scale(value: f64) -> Option<Scale> {
    let (mantissa, exponent) = libm::frexp(value);
    let multiplier = libm::round(mantissa * f64::from(1u32 << 31)).min(f64::from(i32::MAX)) as i32;
    let shift = u32::try_from(31 - exponent).ok()?;
    (multiplier > 0).then_some(Scale { multiplier, shift })
}

fn narrowed<T: TryFrom<usize>>(layer: usize, what: &'static str, size: usize) -> Result<T, QuantiseError> {
    T::try_from(size).map_err(|_| QuantiseError::Size { layer, what, size })
}

/// A network in whole numbers; `largest` are its largest activations behind each convolution.
///
/// # Errors
///
/// A factor between two scales that its 32 bits cannot hold, a layer too large for the image.
pub fn network(network: &Network, largest: &[f32], plan: Plan) -> Result<Vec<Layer>, QuantiseError> {
    let mut inputs = Activations::FEATURES;
    let mut layers = Vec::with_capacity(network.layers().len());
    for (layer, size) in network.shape().layers().iter().enumerate() {
        let channels = channels(network, layer, &inputs, plan.mode);
        let outputs = largest.get(layer).map(|&largest| Activations::up_to(largest, plan.mode));
        let wide = !plan.mode.has_narrow_weights() || plan.packing == Packing::Speed;
        let shape = LayerShape {
            kind: if outputs.is_some() { LayerKind::Convolution } else { LayerKind::Head },
            columns: narrowed(layer, "columns", size.kernel)?,
            inputs: narrowed(layer, "inputs", size.inputs)?,
            outputs: narrowed(layer, "outputs", size.outputs)?,
            input_bits: inputs.bits,
            output_bits: outputs.map_or(32, |outputs| outputs.bits),
            form: if inputs.bits == 16 && wide { WeightForm::Wide } else { WeightForm::Packed },
        };
        let mut multipliers = Vec::new();
        let mut head_scale = Scale { multiplier: 1 << 30, shift: 30 };
        for (index, channel) in channels.iter().enumerate() {
            let refused = |factor| QuantiseError::Factor { layer, channel: index, factor };
            let worth = inputs.step * channel.step;
            if let Some(outputs) = outputs {
                let multiplier = libm::round(worth / outputs.step * 4_294_967_296.0);
                if !(1.0..=f64::from(i32::MAX)).contains(&multiplier) {
                    return Err(refused(worth / outputs.step));
                }
                multipliers.push(multiplier as i32);
            } else {
                head_scale = scale(worth).ok_or(refused(worth))?;
            }
        }
        layers.push(Layer {
            shape,
            biases: channels.iter().map(|channel| channel.bias).collect(),
            multipliers,
            scale: head_scale,
            weights: channels.into_iter().flat_map(|channel| channel.weights).collect(),
        });
        inputs = outputs.unwrap_or(inputs);
    }
    Ok(layers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::{Draw, Purpose};
    use proptest::prelude::*;

    #[test]
    fn scales_keep_31_bits() {
        for value in [5e-5, 1.0 / 3.0, 1e-9, 0.5, 1e-3] {
            let found = scale(value).expect("scale").to_f64();
            assert!((found / value - 1.0).abs() < 1e-9, "{found} for {value}");
        }
    }

    proptest! {
        #[test]
        fn wide_weights_use_the_room_of_the_sum_and_no_more(seed in any::<u64>(), taps in 1usize..60, bias in -3.0..3.0f32) {
            let mut draw = Draw::new(seed, Purpose::Weights, 0);
            let weights: Vec<f32> = (0..taps).map(|_| draw.normal() as f32).collect();
            let inputs = Activations::up_to(2.0, Mode::W16a16);
            let channel = Channel::of(&weights, bias, &inputs, Mode::W16a16);
            let sum: i64 = channel.weights.iter().map(|&w| i64::from(w).abs()).sum();
            let reach = i64::from(channel.bias).abs() + (sum << 15);
            let largest = channel.weights.iter().map(|w| w.unsigned_abs()).max().unwrap_or(0);
            prop_assert!(reach <= i64::from(i32::MAX) && largest <= 32767);
            prop_assert!(reach > i64::from(i32::MAX) / 1000 * 998 || largest > 32700, "{} {}", reach, largest);
            for (weight, level) in weights.iter().zip(&channel.weights) {
                prop_assert!((f64::from(*weight) - f64::from(*level) * channel.step).abs() <= 0.5001 * channel.step);
            }
        }
    }
}
