//! Forward and backward pass of a group of windows, with the kernel of [`super::block`].
//!
//! The group is processed layer by layer, so that the weights of a layer are loaded into the
//! nearest cache once. Every sum is still added window by window.

use super::block::visit_blocks;
use super::fixed_point_forward::{Counts, FixedPointNetwork};
use super::lanes::{LANES, Lanes};
use super::layout::{Layout, Place};
use super::visits::{AccumulateWeights, BackPropagate, Convolve, mask_by_relu};
use super::workspace::Workspace;
use inference::features::FULL_SCALE;
use pulp::f32x8;

/// Windows in a group; two or eight are not faster.
pub(super) const GROUP: usize = 4;

/// Kernels of the convolutions flipped for the backward pass: by column from the newest, output,
/// then input.
#[derive(Clone, Debug)]
pub(super) struct FlippedWeights(Vec<Vec<f32>>);

impl FlippedWeights {
    pub(super) fn from_parameters(layout: &Layout, parameters: &[f32]) -> Self {
        let flip = |place: &Place| {
            let (size, weights) = (&place.size, &parameters[place.weights.clone()]);
            let mut flipped = vec![0.0; weights.len()];
            for (tap, row) in weights.chunks_exact(size.outputs).enumerate() {
                let (column, input) = (size.kernel - 1 - tap / size.inputs, tap % size.inputs);
                for (output, weight) in row.iter().enumerate() {
                    flipped[(column * size.outputs + output) * size.inputs + input] = *weight;
                }
            }
            flipped
        };
        // Gradients with respect to the window are not needed.
        Self(layout.convolutions.iter().skip(1).map(flip).collect())
    }
}

/// Workspaces for a group of windows.
#[derive(Clone, Debug)]
pub(super) struct Passes {
    workspaces: Vec<Workspace>,
    /// Fixed-point inputs of the layers, for one window.
    counts: Counts,
    /// Fixed-point sums of the head.
    sums: Vec<i32>,
}

impl Passes {
    pub(super) fn new(layout: &Layout) -> Self {
        let workspaces = vec![Workspace::new(layout); GROUP];
        Self { workspaces, counts: Counts::new(layout), sums: vec![0; layout.head.size.outputs] }
    }

    /// Runs up to [`GROUP`] windows forward and returns their workspaces.
    #[inline(always)]
    pub(super) fn forward<L: Lanes>(
        &mut self,
        lanes: L,
        layout: &Layout,
        parameters: &[f32],
        windows: &[f32],
    ) -> &mut [Workspace] {
        let mut count = 0;
        for (workspace, window) in self.workspaces.iter_mut().zip(windows.chunks_exact(layout.window())) {
            if let Some(first) = workspace.inputs.first_mut() {
                for (slot, value) in first.inside_mut().iter_mut().zip(window) {
                    *slot = *value;
                }
            }
            count += 1;
        }
        let workspaces = self.workspaces.get_mut(..count).unwrap_or_default();
        for (index, place) in layout.convolutions.iter().enumerate() {
            for workspace in &mut *workspaces {
                let [inputs, outputs] = &mut workspace.inputs[index..index + 2] else { continue };
                let mut visit = Convolve {
                    inputs: &inputs.values,
                    step: inputs.channels,
                    taps: place.size.taps(),
                    weights: &parameters[place.weights.clone()],
                    biases: &parameters[place.biases.clone()],
                    outputs: outputs.inside_mut(),
                };
                visit_blocks(lanes, place.size.positions, place.size.outputs, &mut visit);
            }
        }
        let weights = &parameters[layout.head.weights.clone()];
        for workspace in &mut *workspaces {
            let Some(inputs) = workspace.inputs.last() else { continue };
            let rows = weights.chunks_exact(inputs.values.len()).zip(&parameters[layout.head.biases.clone()]);
            for (output, (weights, bias)) in workspace.outputs.iter_mut().zip(rows) {
                *output = dot(lanes.narrow(), &inputs.values, weights) + bias;
            }
        }
        workspaces
    }

    /// Fixed-point forward pass; the workspaces receive its values as floats.
    #[inline(always)]
    pub(super) fn forward_fixed_point(
        &mut self,
        layout: &Layout,
        fixed_point: &FixedPointNetwork,
        windows: &[f32],
    ) -> &mut [Workspace] {
        let mut count = 0;
        for (workspace, window) in self.workspaces.iter_mut().zip(windows.chunks_exact(layout.window())) {
            let features = window.iter().map(|&value| {
                let scaled = value * f32::from(FULL_SCALE);
                // Rounds half away from zero like `round`, which is slow without SSE4.1.
                (if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 }) as i16
            });
            fixed_point.sums(layout, features, &mut self.counts, &mut self.sums);
            fixed_point.outputs(&self.sums, &mut workspace.outputs);
            for (columns, (inputs, step)) in
                workspace.inputs.iter_mut().zip(fixed_point.layer_inputs(&self.counts))
            {
                for (slot, value) in columns.values.iter_mut().zip(inputs) {
                    *slot = f32::from(*value) * step;
                }
            }
            count += 1;
        }
        self.workspaces.get_mut(..count).unwrap_or_default()
    }
}

