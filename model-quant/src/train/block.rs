//! The one inner loop: a block of sums that stays in registers while a product of two matrices runs by.
//!
//! `sums[i][n] += sum over k of a[i][k] b[k][n]`, where `n` runs over the channels of a row. A layer's outputs (`i` a
//! position, `k` a tap), the slopes over its inputs (the same with the kernel turned round) and those over its weights
//! (`i` a tap, `k` a position) are all of this form, because the columns of a window lie one behind the other. Every sum
//! takes its addends in the order of `k`, whatever the blocks and vectors are.

use super::lanes::Lanes;

/// A block of sums: `R` rows of `V` vectors.
pub(super) type Sums<L, const R: usize, const V: usize> = [[<L as Lanes>::Vector; V]; R];

/// The vectors from a place in a row on.
#[inline(always)]
pub(super) fn vectors<L: Lanes, const V: usize>(lanes: L, row: &[f32], at: usize) -> Option<[L::Vector; V]> {
    let row = row.get(at..at + V * L::WIDTH)?;
    let mut found = [lanes.splat(0.0); V];
    for (vector, row) in found.iter_mut().zip(row.chunks_exact(L::WIDTH)) {
        *vector = lanes.load(row);
    }
    Some(found)
}

#[inline(always)]
fn add<L: Lanes, const V: usize>(lanes: L, value: f32, factors: [L::Vector; V], sums: &mut [L::Vector; V]) {
    let value = lanes.splat(value);
    for (sum, factor) in sums.iter_mut().zip(factors) {
        *sum = lanes.multiply_add(value, factor, *sum);
    }
}

/// `k` runs along each row of `a`; the rows begin `step` apart.
#[inline(always)]
pub(super) fn along<L: Lanes, const R: usize, const V: usize>(
    lanes: L,
    (a, step, count): (&[f32], usize, usize),
    (b, stride, at): (&[f32], usize, usize),
    mut sums: Sums<L, R, V>,
) -> Option<Sums<L, R, V>> {
    let mut rows = [a; R];
    for (index, row) in rows.iter_mut().enumerate() {
        *row = a.get(index * step..index * step + count)?;
    }
    for (k, row) in b.chunks_exact(stride).take(count).enumerate() {
        let factors = vectors::<L, V>(lanes, row, at)?;
        for (row, sums) in rows.iter().zip(&mut sums) {
            add(lanes, *row.get(k)?, factors, sums);
        }
    }
    Some(sums)
}

/// The rows of `a` lie side by side; a step of `k` is `step` numbers.
#[inline(always)]
pub(super) fn across<L: Lanes, const R: usize, const V: usize>(
    lanes: L,
    (a, step): (&[f32], usize),
    (b, stride, at): (&[f32], usize, usize),
    mut sums: Sums<L, R, V>,
) -> Option<Sums<L, R, V>> {
    for (k, row) in b.chunks_exact(stride).enumerate() {
        let factors = vectors::<L, V>(lanes, row, at)?;
        let values: &[f32; R] = a.get(k * step..)?.first_chunk()?;
        for (value, sums) in values.iter().zip(&mut sums) {
            add(lanes, *value, factors, sums);
        }
    }
    Some(sums)
}

/// Puts a block of sums into rows of `channels` numbers.
#[inline(always)]
pub(super) fn store<L: Lanes, const R: usize, const V: usize>(
    lanes: L,
    sums: &Sums<L, R, V>,
    (rows, channels): (&mut [f32], usize),
    (row, at): (usize, usize),
) -> Option<()> {
    for (index, sums) in sums.iter().enumerate() {
        let start = (row + index) * channels + at;
        let out = rows.get_mut(start..start + V * L::WIDTH)?;
        for (out, sum) in out.chunks_exact_mut(L::WIDTH).zip(sums) {
            lanes.store(*sum, out);
        }
    }
    Some(())
}

/// The block of sums in such rows.
#[inline(always)]
pub(super) fn load<L: Lanes, const R: usize, const V: usize>(
    lanes: L,
    (rows, channels): (&[f32], usize),
    (row, at): (usize, usize),
) -> Option<Sums<L, R, V>> {
    let mut sums = [[lanes.splat(0.0); V]; R];
    for (index, sums) in sums.iter_mut().enumerate() {
        *sums = vectors(lanes, rows, (row + index) * channels + at)?;
    }
    Some(sums)
}

/// A block of sums, each where its gate is above 0.
#[inline(always)]
pub(super) fn gate<L: Lanes, const R: usize, const V: usize>(
    lanes: L,
    mut sums: Sums<L, R, V>,
    gates: &Sums<L, R, V>,
) -> Sums<L, R, V> {
    for (sums, gates) in sums.iter_mut().zip(gates) {
        for (sum, gate) in sums.iter_mut().zip(gates) {
            *sum = lanes.gate(*sum, *gate);
        }
    }
    sums
}

/// Calls a macro-like visitor for every block of a matrix of sums.
pub(super) trait Visit {
    /// Works on the rows from `row` and the channels from `at` on; nothing where they do not lie in the matrices.
    fn block<L: Lanes, const R: usize, const V: usize>(
        &mut self,
        lanes: L,
        row: usize,
        at: usize,
    ) -> Option<()>;
}

/// Cuts `rows` rows of `channels` channels (a multiple of eight) into blocks: pairs of vectors, single ones, then what is
/// left in narrow ones.
#[inline(always)]
pub(super) fn blocks<L: Lanes>(lanes: L, rows: usize, channels: usize, visit: &mut impl Visit) {
    let mut at = 0;
    while L::PAIRS && channels - at >= 2 * L::WIDTH {
        columns::<L, 2>(lanes, rows, at, visit);
        at += 2 * L::WIDTH;
    }
    while channels - at >= L::WIDTH {
        columns::<L, 1>(lanes, rows, at, visit);
        at += L::WIDTH;
    }
    if at < channels {
        columns::<L::Narrow, 1>(lanes.narrow(), rows, at, visit);
    }
}

/// Cuts rows into as many as the registers hold, then fours, twos and ones.
#[inline(always)]
fn columns<L: Lanes, const V: usize>(lanes: L, rows: usize, at: usize, visit: &mut impl Visit) {
    let mut row = 0;
    while row < rows {
        row += match rows - row {
            1 => one::<L, 1, V>(lanes, row, at, visit),
            2 | 3 => one::<L, 2, V>(lanes, row, at, visit),
            // Eight are better cut in halves than into six and two: few sums wait for themselves.
            8.. if L::ROWS >= 8 => one::<L, 8, V>(lanes, row, at, visit),
            6 | 7 | 9.. if L::ROWS >= 6 => one::<L, 6, V>(lanes, row, at, visit),
            _ => one::<L, 4, V>(lanes, row, at, visit),
        };
    }
}

#[inline(always)]
fn one<L: Lanes, const R: usize, const V: usize>(
    lanes: L,
    row: usize,
    at: usize,
    visit: &mut impl Visit,
) -> usize {
    let _ = visit.block::<L, R, V>(lanes, row, at);
    R
}
