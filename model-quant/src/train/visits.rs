//! Operations on the blocks of [`super::block`]: outputs, gradients of inputs, gradients of
//! weights.

use super::block::{Sums, Visit, gate, load, multiply_columns, multiply_rows, store, vectors};
use super::lanes::Lanes;
use super::workspace::Workspace;

/// Computes the outputs of a convolution with ReLU.
pub(super) struct Convolve<'a> {
    pub(super) inputs: &'a [f32],
    pub(super) step: usize,
    pub(super) taps: usize,
    pub(super) weights: &'a [f32],
    pub(super) biases: &'a [f32],
    pub(super) outputs: &'a mut [f32],
}

impl Visit for Convolve<'_> {
    #[inline(always)]
    fn block<L: Lanes, const R: usize, const V: usize>(
        &mut self,
        lanes: L,
        row: usize,
        at: usize,
    ) -> Option<()> {
        let channels = self.biases.len();
        let inputs = (self.inputs.get(row * self.step..)?, self.step, self.taps);
        let sums: Sums<L, R, V> = [vectors(lanes, self.biases, at)?; R];
        let sums = multiply_rows(lanes, inputs, (self.weights, channels, at), sums)?;
        store(lanes, &gate::<L, R, V>(lanes, sums, &sums), (self.outputs, channels), (row, at))
    }
}

/// Computes the gradients with respect to a convolution's inputs, through the ReLU before it.
pub(super) struct BackPropagate<'a> {
    pub(super) gradients: &'a [f32],
    pub(super) step: usize,
    pub(super) taps: usize,
    pub(super) weights: &'a [f32],
    pub(super) channels: usize,
    pub(super) inputs: &'a [f32],
    pub(super) outputs: &'a mut [f32],
}

impl Visit for BackPropagate<'_> {
    #[inline(always)]
    fn block<L: Lanes, const R: usize, const V: usize>(
        &mut self,
        lanes: L,
        row: usize,
        at: usize,
    ) -> Option<()> {
        let gradients = (self.gradients.get(row * self.step..)?, self.step, self.taps);
        let sums: Sums<L, R, V> = [[lanes.splat(0.0); V]; R];
        let sums = multiply_rows(lanes, gradients, (self.weights, self.channels, at), sums)?;
        let gates = load::<L, R, V>(lanes, (self.inputs, self.channels), (row, at))?;
        store(lanes, &gate::<L, R, V>(lanes, sums, &gates), (self.outputs, self.channels), (row, at))
    }
}

/// Adds the gradients with respect to a convolution's weights over the windows of a group.
pub(super) struct AccumulateWeights<'a> {
    pub(super) workspaces: &'a [Workspace],
    pub(super) layer: usize,
    pub(super) channels: usize,
    pub(super) sums: &'a mut [f32],
}

impl Visit for AccumulateWeights<'_> {
    #[inline(always)]
    fn block<L: Lanes, const R: usize, const V: usize>(
        &mut self,
        lanes: L,
        row: usize,
        at: usize,
    ) -> Option<()> {
        let mut sums = load::<L, R, V>(lanes, (self.sums, self.channels), (row, at))?;
        for workspace in self.workspaces.iter().filter(|workspace| workspace.has_gradient) {
            let (inputs, gradients) =
                (workspace.inputs.get(self.layer)?, workspace.gradients.get(self.layer)?);
            let gradients = (gradients.inside(), self.channels, at);
            sums = multiply_columns(lanes, (inputs.values.get(row..)?, inputs.channels), gradients, sums)?;
        }
        store(lanes, &sums, (self.sums, self.channels), (row, at))
    }
}

/// Sets gradients to 0 where a ReLU gave 0.
#[inline(always)]
pub(super) fn mask_by_relu(gradients: &mut [f32], inputs: &[f32]) {
    for (gradient, input) in gradients.iter_mut().zip(inputs) {
        *gradient = if *input > 0.0 { *gradient } else { 0.0 };
    }
}
