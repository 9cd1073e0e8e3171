//! Fixed-point forward pass for training: the arithmetic of the controller.
//!
//! Weights are in steps of their channel's grid, activations in 16 bits, sums in 32 bits; layers
//! are requantised with rounding and clipping, as in [`inference`], and the sums are equal to the
//! bit. The backward pass is that of the float network at the rounded weights and activations:
//! rounding counts as the identity (straight-through estimator).

use super::layout::Layout;
use crate::quantise::fixed_point::Activations;
use crate::quantise::weight_grid::level;

/// Number of outputs that are summed together.
const BLOCK: usize = 8;

/// Fixed-point formats of a network.
#[derive(Clone, Debug)]
pub(super) struct Formats {
    /// Steps of the weights in the layout's order; 0 for biases and padding channels.
    pub(super) weights: Vec<f32>,
    /// Formats after each convolution.
    pub(super) activations: Vec<Activations>,
}

/// One fixed-point layer.
#[derive(Clone, Debug)]
struct IntegerLayer {
    weights: Vec<i32>,
    biases: Vec<i32>,
    multipliers: Vec<i32>,
    /// Value of one output count.
    step: f32,
    max_count: i64,
}

/// A fixed-point network.
#[derive(Clone, Debug)]
pub(super) struct FixedPointNetwork {
    convolutions: Vec<IntegerLayer>,
    head: IntegerLayer,
    /// Value of one count of each output.
    output_steps: Vec<f64>,
    /// Parameters after rounding, in the layout's order.
    pub(super) rounded: Vec<f32>,
}

/// Input counts of every layer, including the zeros of the padding.
#[derive(Clone, Debug)]
pub(super) struct Counts(Vec<Vec<i16>>);

impl Counts {
    pub(super) fn new(layout: &Layout) -> Self {
        let places = layout.convolutions.iter().chain([&layout.head]);
        Self(places.map(|p| vec![0; (p.size.positions + p.size.kernel - 1) * p.size.inputs]).collect())
    }
}

impl FixedPointNetwork {
    /// Rounds parameters to fixed point.
    pub(super) fn from_parameters(layout: &Layout, parameters: &[f32], formats: &Formats) -> Self {
        let mut rounded = parameters.to_vec();
        let mut input_step = Activations::FEATURES.step;
        let mut layer = |place: &super::layout::Place, outputs: Option<&Activations>| {
            let by_output = outputs.is_none();
            let per_row = if by_output { place.size.taps() } else { place.size.outputs };
            let steps = &formats.weights[place.weights.clone()];
            let channel = |output: usize| {
                let step = if by_output { steps.get(output * per_row) } else { steps.get(output) };
                f64::from(step.copied().unwrap_or_default())
            };
            let mut weights = Vec::with_capacity(steps.len());
            for (value, step) in rounded[place.weights.clone()].iter_mut().zip(steps) {
                let counts = if *step > 0.0 { level(*value, *step) } else { 0.0 };
                weights.push(counts as i32);
                *value = counts * step;
            }
            let mut biases = Vec::with_capacity(place.size.outputs);
            for (output, value) in rounded[place.biases.clone()].iter_mut().enumerate() {
                let step = input_step * channel(output);
                let counts = if step > 0.0 { libm::round(f64::from(*value) / step) } else { 0.0 };
                biases.push(counts as i32);
                *value = (f64::from(counts as i32) * step) as f32;
            }
            let sum_steps: Vec<f64> =
                (0..place.size.outputs).map(|output| input_step * channel(output)).collect();
            let format = outputs.copied().unwrap_or(Activations::FEATURES);
            let factor =
                |step: &f64| libm::round(step / format.step * 4_294_967_296.0).min(f64::from(i32::MAX));
            let multipliers = sum_steps.iter().map(|step| factor(step) as i32).collect();
            input_step = format.step;
            (
                IntegerLayer {
                    weights,
                    biases,
                    multipliers,
                    step: format.step as f32,
                    max_count: format.full_scale() as i64,
                },
                sum_steps,
            )
        };
        let convolutions = layout
            .convolutions
            .iter()
            .zip(&formats.activations)
            .map(|(place, format)| layer(place, Some(format)).0);
        let convolutions = convolutions.collect();
        let (head, output_steps) = layer(&layout.head, None);
        Self { convolutions, head, output_steps, rounded }
    }

    /// Values of one input count of each layer, the features first.
    pub(super) fn steps(&self) -> impl Iterator<Item = f32> {
        [Activations::FEATURES.step as f32]
            .into_iter()
            .chain(self.convolutions.iter().map(|layer| layer.step))
    }

    /// Computes the sums of the head for fixed-point features; `counts` receives the inputs of
    /// every layer.
    #[inline(always)]
    pub(super) fn sums(
        &self,
        layout: &Layout,
        window: impl Iterator<Item = i16>,
        counts: &mut Counts,
        sums: &mut [i32],
    ) {
        let first = layout.convolutions.first().map_or(0, |place| place.size.before * place.size.inputs);
        if let Some(inputs) = counts.0.first_mut() {
            for (slot, value) in inputs.iter_mut().skip(first).zip(window) {
                *slot = value;
            }
        }
        for (index, (place, layer)) in layout.convolutions.iter().zip(&self.convolutions).enumerate() {
            let [inputs, outputs] = &mut counts.0[index..index + 2] else { return };
            let next =
                layout.convolutions.get(index + 1).map_or(0, |next| next.size.before * next.size.inputs);
            let outputs = &mut outputs[next..next + place.size.positions * place.size.outputs];
            let windows = inputs.windows(place.size.taps()).step_by(place.size.inputs);
            for (taps, out) in windows.zip(outputs.chunks_exact_mut(place.size.outputs)) {
                layer.column(taps, out);
            }
        }
        let Some(inputs) = counts.0.last() else { return };
        let rows = self.head.weights.chunks_exact(inputs.len()).zip(&self.head.biases);
        for (sum, (weights, bias)) in sums.iter_mut().zip(rows) {
            *sum = inputs
                .iter()
                .zip(weights)
                .fold(*bias, |sum, (x, w)| sum.wrapping_add(i32::from(*x).wrapping_mul(*w)));
        }
    }

