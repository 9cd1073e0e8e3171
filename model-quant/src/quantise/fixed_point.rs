//! Fixed-point form of one network: weights on a grid for each output channel, biases, multipliers.
//!
//! Step of a channel, by the width of the weights:
//!
//! * 8 bits: its largest weight is 127 steps, as on the grid of the training.
//! * Up to 16 bits: the smallest step with no weight above 32767 steps and
//!   |bias| + sum |weight| 2^15 below 2^31.

use super::error::QuantiseError;
use crate::network::Network;
use crate::quantise::mode::{Mode, Packing, Plan};
use crate::quantise::weight_grid::{level, step};
use inference::Scale;
use inference::image::write::LayerParts;
use inference::image::{LayerKind, LayerShape, WeightForm};

/// Full scale of a layer divided by its largest activation in the calibration set: a sixteenth of
/// headroom for states that the calibration did not contain.
pub(crate) const HEADROOM: f64 = 17.0 / 16.0;

/// Fixed-point format of a layer's activations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Activations {
    /// Width in bits.
    pub bits: u8,
    /// Value of one count.
    pub step: f64,
}

impl Activations {
    /// Format of the features: 16 bits, full scale 1.
    pub(crate) const FEATURES: Self = Self { bits: 16, step: 1.0 / 32767.0 };

    /// Format with the given largest value plus a sixteenth at full scale.
    pub(crate) fn up_to(largest: f32, mode: Mode) -> Self {
        let bits: u8 = if mode == Mode::W8a8 { 8 } else { 16 };
        Self { bits, step: f64::from(largest).max(1e-6) * HEADROOM / f64::from((1u32 << (bits - 1)) - 1) }
    }

    /// Largest number of counts.
    pub(crate) fn full_scale(&self) -> f64 {
        f64::from((1u32 << (self.bits - 1)) - 1)
    }
}

/// Fixed-point weights and bias of one output channel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Channel {
    /// Value of one count of a weight.
    pub step: f64,
    /// Weights in counts.
    pub weights: Vec<i16>,
    /// Bias in counts of the sum.
    pub bias: i32,
}

/// Converts a bias to counts of the sum.
fn bias_level(bias: f32, inputs: &Activations, step: f64) -> f64 {
    libm::round(f64::from(bias) / (inputs.step * step))
}

impl Channel {
    /// Smallest step that the format of a channel's weights allows.
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
        // Lower bound that ignores rounding; one or two increments of 2^-12 compensate for it.
        let mut step = (largest / f64::from(i16::MAX)).max(needed).max(1e-9);
        while !fits(step) {
            step *= 1.0 + 1.0 / 4096.0;
        }
        step
    }

    /// Rounds a channel's weights to a given step.
    fn with_step(step: f64, weights: &[f32], bias: f32, inputs: &Activations, mode: Mode) -> Self {
        let levels = weights.iter().map(|&weight| {
            if mode.has_narrow_weights() {
                level(weight, step as f32) as i16
            } else {
                libm::round(f64::from(weight) / step) as i16
            }
        });
        Self { step, weights: levels.collect(), bias: bias_level(bias, inputs, step) as i32 }
    }
}

/// Quantises the channels of one layer. A head has one step for all its outputs, because it has one
/// scale.
pub(crate) fn quantise_channels(
    network: &Network,
    layer: usize,
    inputs: &Activations,
    mode: Mode,
) -> Vec<Channel> {
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
        .map(|(output, (&bias, step))| Channel::with_step(step, &weights(output), bias, inputs, mode))
        .collect()
}

/// Replaces the weights of a layer of a float network by their quantised values.
pub(crate) fn set_layer_weights(network: &mut Network, layer: usize, channels: &[Channel]) {
    let Some(slice) = network.slices_mut().nth(2 * layer) else { return };
    for (tap, row) in slice.chunks_mut(channels.len().max(1)).enumerate() {
        for (slot, channel) in row.iter_mut().zip(channels) {
            let level = channel.weights.get(tap).copied().unwrap_or_default();
            *slot = (f64::from(level) * channel.step) as f32;
        }
    }
}

