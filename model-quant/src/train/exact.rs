//! The way forward in the controller's whole numbers, for training on.
//!
//! Weights in steps of their channel's grid, activations in 16 bits, sums in 32, requantised with rounding and clipped, as
//! [`inference`] does; the sums are the same to the bit. The way back is that of the float network with the rounded
//! weights at the rounded activations: rounding counts as the identity (a straight-through estimator).

use super::layout::Layout;
use crate::parameters::Activations;
use crate::round::level;

/// Outputs that are summed up together.
const BLOCK: usize = 8;

/// What the whole numbers are worth.
#[derive(Clone, Debug)]
pub(super) struct Grids {
    /// Steps of the weights in the layout's order; 0 for biases and for what is filled up.
    pub(super) weights: Vec<f32>,
    /// Activations behind each convolution.
    pub(super) activations: Vec<Activations>,
}

/// One layer.
#[derive(Clone, Debug)]
struct Whole {
    weights: Vec<i32>,
    biases: Vec<i32>,
    multipliers: Vec<i32>,
    /// What a count behind it is worth.
    step: f32,
    most: i64,
}

/// A network in whole numbers.
#[derive(Clone, Debug)]
pub(super) struct Exact {
    convolutions: Vec<Whole>,
    head: Whole,
    /// What a count of each output is worth.
    worth: Vec<f64>,
    /// The parameters that the whole numbers stand for, in the layout's order.
    pub(super) rounded: Vec<f32>,
}

/// Whole numbers on their way through a network.
#[derive(Clone, Debug)]
pub(super) struct Counts(Vec<Vec<i16>>);

impl Counts {
    pub(super) fn new(layout: &Layout) -> Self {
        let places = layout.convolutions.iter().chain([&layout.head]);
        Self(places.map(|p| vec![0; (p.size.positions + p.size.kernel - 1) * p.size.inputs]).collect())
    }
}

impl Exact {
    /// The whole numbers of parameters.
    pub(super) fn of(layout: &Layout, parameters: &[f32], grids: &Grids) -> Self {
        let mut rounded = parameters.to_vec();
        let mut inputs = Activations::FEATURES.step;
        let mut whole = |place: &super::layout::Place, outputs: Option<&Activations>| {
            let by_output = outputs.is_none();
            let per_row = if by_output { place.size.taps() } else { place.size.outputs };
            let steps = &grids.weights[place.weights.clone()];
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
                let worth = inputs * channel(output);
                let counts = if worth > 0.0 { libm::round(f64::from(*value) / worth) } else { 0.0 };
                biases.push(counts as i32);
                *value = (f64::from(counts as i32) * worth) as f32;
            }
            let worth: Vec<f64> = (0..place.size.outputs).map(|output| inputs * channel(output)).collect();
            let behind = outputs.copied().unwrap_or(Activations::FEATURES);
            let factor =
                |worth: &f64| libm::round(worth / behind.step * 4_294_967_296.0).min(f64::from(i32::MAX));
            let multipliers = worth.iter().map(|worth| factor(worth) as i32).collect();
            inputs = behind.step;
            (
                Whole {
                    weights,
                    biases,
                    multipliers,
                    step: behind.step as f32,
                    most: behind.full_scale() as i64,
                },
                worth,
            )
        };
        let convolutions = layout
            .convolutions
            .iter()
            .zip(&grids.activations)
            .map(|(place, behind)| whole(place, Some(behind)).0);
        let convolutions = convolutions.collect();
        let (head, worth) = whole(&layout.head, None);
        Self { convolutions, head, worth, rounded }
    }

    /// What a layer's counts are worth, the features first.
    pub(super) fn steps(&self) -> impl Iterator<Item = f32> {
        [Activations::FEATURES.step as f32]
            .into_iter()
            .chain(self.convolutions.iter().map(|whole| whole.step))
    }

    /// The sums of the head over whole-number features; `counts` keeps what every layer saw.
    #[inline(always)]
    pub(super) fn sums(
        &self,
        layout: &Layout,
        window: impl Iterator<Item = i16>,
        counts: &mut Counts,
        sums: &mut [i32],
    ) {
        let first = layout.convolutions.first().map_or(0, |place| place.size.before * place.size.inputs);
        if let Some(seen) = counts.0.first_mut() {
            for (slot, value) in seen.iter_mut().skip(first).zip(window) {
                *slot = value;
            }
        }
        for (index, (place, whole)) in layout.convolutions.iter().zip(&self.convolutions).enumerate() {
            let [seen, behind] = &mut counts.0[index..index + 2] else { return };
            let next =
                layout.convolutions.get(index + 1).map_or(0, |next| next.size.before * next.size.inputs);
            let behind = &mut behind[next..next + place.size.positions * place.size.outputs];
            let windows = seen.windows(place.size.taps()).step_by(place.size.inputs);
            for (taps, out) in windows.zip(behind.chunks_exact_mut(place.size.outputs)) {
                whole.column(taps, out);
            }
        }
        let Some(seen) = counts.0.last() else { return };
        let rows = self.head.weights.chunks_exact(seen.len()).zip(&self.head.biases);
        for (sum, (weights, bias)) in sums.iter_mut().zip(rows) {
            *sum = seen
                .iter()
                .zip(weights)
                .fold(*bias, |sum, (x, w)| sum.wrapping_add(i32::from(*x).wrapping_mul(*w)));
        }
    }

    /// Outputs in the network's unit.
    #[inline(always)]
    pub(super) fn outputs(&self, sums: &[i32], outputs: &mut [f32]) {
        for ((output, sum), worth) in outputs.iter_mut().zip(sums).zip(&self.worth) {
            *output = (f64::from(*sum) * worth) as f32;
        }
    }

    /// What every layer saw, its counts in floats.
    #[inline(always)]
    pub(super) fn seen<'a>(&'a self, counts: &'a Counts) -> impl Iterator<Item = (&'a [i16], f32)> {
        counts.0.iter().map(Vec::as_slice).zip(self.steps())
    }
}

impl Whole {
    /// All outputs at one position.
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
                *out = scaled.clamp(0, self.most) as i16;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checkpoint::Checkpoint;
    use crate::float_pair::shipped;
    use crate::mode::Plan;
    use crate::peers::windows;
    use crate::quantise::quantise;
    use crate::round::grid;
    use inference::{Bearing, WINDOW};

    #[test]
    fn sums_are_those_of_the_engine_to_the_bit() {
        let windows = windows().unwrap();
        let mut compared = 0;
        for bearing in Bearing::ALL {
            let checkpoint = Checkpoint::from_bytes(shipped(bearing)).unwrap();
            let quantised = quantise(&checkpoint, 0, Plan::default()).unwrap();
            for (which, network) in
                [&checkpoint.collision.tuned, &checkpoint.friction.tuned].into_iter().enumerate()
            {
                let layout = Layout::new(network.shape());
                let grids = Grids {
                    weights: layout.pack(&grid(network)),
                    activations: quantised.activations[which].to_vec(),
                };
                let exact = Exact::of(&layout, &layout.pack(network), &grids);
                let mut counts = Counts::new(&layout);
                let name = ["collision", "friction"][which];
                let expected = windows.iter().find(|w| w.bearing == bearing && w.network == name).unwrap();
                for (window, sum) in expected.features.chunks(WINDOW * expected.inputs).zip(&expected.sums) {
                    let mut found = [0];
                    exact.sums(&layout, window.iter().copied(), &mut counts, &mut found);
                    assert_eq!(found[0], *sum, "{} {name}", bearing.name());
                    compared += 1;
                }
            }
        }
        assert_eq!(compared, 4 * 384);
    }
}
