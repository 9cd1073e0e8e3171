//! Room for what one window leaves behind in every layer.

use super::layout::{Layout, Place};

/// Columns with zeros around.
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

/// One window on its way forward and back.
#[derive(Clone, Debug)]
pub(super) struct Room {
    /// What each layer sees, the head last.
    pub(super) seen: Vec<Columns>,
    /// Slopes of the loss over what comes out of each convolution.
    pub(super) slopes: Vec<Columns>,
    /// What comes out of the head.
    pub(super) outputs: Vec<f32>,
    /// Slopes of the loss over that.
    pub(super) output_slopes: Vec<f32>,
    /// Whether any of them is not 0: others do not go back.
    pub(super) goes_back: bool,
}

impl Room {
    pub(super) fn new(layout: &Layout) -> Self {
        let mut seen: Vec<Columns> = Vec::new();
        let mut slopes = Vec::new();
        for Place { size, .. } in &layout.convolutions {
            let after = size.positions + size.kernel - 1 - size.columns - size.before;
            seen.push(Columns::new(size.before, size.columns, after, size.inputs));
            let before = size.kernel - 1 - size.before;
            let after = size.columns + size.before - size.positions;
            slopes.push(Columns::new(before, size.positions, after, size.outputs));
        }
        let head = &layout.head.size;
        seen.push(Columns::new(0, head.columns, 0, head.inputs));
        let outputs = vec![0.0; head.outputs];
        Self { seen, slopes, output_slopes: outputs.clone(), outputs, goes_back: false }
    }
}
