//! One window through a network and back, by [`super::block`]; everything of one window stays in the nearest cache.

use super::block::{Sums, Visit, across, along, blocks, load, vectors};
use super::exact::{Counts, Exact};
use super::lanes::{LANES, Lanes};
use super::layout::{Layout, Place};
use inference::features::FULL_SCALE;

/// Weights of the convolutions turned round for the way back: by column from the newest, output, then input.
#[derive(Clone, Debug)]
pub(super) struct Turned(Vec<Vec<f32>>);

impl Turned {
    pub(super) fn of(layout: &Layout, parameters: &[f32]) -> Self {
        let turn = |place: &Place| {
            let (size, weights) = (&place.size, &parameters[place.weights.clone()]);
            let mut turned = vec![0.0; weights.len()];
            for (tap, row) in weights.chunks_exact(size.outputs).enumerate() {
                let (column, input) = (size.kernel - 1 - tap / size.inputs, tap % size.inputs);
                for (output, weight) in row.iter().enumerate() {
                    turned[(column * size.outputs + output) * size.inputs + input] = *weight;
                }
            }
            turned
        };
        // Nothing is asked of the slopes over the window itself.
        Self(layout.convolutions.iter().skip(1).map(turn).collect())
    }
}

/// Columns with zeros around.
#[derive(Clone, Debug)]
struct Columns {
    values: Vec<f32>,
    channels: usize,
    /// Zero columns before the first.
    before: usize,
    count: usize,
}

impl Columns {
    fn new(before: usize, count: usize, after: usize, channels: usize) -> Self {
        Self { values: vec![0.0; (before + count + after) * channels], channels, before, count }
    }

    #[inline(always)]
    fn inside(&self) -> &[f32] {
        let start = self.before * self.channels;
        &self.values[start..start + self.count * self.channels]
    }

    #[inline(always)]
    fn inside_mut(&mut self) -> &mut [f32] {
        let start = self.before * self.channels;
        &mut self.values[start..start + self.count * self.channels]
    }
}

/// Room for one window.
#[derive(Clone, Debug)]
pub(super) struct Passes {
    /// What each layer sees, the head last.
    seen: Vec<Columns>,
    /// Slopes of the loss over what comes out of each convolution.
    slopes: Vec<Columns>,
    /// Sums of the head in whole numbers.
    sums: Vec<i32>,
    /// What comes out of the head.
    pub(super) outputs: Vec<f32>,
}

