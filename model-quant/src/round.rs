//! Weights on the grid of the quantised network, per output channel, still as floats.

use crate::net::{Net, Taps};
use crate::shapes::{HEAD_WEIGHTS, HIDDEN_TAPS};
use inference::model::CHANNELS;

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

/// Steps of every output channel of a convolution.
pub fn steps<const T: usize>(taps: &Taps<T>) -> [f32; CHANNELS] {
    core::array::from_fn(|output| step(taps.iter().map(|row| row[output])))
}

/// Step of every weight of a network; 0 for a bias, which is not rounded to 8 bits.
pub fn grid<const T: usize>(net: &Net<T>) -> Net<T> {
    let mut grid = Net::zero();
    grid.first = [steps(&net.first); T];
    grid.second = [steps(&net.second); HIDDEN_TAPS];
    grid.third = [steps(&net.third); HIDDEN_TAPS];
    grid.head = [step(net.head.iter().copied()); HEAD_WEIGHTS];
    grid
}

/// The network with every weight on its grid; biases stay as they are.
pub fn weights_on_grid<const T: usize>(net: &Net<T>) -> Net<T> {
    let mut rounded = net.clone();
    Freezer::new(net).freeze(&mut rounded, 1.0);
    rounded
}

/// Puts weights on their grid a few at a time, so that those still free can make up for it.
///
/// The steps are fixed at the start. The weights nearest to the grid go first; the largest weight of each output
/// channel, which lies on it, is among them.
#[derive(Clone, Debug)]
pub struct Freezer<const T: usize> {
    grid: Net<T>,
    free: Net<T>,
}

impl<const T: usize> Freezer<T> {
    /// Fixes the grid of a network; everything is free.
    pub fn new(net: &Net<T>) -> Self {
        let mut free = Net::zero();
        for slice in free.slices_mut() {
            slice.fill(1.0);
        }
        Self { grid: grid(net), free }
    }

    /// 1 for a parameter that may still move, 0 for a frozen one.
    pub fn free(&self) -> &Net<T> {
        &self.free
    }

    /// Rounds further weights until this share of all weights is frozen. Free weights beyond the grid's end are
    /// brought back to it.
    pub fn freeze(&mut self, net: &mut Net<T>, share: f64) {
        let mut candidates = Vec::new();
        let (mut weights, mut frozen) = (0usize, 0usize);
        let parts = net.slices_mut().into_iter().zip(self.grid.slices()).zip(self.free.slices());
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
        let (nets, frees) = (net.slices_mut(), self.free.slices_mut());
        let grids = self.grid.slices();
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

    #[test]
    fn rounding_moves_no_weight_by_more_than_half_a_step_and_is_idempotent() {
        let net = Net::<12>::start(&mut Draw::new(1, Purpose::Weights, 0));
        let rounded = weights_on_grid(&net);
        let steps = steps(&net.second);
        for (row, rounded) in net.second.iter().zip(&rounded.second) {
            for ((w, r), s) in row.iter().zip(rounded).zip(steps) {
                assert!((w - r).abs() <= 0.5001 * s);
            }
        }
        let again = weights_on_grid(&rounded);
        for (a, b) in again.slices().into_iter().flatten().zip(rounded.slices().into_iter().flatten()) {
            assert!((a - b).abs() <= 1e-6 * b.abs());
        }
    }

    #[test]
    fn freezing_by_shares_ends_on_the_grid_and_leaves_biases_free() {
        let mut net = Net::<12>::start(&mut Draw::new(2, Purpose::Weights, 0));
        let mut freezer = Freezer::new(&net);
        for share in [0.3, 0.6, 1.0] {
            freezer.freeze(&mut net, share);
            let kept = freezer.free().slices().concat().iter().filter(|&&free| free == 0.0).count();
            assert_eq!(kept, (share * (Net::<12>::PARAMETERS - 49) as f64).ceil() as usize);
        }
        assert!(freezer.free().second_bias.iter().all(|&free| free == 1.0));
        for (w, s) in net.second.iter().flatten().zip(grid(&net).second.as_flattened()) {
            assert!((w / s - (w / s).round()).abs() < 1e-3);
        }
    }
}
