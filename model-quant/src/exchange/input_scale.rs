//! Full scales of a network's 16-bit fixed-point inputs.
//!
//! Count = value x 32767 / full scale, rounded half away from zero and clipped to 16 bits. The full
//! scales are folded into the weights of the first layer, so that the controller only multiplies
//! each value of a new column once.

use super::samples::Samples;
use crate::network::Network;
use crate::quantise::fixed_point::HEADROOM;

/// Full scale of every value of a column, in the unit of the network's inputs; above 0.
#[derive(Clone, Debug, PartialEq)]
pub struct InputScale(Vec<f32>);

fn factor(full_scale: f32) -> f32 {
    f32::from(i16::MAX) / full_scale
}

/// Returns true if a full scale and its factor are finite and above 0.
fn is_usable(full_scale: f32) -> bool {
    full_scale > 0.0 && full_scale.is_finite() && factor(full_scale).is_finite()
}

impl InputScale {
    /// Takes the largest magnitudes of the samples plus a sixteenth, limited to f32. A value that
    /// is 0 in all samples, or too small for a finite factor, gets 1.
    pub fn from_samples(samples: &Samples, inputs: usize) -> Self {
        let mut largest = vec![0.0_f32; inputs];
        for column in samples.windows.iter().flat_map(|window| window.chunks_exact(inputs)) {
            for (largest, value) in largest.iter_mut().zip(column) {
                *largest = largest.max(value.abs());
            }
        }
        let scales = largest.into_iter().map(|largest| (largest * HEADROOM as f32).min(f32::MAX));
        Self(scales.map(|scale| if is_usable(scale) { scale } else { 1.0 }).collect())
    }

    /// Takes given full scales; None unless there is a usable one for each of the `inputs`.
    pub(crate) fn given(full_scales: &[f32], inputs: usize) -> Option<Self> {
        let fits = full_scales.len() == inputs && full_scales.iter().copied().all(is_usable);
        fits.then(|| Self(full_scales.to_vec()))
    }

    /// Full scale of each value.
    pub fn full_scales(&self) -> &[f32] {
        &self.0
    }

    /// Counts per unit of each value: the controller's factors.
    pub(crate) fn factors(&self) -> Vec<f32> {
        self.0.iter().copied().map(factor).collect()
    }

    /// Converts a window to counts; also returns the number of clipped values.
    pub fn counts(&self, window: &[f32]) -> (Vec<i16>, usize) {
        let factors = self.factors();
        let scaled = window.iter().zip(factors.iter().cycle()).map(|(value, factor)| value * factor);
        // A cast to i16 truncates and saturates.
        let rounded = scaled.map(|scaled| scaled + 0.5_f32.copysign(scaled));
        let is_clipped = |value: &f32| !(-32768.9..32768.0).contains(value);
        (rounded.clone().map(|value| value as i16).collect(), rounded.filter(is_clipped).count())
    }

    /// Returns the network for inputs divided by their full scales.
    pub(crate) fn folded(&self, network: &Network) -> Network {
        let mut folded = network.clone();
        let row = network.layers().first().map_or(1, |layer| layer.biases.len());
        if let Some(weights) = folded.slices_mut().next() {
            for (row, full_scale) in weights.chunks_mut(row).zip(self.0.iter().cycle()) {
                row.iter_mut().for_each(|weight| *weight *= full_scale);
            }
        }
        folded
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_round_to_nearest_and_clip() {
        let scale = InputScale::given(&[1.0, 2.0], 2).expect("scale");
        let (counts, clipped) = scale.counts(&[1.0, -1.0, 0.5 / 32767.0, -2.0, 1.1, 2.0, -9.0, 0.0]);
        assert_eq!(counts, [32767, -16384, 1, -32767, 32767, 32767, -32768, 0]);
        assert_eq!(clipped, 2);
        assert_eq!(InputScale::given(&[1.0, 0.0], 2), None);
        assert_eq!(InputScale::given(&[1.0], 2), None);
    }

    #[test]
    fn factors_are_numbers_however_small_or_large_the_values_are() {
        let window = vec![1e-42, f32::MAX, 1e-45, 0.0];
        let scale =
            InputScale::from_samples(&Samples { windows: vec![window.clone()], outputs: Vec::new() }, 4);
        assert!(scale.factors().iter().all(|factor| factor.is_finite() && *factor > 0.0), "{scale:?}");
        assert_eq!(scale.full_scales(), [1.0, f32::MAX, 1.0, 1.0]);
        assert_eq!(scale.counts(&window).0, [0, 32767, 0, 0]);
        assert_eq!(InputScale::given(&[1e-42], 1), None);
        assert_eq!(InputScale::given(&[f32::INFINITY], 1), None);
    }
}
