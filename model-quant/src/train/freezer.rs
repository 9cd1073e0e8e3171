//! Gradual rounding of weights to the grid of the quantised network.

use crate::network::Network;
use crate::quantise::weight_grid::{WEIGHT_LEVELS, level, weight_steps};

/// Returns the network with every weight rounded to its grid; biases are unchanged.
pub(crate) fn weights_on_grid(net: &Network) -> Network {
    let mut rounded = net.clone();
    Freezer::new(net).freeze(&mut rounded, 1.0);
    rounded
}

/// Rounds weights to their grid a few at a time, so that the others can compensate.
///
/// The steps are fixed at the start. The weights nearest to their grid points are frozen first.
/// These include the largest weight of each output channel, which lies on the grid.
#[derive(Clone, Debug)]
pub(crate) struct Freezer {
    grid: Network,
    free: Network,
}

impl Freezer {
    /// Fixes the grid of a network; all weights start free.
    pub(crate) fn new(net: &Network) -> Self {
        let mut free = Network::zero(net.shape().clone());
        for slice in free.slices_mut() {
            slice.fill(1.0);
        }
        Self { grid: weight_steps(net), free }
    }

    /// The grid and the mask of free parameters.
    pub(crate) fn parts(&self) -> [&Network; 2] {
        [&self.grid, &self.free]
    }

    /// Inverse of [`Freezer::parts`].
    pub(crate) fn from_parts([grid, free]: [Network; 2]) -> Self {
        Self { grid, free }
    }

    /// Share of the weights that are the largest of their channel.
    pub(crate) fn share_of_ends(&self) -> f64 {
        let channels: usize = self.grid.layers().iter().map(|layer| layer.biases.len()).sum();
        let weights: usize = self.grid.layers().iter().map(|layer| layer.weights.len()).sum();
        channels as f64 / weights.max(1) as f64
    }

    /// Mask: 1 for a free parameter, 0 for a frozen one.
    pub(crate) fn free(&self) -> &Network {
        &self.free
    }

    /// Rounds further weights until this share of all weights is frozen. Free weights beyond the
    /// end of the grid are clamped to it.
    pub(crate) fn freeze(&mut self, net: &mut Network, share: f64) {
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
    use crate::data::draw::{Draw, Purpose};
    use crate::network::NetworkKind;

    #[test]
    fn rounding_moves_no_weight_by_more_than_half_a_step_and_is_idempotent() {
        let net = Network::start(NetworkKind::Friction.shape(), &mut Draw::new(1, Purpose::Weights, 0));
        let rounded = weights_on_grid(&net);
        for ((w, r), s) in net.parameters().zip(rounded.parameters()).zip(weight_steps(&net).parameters()) {
            assert!((w - r).abs() <= 0.5001 * s);
        }
        let twice = weights_on_grid(&rounded);
        for (a, b) in twice.parameters().zip(rounded.parameters()) {
            assert!((a - b).abs() <= 1e-6 * b.abs());
        }
    }

    #[test]
    fn freezing_by_shares_ends_on_the_grid_and_leaves_biases_free() {
        let mut net = Network::start(NetworkKind::Friction.shape(), &mut Draw::new(2, Purpose::Weights, 0));
        let mut freezer = Freezer::new(&net);
        for share in [0.3, 0.6, 1.0] {
            freezer.freeze(&mut net, share);
            let frozen = freezer.free().parameters().filter(|&free| free == 0.0).count();
            assert_eq!(frozen, (share * (net.shape().parameters() - 49) as f64).ceil() as usize);
        }
        assert!(freezer.free().layers()[1].biases.iter().all(|&free| free == 1.0));
        for (w, s) in net.layers()[1].weights.iter().zip(&weight_steps(&net).layers()[1].weights) {
            assert!((w / s - (w / s).round()).abs() < 1e-3);
        }
    }
}