/// One fixed-point layer.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layer {
    shape: LayerShape,
    biases: Vec<i32>,
    multipliers: Vec<i32>,
    scale: Scale,
    weights: Vec<i16>,
}

impl Layer {
    /// Borrows the layer in the form of the image writer.
    pub(crate) fn parts(&self) -> LayerParts<'_> {
        LayerParts {
            shape: self.shape,
            biases: &self.biases,
            multipliers: &self.multipliers,
            scale: self.scale,
            weights: &self.weights,
        }
    }
}

/// Converts a scale with 31 significant bits.
fn scale(value: f64) -> Option<Scale> {
    let (mantissa, exponent) = libm::frexp(value);
    let multiplier = libm::round(mantissa * f64::from(1u32 << 31)).min(f64::from(i32::MAX)) as i32;
    let shift = u32::try_from(31 - exponent).ok()?;
    (multiplier > 0).then_some(Scale { multiplier, shift })
}

fn narrowed<T: TryFrom<usize>>(layer: usize, what: &'static str, size: usize) -> Result<T, QuantiseError> {
    T::try_from(size).map_err(|_| QuantiseError::Size { layer, what, size })
}

/// Converts a network to fixed point; `largest` are its largest activations after each convolution.
///
/// # Errors
///
/// A factor between two scales does not fit into 32 bits, or a layer is too large for the image.
pub(crate) fn quantise_layers(
    network: &Network,
    largest: &[f32],
    plan: Plan,
) -> Result<Vec<Layer>, QuantiseError> {
    let mut inputs = Activations::FEATURES;
    let mut layers = Vec::with_capacity(network.layers().len());
    for (layer, size) in network.shape().layers().iter().enumerate() {
        let channels = quantise_channels(network, layer, &inputs, plan.mode);
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
            let sum_step = inputs.step * channel.step;
            if let Some(outputs) = outputs {
                let multiplier = libm::round(sum_step / outputs.step * 4_294_967_296.0);
                if !(1.0..=f64::from(i32::MAX)).contains(&multiplier) {
                    return Err(refused(sum_step / outputs.step));
                }
                multipliers.push(multiplier as i32);
            } else {
                head_scale = scale(sum_step).ok_or(refused(sum_step))?;
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
    use crate::data::draw::{Draw, Purpose};
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
        fn wide_weights_use_the_range_of_the_sum_without_overflow(
            seed in any::<u64>(),
            taps in 1usize..60,
            bias in -3.0..3.0f32,
        ) {
            let mut draw = Draw::new(seed, Purpose::Weights, 0);
            let weights: Vec<f32> = (0..taps).map(|_| draw.normal() as f32).collect();
            let inputs = Activations::up_to(2.0, Mode::W16a16);
            let step = Channel::finest_step(&weights, bias, &inputs, Mode::W16a16);
            let channel = Channel::with_step(step, &weights, bias, &inputs, Mode::W16a16);
            let sum: i64 = channel.weights.iter().map(|&w| i64::from(w).abs()).sum();
            let reach = i64::from(channel.bias).abs() + (sum << 15);
            let largest = channel.weights.iter().map(|w| w.unsigned_abs()).max().unwrap_or(0);
            prop_assert!(reach <= i64::from(i32::MAX) && largest <= 32767);
            prop_assert!(
                reach > i64::from(i32::MAX) / 1000 * 998 || largest > 32700,
                "{} {}", reach, largest
            );
            for (weight, level) in weights.iter().zip(&channel.weights) {
                let error = f64::from(*weight) - f64::from(*level) * channel.step;
                prop_assert!(error.abs() <= 0.5001 * channel.step);
            }
        }
    }
}