/// Adds the gradients of `sum of output_gradients[i] outputs[i]` for windows after their forward
/// pass.
#[inline(always)]
pub(super) fn backward<L: Lanes>(
    lanes: L,
    (layout, flipped): (&Layout, &FlippedWeights),
    parameters: &[f32],
    workspaces: &mut [Workspace],
    gradient: &mut [f32],
) {
    for workspace in workspaces.iter_mut().filter(|workspace| workspace.has_gradient) {
        head_backward(lanes.narrow(), layout, parameters, workspace, gradient);
    }
    for (index, place) in layout.convolutions.iter().enumerate().rev() {
        let sums = &mut gradient[place.weights.clone()];
        let mut visit = AccumulateWeights { workspaces, layer: index, channels: place.size.outputs, sums };
        visit_blocks(lanes, place.size.taps(), place.size.outputs, &mut visit);
        let biases = gradient[place.biases.clone()].as_chunks_mut::<LANES>().0;
        for workspace in workspaces.iter_mut().filter(|workspace| workspace.has_gradient) {
            let (earlier, later) = workspace.gradients.split_at_mut(index);
            let [gradients, ..] = later else { return };
            for row in gradients.inside().chunks_exact(place.size.outputs) {
                for (sums, gradients) in biases.iter_mut().zip(row.as_chunks::<LANES>().0) {
                    for (sum, gradient) in sums.iter_mut().zip(gradients) {
                        *sum += gradient;
                    }
                }
            }
            let (Some(before), Some(weights)) =
                (earlier.last_mut(), index.checked_sub(1).map(|i| &flipped.0[i]))
            else {
                continue;
            };
            let mut visit = BackPropagate {
                gradients: &gradients.values,
                step: gradients.channels,
                taps: place.size.kernel * place.size.outputs,
                weights,
                channels: place.size.inputs,
                inputs: workspace.inputs[index].inside(),
                outputs: before.inside_mut(),
            };
            visit_blocks(lanes, place.size.columns, place.size.inputs, &mut visit);
        }
    }
}

#[inline(always)]
fn head_backward<L: Lanes<Vector = f32x8>>(
    lanes: L,
    layout: &Layout,
    parameters: &[f32],
    workspace: &mut Workspace,
    gradient: &mut [f32],
) {
    let Some(inputs) = workspace.inputs.last() else { return };
    let sums = gradient[layout.head.weights.clone()].chunks_exact_mut(inputs.values.len());
    for (sums, output_gradient) in sums.zip(&workspace.output_gradients) {
        add_scaled(lanes, sums, &inputs.values, *output_gradient);
    }
    let biases = gradient[layout.head.biases.clone()].iter_mut();
    for (sum, output_gradient) in biases.zip(&workspace.output_gradients) {
        *sum += output_gradient;
    }
    if let Some(last) = workspace.gradients.last_mut() {
        let last = last.inside_mut();
        last.fill(0.0);
        let weights = parameters[layout.head.weights.clone()].chunks_exact(inputs.values.len());
        for (weights, output_gradient) in weights.zip(&workspace.output_gradients) {
            add_scaled(lanes, last, weights, *output_gradient);
        }
        mask_by_relu(last, &inputs.values);
    }
}

/// Sums four vectors of eight on any machine, then the remainder one by one.
#[inline(always)]
fn dot<L: Lanes<Vector = f32x8>>(lanes: L, a: &[f32], b: &[f32]) -> f32 {
    const RUNS: usize = 4;
    let mut sums = [lanes.splat(0.0); RUNS];
    let ((a, a_left), (b, b_left)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    for (a, b) in a.chunks(RUNS).zip(b.chunks(RUNS)) {
        for ((a, b), sum) in a.iter().zip(b).zip(&mut sums) {
            *sum = lanes.multiply_add(lanes.load(a), lanes.load(b), *sum);
        }
    }
    let mut total = 0.0;
    for sum in sums {
        let sum: [f32; LANES] = pulp::cast(sum);
        for value in sum {
            total += value;
        }
    }
    for (a, b) in a_left.iter().zip(b_left) {
        total += a * b;
    }
    total
}

/// `sums += factor values`.
#[inline(always)]
fn add_scaled<L: Lanes<Vector = f32x8>>(lanes: L, sums: &mut [f32], values: &[f32], factor: f32) {
    let (sums, sums_left) = sums.as_chunks_mut::<LANES>();
    let (values, values_left) = values.as_chunks::<LANES>();
    let vector = lanes.splat(factor);
    for (sum, value) in sums.iter_mut().zip(values) {
        lanes.store(lanes.multiply_add(vector, lanes.load(value), lanes.load(sum)), sum);
    }
    for (sum, value) in sums_left.iter_mut().zip(values_left) {
        *sum += factor * value;
    }
}
