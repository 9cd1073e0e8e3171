//! The inner loops of training: forward, gradient over the weights, gradient over the inputs.
//!
//! They run over fixed arrays of 16 channels or 48 taps and vectorise in plain safe code. Only `+` and `*` in a fixed
//! order, never contracted and never dispatched on the machine: the same bits wherever arithmetic is IEEE 754.

use crate::net::Taps;
use crate::shapes::HIDDEN_TAPS;
use inference::model::CHANNELS;

/// All columns of a convolution with ReLU, two at a time.
#[inline(always)]
pub(crate) fn convolve<const T: usize>(
    inputs: &[f32],
    stride: usize,
    weights: &Taps<T>,
    bias: &[f32; CHANNELS],
    outputs: &mut [[f32; CHANNELS]],
) {
    for (pair, outputs) in outputs.as_chunks_mut::<2>().0.iter_mut().enumerate() {
        let start = 2 * pair * stride;
        let older = &inputs[start..start + T];
        let newer = &inputs[start + stride..start + stride + T];
        let mut sums = [*bias; 2];
        for ((row, a), b) in weights.iter().zip(older).zip(newer) {
            for (sum, w) in sums[0].iter_mut().zip(row) {
                *sum += a * w;
            }
            for (sum, w) in sums[1].iter_mut().zip(row) {
                *sum += b * w;
            }
        }
        for (output, sum) in outputs.as_flattened_mut().iter_mut().zip(sums.as_flattened()) {
            *output = if *sum > 0.0 { *sum } else { 0.0 };
        }
    }
}

/// Adds the gradient over the weights of a convolution.
#[inline(always)]
pub(crate) fn collect<const T: usize>(
    inputs: &[f32],
    stride: usize,
    slopes: &[[f32; CHANNELS]],
    weights: &mut Taps<T>,
    bias: &mut [f32; CHANNELS],
) {
    for (pair, slopes) in slopes.as_chunks::<2>().0.iter().enumerate() {
        let start = 2 * pair * stride;
        let older = &inputs[start..start + T];
        let newer = &inputs[start + stride..start + stride + T];
        for ((row, a), b) in weights.iter_mut().zip(older).zip(newer) {
            for ((w, p), q) in row.iter_mut().zip(&slopes[0]).zip(&slopes[1]) {
                *w += a * p + b * q;
            }
        }
        for ((g, p), q) in bias.iter_mut().zip(&slopes[0]).zip(&slopes[1]) {
            *g += p + q;
        }
    }
}

/// The gradient over the inputs of a convolution, through the ReLU that gave them.
#[inline(always)]
pub(crate) fn spread(
    slopes: &[[f32; CHANNELS]],
    weights: &[[f32; HIDDEN_TAPS]; CHANNELS],
    activations: &[[f32; CHANNELS]],
    out: &mut [[f32; CHANNELS]],
) {
    let flat = out.as_flattened_mut();
    for (position, slopes) in slopes.iter().enumerate() {
        let mut sums = [0.0f32; HIDDEN_TAPS];
        for (slope, row) in slopes.iter().zip(weights) {
            if *slope != 0.0 {
                for (sum, w) in sums.iter_mut().zip(row) {
                    *sum += slope * w;
                }
            }
        }
        let start = position * CHANNELS;
        for (slot, sum) in flat[start..start + HIDDEN_TAPS].iter_mut().zip(&sums) {
            *slot += sum;
        }
    }
    for (slot, activation) in flat.iter_mut().zip(activations.as_flattened()) {
        if *activation <= 0.0 {
            *slot = 0.0;
        }
    }
}
