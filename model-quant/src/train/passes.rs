//! A few windows through a network and back, by [`super::block`].
//!
//! They go layer by layer, so that a layer's weights come into the nearest cache once for all of them; every sum still
//! takes its addends window by window.

use super::block::blocks;
use super::exact::{Counts, Exact};
use super::lanes::{LANES, Lanes};
use super::layout::{Layout, Place};
use super::room::Room;
use super::visits::{Collect, Convolve, Spread, stop};
use inference::features::FULL_SCALE;
use pulp::f32x8;

/// Windows that go together; with two or eight it is no faster.
pub(super) const GROUP: usize = 4;

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

/// Room for a group of windows.
#[derive(Clone, Debug)]
pub(super) struct Passes {
    rooms: Vec<Room>,
    /// Whole numbers of one window.
    counts: Counts,
    /// Sums of the head in whole numbers.
    sums: Vec<i32>,
}

impl Passes {
    pub(super) fn new(layout: &Layout) -> Self {
        let rooms = vec![Room::new(layout); GROUP];
        Self { rooms, counts: Counts::new(layout), sums: vec![0; layout.head.size.outputs] }
    }

    /// Up to [`GROUP`] windows forward; gives their rooms.
    #[inline(always)]
    pub(super) fn forward<L: Lanes>(
        &mut self,
        lanes: L,
        layout: &Layout,
        parameters: &[f32],
        windows: &[f32],
    ) -> &mut [Room] {
        let mut count = 0;
        for (room, window) in self.rooms.iter_mut().zip(windows.chunks_exact(layout.window())) {
            if let Some(first) = room.seen.first_mut() {
                for (slot, value) in first.inside_mut().iter_mut().zip(window) {
                    *slot = *value;
                }
            }
            count += 1;
        }
        let rooms = self.rooms.get_mut(..count).unwrap_or_default();
        for (index, place) in layout.convolutions.iter().enumerate() {
            for room in &mut *rooms {
                let [seen, behind] = &mut room.seen[index..index + 2] else { continue };
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
        }
        let weights = &parameters[layout.head.weights.clone()];
        for room in &mut *rooms {
            let Some(seen) = room.seen.last() else { continue };
            let rows = weights.chunks_exact(seen.values.len()).zip(&parameters[layout.head.biases.clone()]);
            for (output, (weights, bias)) in room.outputs.iter_mut().zip(rows) {
                *output = dot(lanes.narrow(), &seen.values, weights) + bias;
            }
        }
        rooms
    }

    /// The same in the controller's whole numbers, of which everything is kept in floats.
    #[inline(always)]
    pub(super) fn forward_exact(&mut self, layout: &Layout, exact: &Exact, windows: &[f32]) -> &mut [Room] {
        let mut count = 0;
        for (room, window) in self.rooms.iter_mut().zip(windows.chunks_exact(layout.window())) {
            let features = window.iter().map(|&value| {
                let scaled = value * f32::from(FULL_SCALE);
                // Halves away from zero, as `round`, which is slow without SSE4.1.
                (if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 }) as i16
            });
            exact.sums(layout, features, &mut self.counts, &mut self.sums);
            exact.outputs(&self.sums, &mut room.outputs);
            for (columns, (seen, step)) in room.seen.iter_mut().zip(exact.seen(&self.counts)) {
                for (slot, value) in columns.values.iter_mut().zip(seen) {
                    *slot = f32::from(*value) * step;
                }
            }
            count += 1;
        }
        self.rooms.get_mut(..count).unwrap_or_default()
    }
}

/// Adds the gradients of `sum of output_slopes[i] outputs[i]` of windows that went forward.
#[inline(always)]
pub(super) fn backward<L: Lanes>(
    lanes: L,
    (layout, turned): (&Layout, &Turned),
    parameters: &[f32],
    rooms: &mut [Room],
    gradient: &mut [f32],
) {
    for room in rooms.iter_mut().filter(|room| room.goes_back) {
        head_backward(lanes.narrow(), layout, parameters, room, gradient);
    }
    for (index, place) in layout.convolutions.iter().enumerate().rev() {
        let sums = &mut gradient[place.weights.clone()];
        let mut visit = Collect { rooms, layer: index, channels: place.size.outputs, sums };
        blocks(lanes, place.size.taps(), place.size.outputs, &mut visit);
        let biases = gradient[place.biases.clone()].as_chunks_mut::<LANES>().0;
        for room in rooms.iter_mut().filter(|room| room.goes_back) {
            let (earlier, later) = room.slopes.split_at_mut(index);
            let [slopes, ..] = later else { return };
            for row in slopes.inside().chunks_exact(place.size.outputs) {
                for (sum, slope) in biases.iter_mut().zip(row.as_chunks::<LANES>().0) {
                    for (sum, slope) in sum.iter_mut().zip(slope) {
                        *sum += slope;
                    }
                }
            }
            let (Some(before), Some(weights)) =
                (earlier.last_mut(), index.checked_sub(1).map(|i| &turned.0[i]))
            else {
                continue;
            };
            let mut visit = Spread {
                slopes: &slopes.values,
                step: slopes.channels,
                taps: place.size.kernel * place.size.outputs,
                weights,
                channels: place.size.inputs,
                seen: room.seen[index].inside(),
                outputs: before.inside_mut(),
            };
            blocks(lanes, place.size.columns, place.size.inputs, &mut visit);
        }
    }
}

#[inline(always)]
fn head_backward<L: Lanes<Vector = f32x8>>(
    lanes: L,
    layout: &Layout,
    parameters: &[f32],
    room: &mut Room,
    gradient: &mut [f32],
) {
    let Some(seen) = room.seen.last() else { return };
    let sums = gradient[layout.head.weights.clone()].chunks_exact_mut(seen.values.len());
    for (sums, slope) in sums.zip(&room.output_slopes) {
        add_scaled(lanes, sums, &seen.values, *slope);
    }
    for (sum, slope) in gradient[layout.head.biases.clone()].iter_mut().zip(&room.output_slopes) {
        *sum += slope;
    }
    if let Some(last) = room.slopes.last_mut() {
        let last = last.inside_mut();
        last.fill(0.0);
        let weights = parameters[layout.head.weights.clone()].chunks_exact(seen.values.len());
        for (weights, slope) in weights.zip(&room.output_slopes) {
            add_scaled(lanes, last, weights, *slope);
        }
        stop(last, &seen.values);
    }
}

/// Four runs of eight whatever the machine, then the rest one by one.
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
