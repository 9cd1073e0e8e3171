//! One window through a network and back: outputs, then the gradient over every parameter.

use crate::network::{LayerSize, Network, Shape, rectify};

/// Activations and slopes of one window.
#[derive(Clone, Debug)]
pub(crate) struct Passes {
    sizes: Vec<LayerSize>,
    /// What each layer sees, with its zeros around.
    seen: Vec<Vec<f32>>,
    /// Slopes of the loss over the same.
    slopes: Vec<Vec<f32>>,
    outputs: Vec<f32>,
}

impl Passes {
    /// Room for a window of a shape.
    pub(crate) fn new(shape: &Shape) -> Self {
        let sizes = shape.layers();
        let padded: Vec<Vec<f32>> =
            sizes.iter().map(|size| vec![0.0; (size.positions + size.kernel - 1) * size.inputs]).collect();
        Self { sizes, slopes: padded.clone(), seen: padded, outputs: vec![0.0; shape.outputs] }
    }

    /// The first output.
    pub(crate) fn forward(&mut self, network: &Network, window: &[f32]) -> f32 {
        let mut columns = window.to_vec();
        let head = self.sizes.len() - 1;
        for (index, ((layer, size), seen)) in
            network.layers().iter().zip(&self.sizes).zip(&mut self.seen).enumerate()
        {
            for (slot, value) in seen.iter_mut().skip(size.before * size.inputs).zip(&columns) {
                *slot = *value;
            }
            columns.clear();
            columns.resize(size.positions * size.outputs, 0.0);
            let windows = seen.windows(size.taps()).step_by(size.inputs);
            for (taps, sums) in windows.zip(columns.chunks_exact_mut(size.outputs)) {
                layer.sums(taps, sums);
            }
            if index < head {
                rectify(&mut columns);
            }
        }
        self.outputs = columns;
        self.outputs.first().copied().unwrap_or_default()
    }

    /// Adds the gradient of `slope * output` to `gradient`, after [`Passes::forward`] of the same window.
    pub(crate) fn backward(&mut self, network: &Network, slope: f32, gradient: &mut Network) {
        let mut behind = vec![slope];
        let mut gradients: Vec<&mut [f32]> = gradient.slices_mut().collect();
        for index in (0..self.sizes.len()).rev() {
            let (size, seen) = (&self.sizes[index], &self.seen[index]);
            let slopes = &mut self.slopes[index];
            slopes.fill(0.0);
            let weights = &network.layers()[index].weights;
            for (position, row) in behind.chunks_exact(size.outputs).enumerate() {
                for (bias, slope) in gradients[2 * index + 1].iter_mut().zip(row) {
                    *bias += slope;
                }
                let start = position * size.inputs;
                let taps = &seen[start..start + size.taps()];
                let rows = weights
                    .chunks_exact(size.outputs)
                    .zip(gradients[2 * index].chunks_exact_mut(size.outputs));
                for (((weights, sums), x), back) in
                    rows.zip(taps).zip(&mut slopes[start..start + size.taps()])
                {
                    for ((sum, weight), slope) in sums.iter_mut().zip(weights).zip(row) {
                        *sum += x * slope;
                        *back += weight * slope;
                    }
                }
            }
            let inside = size.before * size.inputs..(size.before + size.columns) * size.inputs;
            behind.clear();
            behind.extend(
                (slopes[inside.clone()].iter().zip(&seen[inside]))
                    .map(|(slope, x)| if *x > 0.0 { *slope } else { 0.0 }),
            );
        }
    }
}