    /// Converts sums of the head to outputs in the network's unit.
    #[inline(always)]
    pub(super) fn outputs(&self, sums: &[i32], outputs: &mut [f32]) {
        for ((output, sum), step) in outputs.iter_mut().zip(sums).zip(&self.output_steps) {
            *output = (f64::from(*sum) * step) as f32;
        }
    }

    /// Input counts of every layer with the value of one count.
    #[inline(always)]
    pub(super) fn layer_inputs<'a>(&'a self, counts: &'a Counts) -> impl Iterator<Item = (&'a [i16], f32)> {
        counts.0.iter().map(Vec::as_slice).zip(self.steps())
    }
}

impl IntegerLayer {
    /// Computes all outputs at one position.
    #[inline(always)]
    fn column(&self, taps: &[i16], out: &mut [i16]) {
        let outputs = self.biases.len();
        let scaling = self.biases.as_chunks::<BLOCK>().0.iter().zip(self.multipliers.as_chunks::<BLOCK>().0);
        for (block, (out, (biases, multipliers))) in
            out.as_chunks_mut::<BLOCK>().0.iter_mut().zip(scaling).enumerate()
        {
            let mut sums = *biases;
            for (x, row) in taps.iter().zip(self.weights.chunks_exact(outputs)) {
                let Some(row) = row.get(block * BLOCK..).and_then(<[i32]>::first_chunk::<BLOCK>) else {
                    return;
                };
                let x = i32::from(*x);
                for (sum, weight) in sums.iter_mut().zip(row) {
                    *sum = sum.wrapping_add(weight.wrapping_mul(x));
                }
            }
            for ((out, sum), multiplier) in out.iter_mut().zip(sums).zip(multipliers) {
                let scaled = (i64::from(sum) * i64::from(*multiplier) + (1 << 31)) >> 32;
                *out = scaled.clamp(0, self.max_count) as i16;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::draw::{Draw, Purpose};
    use crate::network::Network;
    use crate::network::checkpoint::Checkpoint;
    use crate::network::shipped::shipped_checkpoint;
    use crate::quantise::head_sums::head_sums;
    use crate::quantise::image::AnyModel;
    use crate::quantise::mode::Plan;
    use crate::quantise::quantise;
    use crate::quantise::weight_grid::weight_steps;
    use inference::features::{COLLISION_INPUTS, FRICTION_INPUTS};
    use inference::{BearingMaterial, WINDOW};

    /// Random windows over the full 16-bit range.
    fn windows<const C: usize>(index: u64) -> Vec<[[i16; C]; WINDOW]> {
        let mut draw = Draw::new(3, Purpose::PeerWindows, index);
        let mut value = || (draw.below(1 << 16) as i32 - (1 << 15)) as i16;
        (0..256).map(|_| core::array::from_fn(|_| core::array::from_fn(|_| value()))).collect()
    }

    fn sums<const C: usize>(
        network: &Network,
        activations: &[Activations],
        windows: &[[[i16; C]; WINDOW]],
    ) -> Vec<i32> {
        let layout = Layout::new(network.shape());
        let formats =
            Formats { weights: layout.pack(&weight_steps(network)), activations: activations.to_vec() };
        let fixed_point = FixedPointNetwork::from_parameters(&layout, &layout.pack(network), &formats);
        let mut counts = Counts::new(&layout);
        (windows.iter())
            .map(|window| {
                let mut found = [0];
                let features = window.as_flattened().iter().copied();
                fixed_point.sums(&layout, features, &mut counts, &mut found);
                found[0]
            })
            .collect()
    }

    #[test]
    fn sums_equal_those_of_the_engine_to_the_bit() {
        for bearing in BearingMaterial::ALL {
            let checkpoint = Checkpoint::from_bytes(shipped_checkpoint(bearing)).unwrap();
            let quantised = quantise(&checkpoint, 0, Plan::default()).unwrap();
            let AnyModel::Sixteen(model) = AnyModel::load(&quantised.image).unwrap() else {
                panic!("activations of 16 bits")
            };
            let [collision, friction] = &quantised.activations;
            let windows_of_collision = windows::<COLLISION_INPUTS>(0);
            assert_eq!(
                sums(&checkpoint.collision.tuned, collision, &windows_of_collision),
                head_sums(*model.collision(), &windows_of_collision),
                "{bearing:?}"
            );
            let windows_of_friction = windows::<FRICTION_INPUTS>(1);
            assert_eq!(
                sums(&checkpoint.friction.tuned, friction, &windows_of_friction),
                head_sums(*model.friction(), &windows_of_friction),
                "{bearing:?}"
            );
        }
    }
}