impl Passes {
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
        Self { seen, slopes, sums: vec![0; head.outputs], outputs: vec![0.0; head.outputs] }
    }

    #[inline(always)]
    pub(super) fn forward<L: Lanes>(
        &mut self,
        lanes: L,
        layout: &Layout,
        parameters: &[f32],
        window: &[f32],
    ) {
        if let Some(first) = self.seen.first_mut() {
            for (slot, value) in first.inside_mut().iter_mut().zip(window) {
                *slot = *value;
            }
        }
        for (index, place) in layout.convolutions.iter().enumerate() {
            let [seen, behind] = &mut self.seen[index..index + 2] else { return };
            let mut visit = Convolve {
                seen: &seen.values,
                step: seen.channels,
                taps: place.size.taps(),
                weights: &parameters[place.weights.clone()],
                biases: &parameters[place.biases.clone()],
                outputs: behind.inside_mut(),
            };
            blocks(lanes, place.size.positions, place.size.outputs, &mut visit);
        }
        let Some(seen) = self.seen.last() else { return };
        let weights = &parameters[layout.head.weights.clone()];
        let rows = weights.chunks_exact(seen.values.len()).zip(&parameters[layout.head.biases.clone()]);
        for (output, (weights, bias)) in self.outputs.iter_mut().zip(rows) {
            *output = dot(lanes, &seen.values, weights) + bias;
        }
    }

    /// The same in the controller's whole numbers, of which everything is kept in floats.
    #[inline(always)]
    pub(super) fn forward_exact(
        &mut self,
        layout: &Layout,
        exact: &Exact,
        window: &[f32],
        counts: &mut Counts,
    ) {
        let features = window.iter().map(|&value| {
            let scaled = value * f32::from(FULL_SCALE);
            // Halves away from zero, as `round`, which is slow without SSE4.1.
            (if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 }) as i16
        });
        exact.sums(layout, features, counts, &mut self.sums);
        exact.outputs(&self.sums, &mut self.outputs);
        for (columns, (seen, step)) in self.seen.iter_mut().zip(exact.seen(counts)) {
            for (slot, value) in columns.values.iter_mut().zip(seen) {
                *slot = f32::from(*value) * step;
            }
        }
    }

    /// Adds the gradient of `sum of slopes[i] outputs[i]`, after the same window's way forward.
    #[inline(always)]
    pub(super) fn backward<L: Lanes>(
        &mut self,
        lanes: L,
        (layout, turned): (&Layout, &Turned),
        parameters: &[f32],
        slopes: &[f32],
        gradient: &mut [f32],
    ) {
        let Some(seen) = self.seen.last() else { return };
        let weights = parameters[layout.head.weights.clone()].chunks_exact(seen.values.len());
        let sums = gradient[layout.head.weights.clone()].chunks_exact_mut(seen.values.len());
        for (sums, slope) in sums.zip(slopes) {
            add_scaled(lanes, sums, &seen.values, *slope);
        }
        for (sum, slope) in gradient[layout.head.biases.clone()].iter_mut().zip(slopes) {
            *sum += slope;
        }
        if let Some(last) = self.slopes.last_mut() {
            let last = last.inside_mut();
            last.fill(0.0);
            for (weights, slope) in weights.zip(slopes) {
                add_scaled(lanes, last, weights, *slope);
            }
            stop(last, &seen.values);
        }
        for (index, place) in layout.convolutions.iter().enumerate().rev() {
            let (earlier, later) = self.slopes.split_at_mut(index);
            let [slopes, ..] = later else { return };
            let seen = &self.seen[index];
            let mut visit = Collect {
                seen: &seen.values,
                step: seen.channels,
                slopes: slopes.inside(),
                channels: place.size.outputs,
                sums: &mut gradient[place.weights.clone()],
            };
            blocks(lanes, place.size.taps(), place.size.outputs, &mut visit);
            let biases = &mut gradient[place.biases.clone()];
            for row in slopes.inside().chunks_exact(place.size.outputs) {
                for (sum, slope) in
                    biases.as_chunks_mut::<LANES>().0.iter_mut().zip(row.as_chunks::<LANES>().0)
                {
                    for (sum, slope) in sum.iter_mut().zip(slope) {
                        *sum += slope;
                    }
                }
            }
            let (Some(before), Some(weights)) =
                (earlier.last_mut(), index.checked_sub(1).map(|i| &turned.0[i]))
            else {
                return;
            };
            let mut visit = Spread {
                slopes: &slopes.values,
                step: slopes.channels,
                taps: place.size.kernel * place.size.outputs,
                weights,
                channels: place.size.inputs,
                seen: seen.inside(),
                outputs: before.inside_mut(),
            };
            blocks(lanes, place.size.columns, place.size.inputs, &mut visit);
        }
    }
}

/// The outputs of a convolution with ReLU.
struct Convolve<'a> {
    seen: &'a [f32],
    step: usize,
    taps: usize,
    weights: &'a [f32],
    biases: &'a [f32],
    outputs: &'a mut [f32],
}

impl Visit for Convolve<'_> {
    #[inline(always)]
    fn block<L: Lanes, const R: usize, const V: usize>(&mut self, lanes: L, row: usize, at: usize) {
        let channels = self.biases.len();
        let mut sums: Sums<R, V> = [vectors(self.biases, at); R];
        let seen = self.seen.get(row * self.step..).unwrap_or_default();
        along(lanes, (seen, self.step, self.taps), (self.weights, channels, at), &mut sums);
        store(self.outputs, channels, row, at, &sums, |sum| if sum > 0.0 { sum } else { 0.0 });
    }
}

/// The slopes over what a convolution sees, through the ReLU that gave it.
struct Spread<'a> {
    slopes: &'a [f32],
    step: usize,
    taps: usize,
    weights: &'a [f32],
    channels: usize,
    seen: &'a [f32],
    outputs: &'a mut [f32],
}

