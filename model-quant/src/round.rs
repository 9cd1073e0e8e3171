//! Weights on the grid of the quantised network, per output channel, still as floats.

use crate::network::Network;

/// Largest magnitude of an 8-bit weight.
pub const WEIGHT_LEVELS: f32 = 127.0;

/// Step of the grid of one output channel: its largest weight is 127 steps.
pub fn step(weights: impl Iterator<Item = f32>) -> f32 {
    let largest = weights.fold(0.0_f32, |largest, w| largest.max(w.abs()));
    if largest > 0.0 { largest / WEIGHT_LEVELS } else { 1.0 / WEIGHT_LEVELS }
}

/// Number of steps of a weight, halves away from zero.
pub fn level(weight: f32, step: f32) -> f32 {
    libm::roundf(weight / step).clamp(-WEIGHT_LEVELS, WEIGHT_LEVELS)
}

/// Step of every weight of a network, per output channel; 0 for a bias, which is not rounded to 8 bits.
pub fn grid(network: &Network) -> Network {
    let mut grid = Network::zero(network.shape().clone());
    let outputs = network.layers().iter().map(|layer| layer.biases.len());
    let weights = network.layers().iter().map(|layer| &layer.weights);
    for ((slots, weights), outputs) in grid.slices_mut().step_by(2).zip(weights).zip(outputs) {
        let steps: Vec<f32> =
            (0..outputs).map(|output| step(weights.iter().skip(output).step_by(outputs).copied())).collect();
        for (slot, step) in slots.iter_mut().zip(steps.iter().cycle()) {
            *slot = *step;
        }
    }
    grid
}

/// The network with every weight on its grid; biases stay as they are.
pub fn weights_on_grid(net: &Network) -> Network {
    let mut rounded = net.clone();
    Freezer::new(net).freeze(&mut rounded, 1.0);
    rounded
}

/// Puts weights on their grid a few at a time, so that those still free can make up for it.
///
/// The steps are fixed at the start. The weights nearest to the grid go first; the largest weight of each output
/// channel, which lies on it, is among them.
#[derive(Clone, Debug)]
pub struct Freezer {
    grid: Network,
    free: Network,
}

impl Freezer {
    /// Fixes the grid of a network; everything is free.
    pub fn new(net: &Network) -> Self {
        let mut free = Network::zero(net.shape().clone());
        for slice in free.slices_mut() {
            slice.fill(1.0);
        }
        Self { grid: grid(net), free }
    }

    /// The grid and what is free.
    pub(crate) fn parts(&self) -> [&Network; 2] {
        [&self.grid, &self.free]
    }

    /// The reverse of [`Freezer::parts`].
    pub(crate) fn from_parts([grid, free]: [Network; 2]) -> Self {
        Self { grid, free }
    }

    /// Share of the weights that are the largest of their channel.
    pub(crate) fn share_of_ends(&self) -> f64 {
        let channels: usize = self.grid.layers().iter().map(|layer| layer.biases.len()).sum();
        let weights: usize = self.grid.layers().iter().map(|layer| layer.weights.len()).sum();
        channels as f64 / weights.max(1) as f64
    }

    /// 1 for a parameter that may still move, 0 for a frozen one.
    pub fn free(&self) -> &Network {
        &self.free
    }

    /// Rounds further weights until this share of all weights is frozen. Free weights beyond the grid's end are
    /// brought back to it.
    pub fn freeze(&mut self, net: &mut Network, share: f64) {
        let mut candidates = Vec::new();
        let (mut weights, mut frozen) = (0usize, 0usize);
        let parts = net.slices_mut().zip(self.grid.slices()).zip(self.free.slices());
        for (part, ((values, steps), free)) in parts.enumerate() {
            for (index, ((value, &step), &free)) in values.iter_mut().zip(steps).zip(free).enumerate() {
                if step == 0.0 {
                    continue;
                }
                weights += 1;
                if free == 0.0 {
                    frozen += 1;
                    continue;
                }
                *value = value.clamp(-WEIGHT_LEVELS * step, WEIGHT_LEVELS * step);
                candidates.push(((*value / step - level(*value, step)).abs(), part, index));
            }
        }
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let wanted = ((weights as f64 * share).ceil() as usize).min(weights);
        let (mut nets, mut frees): (Vec<_>, Vec<_>) =
            (net.slices_mut().collect(), self.free.slices_mut().collect());
        let grids: Vec<_> = self.grid.slices().collect();
        for &(_, part, index) in candidates.iter().take(wanted.saturating_sub(frozen)) {
            let step = grids[part][index];
            nets[part][index] = level(nets[part][index], step) * step;
            frees[part][index] = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::{Draw, Purpose};
    use crate::shapes;

    #[test]
    fn rounding_moves_no_weight_by_more_than_half_a_step_and_is_idempotent() {
        let net = Network::start(shapes::friction(), &mut Draw::new(1, Purpose::Weights, 0));
        let rounded = weights_on_grid(&net);
        for ((w, r), s) in net.parameters().zip(rounded.parameters()).zip(grid(&net).parameters()) {
            assert!((w - r).abs() <= 0.5001 * s);
        }
        let again = weights_on_grid(&rounded);
        for (a, b) in again.parameters().zip(rounded.parameters()) {
            assert!((a - b).abs() <= 1e-6 * b.abs());
        }
    }

    #[test]
    fn freezing_by_shares_ends_on_the_grid_and_leaves_biases_free() {
        let mut net = Network::start(shapes::friction(), &mut Draw::new(2, Purpose::Weights, 0));
        let mut freezer = Freezer::new(&net);
        for share in [0.3, 0.6, 1.0] {
            freezer.freeze(&mut net, share);
            let kept = freezer.free().parameters().filter(|&free| free == 0.0).count();
            assert_eq!(kept, (share * (net.shape().parameters() - 49) as f64).ceil() as usize);
        }
        assert!(freezer.free().layers()[1].biases.iter().all(|&free| free == 1.0));
        for (w, s) in net.layers()[1].weights.iter().zip(&grid(&net).layers()[1].weights) {
            assert!((w / s - (w / s).round()).abs() < 1e-3);
        }
    }
}
