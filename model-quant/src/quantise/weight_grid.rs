//! Grid of the 8-bit weights: one step for each output channel. Values stay f32.

use crate::network::Network;

/// Largest magnitude of an 8-bit weight, in steps.
pub(crate) const WEIGHT_LEVELS: f32 = 127.0;

/// Step of an output channel: its largest weight is 127 steps.
pub(crate) fn step(weights: impl Iterator<Item = f32>) -> f32 {
    let largest = weights.fold(0.0_f32, |largest, w| largest.max(w.abs()));
    if largest > 0.0 { largest / WEIGHT_LEVELS } else { 1.0 / WEIGHT_LEVELS }
}

/// Number of steps of a weight, rounded half away from zero.
pub(crate) fn level(weight: f32, step: f32) -> f32 {
    libm::roundf(weight / step).clamp(-WEIGHT_LEVELS, WEIGHT_LEVELS)
}

/// Step of every weight of a network; 0 for a bias, which is not rounded to 8 bits.
pub(crate) fn weight_steps(network: &Network) -> Network {
    let mut all_steps = Network::zero(network.shape().clone());
    let outputs = network.layers().iter().map(|layer| layer.biases.len());
    let weights = network.layers().iter().map(|layer| &layer.weights);
    for ((slots, weights), outputs) in all_steps.slices_mut().step_by(2).zip(weights).zip(outputs) {
        let steps: Vec<f32> =
            (0..outputs).map(|output| step(weights.iter().skip(output).step_by(outputs).copied())).collect();
        for (slot, step) in slots.iter_mut().zip(steps.iter().cycle()) {
            *slot = *step;
        }
    }
    all_steps
}