impl Visit for Spread<'_> {
    #[inline(always)]
    fn block<L: Lanes, const R: usize, const V: usize>(&mut self, lanes: L, row: usize, at: usize) {
        let mut sums: Sums<R, V> = [vectors(&[], 0); R];
        let slopes = self.slopes.get(row * self.step..).unwrap_or_default();
        along(lanes, (slopes, self.step, self.taps), (self.weights, self.channels, at), &mut sums);
        for (index, sums) in sums.iter().enumerate() {
            let start = (row + index) * self.channels + at;
            let (Some(out), Some(seen)) =
                (self.outputs.get_mut(start..start + V * LANES), self.seen.get(start..start + V * LANES))
            else {
                return;
            };
            let rows = out.as_chunks_mut::<LANES>().0.iter_mut().zip(seen.as_chunks::<LANES>().0);
            for ((out, seen), sum) in rows.zip(sums) {
                let sum: [f32; LANES] = pulp::cast(*sum);
                for ((out, seen), sum) in out.iter_mut().zip(seen).zip(sum) {
                    *out = if *seen > 0.0 { sum } else { 0.0 };
                }
            }
        }
    }
}

/// The gradient over a convolution's weights, added up.
struct Collect<'a> {
    seen: &'a [f32],
    step: usize,
    slopes: &'a [f32],
    channels: usize,
    sums: &'a mut [f32],
}

impl Visit for Collect<'_> {
    #[inline(always)]
    fn block<L: Lanes, const R: usize, const V: usize>(&mut self, lanes: L, row: usize, at: usize) {
        let mut sums: Sums<R, V> = [vectors(&[], 0); R];
        for (index, sums) in sums.iter_mut().enumerate() {
            let start = (row + index) * self.channels;
            *sums = vectors(self.sums.get(start..start + self.channels).unwrap_or_default(), at);
        }
        let seen = self.seen.get(row..).unwrap_or_default();
        across(lanes, (seen, self.step), (self.slopes, self.channels, at), &mut sums);
        store(self.sums, self.channels, row, at, &sums, |sum| sum);
    }
}

#[inline(always)]
fn store<const R: usize, const V: usize>(
    out: &mut [f32],
    channels: usize,
    row: usize,
    at: usize,
    sums: &Sums<R, V>,
    last: impl Fn(f32) -> f32,
) {
    for (index, sums) in sums.iter().enumerate() {
        let start = (row + index) * channels + at;
        let Some(out) = out.get_mut(start..start + V * LANES) else { return };
        for (out, sum) in out.as_chunks_mut::<LANES>().0.iter_mut().zip(sums) {
            let sum: [f32; LANES] = pulp::cast(*sum);
            for (out, sum) in out.iter_mut().zip(sum) {
                *out = last(sum);
            }
        }
    }
}

/// Slopes end where a ReLU gave 0.
#[inline(always)]
fn stop(slopes: &mut [f32], seen: &[f32]) {
    for (slope, seen) in slopes.iter_mut().zip(seen) {
        *slope = if *seen > 0.0 { *slope } else { 0.0 };
    }
}

/// Four runs of eight, then the rest one by one.
#[inline(always)]
fn dot<L: Lanes>(lanes: L, a: &[f32], b: &[f32]) -> f32 {
    const RUNS: usize = 4;
    let mut sums = [lanes.splat(0.0); RUNS];
    let ((a, a_left), (b, b_left)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    for (a, b) in a.chunks(RUNS).zip(b.chunks(RUNS)) {
        for ((a, b), sum) in a.iter().zip(b).zip(&mut sums) {
            *sum = lanes.multiply_add(load(a), load(b), *sum);
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
fn add_scaled<L: Lanes>(lanes: L, sums: &mut [f32], values: &[f32], factor: f32) {
    let (sums, sums_left) = sums.as_chunks_mut::<LANES>();
    let (values, values_left) = values.as_chunks::<LANES>();
    let vector = lanes.splat(factor);
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum = pulp::cast(lanes.multiply_add(vector, load(value), load(sum)));
    }
    for (sum, value) in sums_left.iter_mut().zip(values_left) {
        *sum += factor * value;
    }
}
