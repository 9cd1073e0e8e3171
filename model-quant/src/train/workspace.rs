//! Intermediate values of one window in every layer.

use super::layout::{Layout, Place};

/// Columns with zeros around them.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    pub(super) values: Vec<f32>,
    pub(super) channels: usize,
    /// Zero columns before the first.
    before: usize,
    count: usize,
}

impl Columns {
    fn new(before: usize, count: usize, after: usize, channels: usize) -> Self {
        Self { values: vec![0.0; (before + count + after) * channels], channels, before, count }
    }

    #[inline(always)]
    pub(super) fn inside(&self) -> &[f32] {
        let start = self.before * self.channels;
        &self.values[start..start + self.count * self.channels]
    }

    #[inline(always)]
    pub(super) fn inside_mut(&mut self) -> &mut [f32] {
        let start = self.before * self.channels;
        &mut self.values[start..start + self.count * self.channels]
    }
}

/// Values of one window in its forward and backward pass.
#[derive(Clone, Debug)]
pub(super) struct Workspace {
    /// Inputs of each layer, the head last.
    pub(super) inputs: Vec<Columns>,
    /// Gradients of the loss with respect to the outputs of each convolution.
    pub(super) gradients: Vec<Columns>,
    /// Outputs of the head.
    pub(super) outputs: Vec<f32>,
    /// Gradients of the loss with respect to the outputs.
    pub(super) output_gradients: Vec<f32>,
    /// False if all output gradients are 0, so that the backward pass is skipped.
    pub(super) has_gradient: bool,
}

impl Workspace {
    pub(super) fn new(layout: &Layout) -> Self {
        let mut inputs: Vec<Columns> = Vec::new();
        let mut gradients = Vec::new();
        for Place { size, .. } in &layout.convolutions {
            let after = size.positions + size.kernel - 1 - size.columns - size.before;
            inputs.push(Columns::new(size.before, size.columns, after, size.inputs));
            let before = size.kernel - 1 - size.before;
            let after = size.columns + size.before - size.positions;
            gradients.push(Columns::new(before, size.positions, after, size.outputs));
        }
        let head = &layout.head.size;
        inputs.push(Columns::new(0, head.columns, 0, head.inputs));
        let outputs = vec![0.0; head.outputs];
        Self { inputs, gradients, output_gradients: outputs.clone(), outputs, has_gradient: false }
    }
}
