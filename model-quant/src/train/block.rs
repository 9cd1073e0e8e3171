//! The one inner loop: a block of sums that stays in registers while a product of two matrices runs by.
//!
//! `sums[i][n] += sum over k of a[i][k] b[k][n]`, where `n` runs over the channels of a row, eight to a vector. A layer's
//! outputs (`i` a position, `k` a tap), the slopes over its inputs (the same with the kernel turned round) and those over
//! its weights (`i` a tap, `k` a position) are all of this form, because the columns of a window lie one behind the other.

use super::lanes::{LANES, Lanes};
use pulp::f32x8;

/// A block of sums: `R` rows of `V` vectors.
pub(super) type Sums<const R: usize, const V: usize> = [[f32x8; V]; R];

#[inline(always)]
pub(super) fn load(row: &[f32; LANES]) -> f32x8 {
    pulp::cast(*row)
}

/// The vectors of a row from channel `at` on; zeros where it is too short.
#[inline(always)]
pub(super) fn vectors<const V: usize>(row: &[f32], at: usize) -> [f32x8; V] {
    let mut found = [pulp::cast([0.0f32; LANES]); V];
    if let Some(row) = row.get(at..at + V * LANES) {
        for (vector, row) in found.iter_mut().zip(row.as_chunks().0) {
            *vector = load(row);
        }
    }
    found
}

/// `k` runs along each row of `a`; the rows begin `step` apart.
#[inline(always)]
pub(super) fn along<L: Lanes, const R: usize, const V: usize>(
    lanes: L,
    (a, step, count): (&[f32], usize, usize),
    (b, stride, at): (&[f32], usize, usize),
    sums: &mut Sums<R, V>,
) {
    let mut rows = [a; R];
    for (index, row) in rows.iter_mut().enumerate() {
        *row = a.get(index * step..index * step + count).unwrap_or_default();
        if row.len() != count {
            return;
        }
    }
    for (k, row) in b.chunks_exact(stride).take(count).enumerate() {
        let factors = vectors::<V>(row, at);
        for (row, sums) in rows.iter().zip(sums.iter_mut()) {
            let value = lanes.splat(row[k]);
            for (sum, factor) in sums.iter_mut().zip(factors) {
                *sum = lanes.multiply_add(value, factor, *sum);
            }
        }
    }
}

/// The rows of `a` lie side by side; a step of `k` is `step` numbers.
#[inline(always)]
pub(super) fn across<L: Lanes, const R: usize, const V: usize>(
    lanes: L,
    (a, step): (&[f32], usize),
    (b, stride, at): (&[f32], usize, usize),
    sums: &mut Sums<R, V>,
) {
    for (k, row) in b.chunks_exact(stride).enumerate() {
        let factors = vectors::<V>(row, at);
        let Some(values) = a.get(k * step..).and_then(<[f32]>::first_chunk::<R>) else { return };
        for (value, sums) in values.iter().zip(sums.iter_mut()) {
            let value = lanes.splat(*value);
            for (sum, factor) in sums.iter_mut().zip(factors) {
                *sum = lanes.multiply_add(value, factor, *sum);
            }
        }
    }
}

/// Calls a macro-like visitor for every block of a matrix of sums: rows in sixes, fours, twos and ones, vectors in pairs.
pub(super) trait Visit {
    /// Works on the rows from `row` and the channels from `at` on.
    fn block<L: Lanes, const R: usize, const V: usize>(&mut self, lanes: L, row: usize, at: usize);
}

/// Cuts `rows` rows of `channels` channels (a multiple of eight) into blocks.
#[inline(always)]
pub(super) fn blocks<L: Lanes>(lanes: L, rows: usize, channels: usize, visit: &mut impl Visit) {
    let mut at = 0;
    while at < channels {
        let wide = L::MANY && channels - at >= 2 * LANES;
        let mut row = 0;
        while row < rows {
            row += if wide {
                one::<L, 2>(lanes, rows, row, at, visit)
            } else {
                one::<L, 1>(lanes, rows, row, at, visit)
            };
        }
        at += if wide { 2 * LANES } else { LANES };
    }
}

#[inline(always)]
fn one<L: Lanes, const V: usize>(
    lanes: L,
    rows: usize,
    row: usize,
    at: usize,
    visit: &mut impl Visit,
) -> usize {
    match rows - row {
        0 | 1 => {
            visit.block::<L, 1, V>(lanes, row, at);
            1
        }
        2 | 3 => {
            visit.block::<L, 2, V>(lanes, row, at);
            2
        }
        4 | 5 => {
            visit.block::<L, 4, V>(lanes, row, at);
            4
        }
        _ => {
            visit.block::<L, 6, V>(lanes, row, at);
            6
        }
    }
}
