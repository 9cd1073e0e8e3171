//! Matrix product kernel: a block of sums stays in registers while two matrices are multiplied.
//!
//! `sums[i][n] += sum over k of a[i][k] b[k][n]`, where `n` is a channel. Three operations have
//! this form, because the columns of a window are contiguous: the outputs of a layer (`i` a
//! position, `k` a tap), the gradients with respect to its inputs (the same with the kernel
//! flipped), and the gradients with respect to its weights (`i` a tap, `k` a position). Every sum
//! is added in the order of `k`, for any blocks and vectors.

use super::lanes::Lanes;

/// A block of sums: `R` rows of `V` vectors.
pub(super) type Sums<L, const R: usize, const V: usize> = [[<L as Lanes>::Vector; V]; R];

/// Loads `V` vectors of a row from index `at` on.
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

/// Multiplies where `k` runs along each row of `a`; the rows begin `step` apart.
#[inline(always)]
pub(super) fn multiply_rows<L: Lanes, const R: usize, const V: usize>(
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

/// Multiplies where the rows of `a` are adjacent and `k` advances by `step` numbers.
#[inline(always)]
pub(super) fn multiply_columns<L: Lanes, const R: usize, const V: usize>(
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

/// Stores a block of sums in rows of `channels` numbers.
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

/// Loads a block of sums from rows of `channels` numbers.
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

/// Sets every sum to 0 whose gate is not above 0.
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

/// Operation on every block of a matrix of sums.
pub(super) trait Visit {
    /// Processes the block at `row` and `at`; does nothing if it lies outside the matrices.
    fn block<L: Lanes, const R: usize, const V: usize>(
        &mut self,
        lanes: L,
        row: usize,
        at: usize,
    ) -> Option<()>;
}

/// Divides `rows` rows of `channels` channels (a multiple of eight) into blocks: pairs of vectors,
/// single vectors, then narrow vectors for the remainder.
#[inline(always)]
pub(super) fn visit_blocks<L: Lanes>(lanes: L, rows: usize, channels: usize, visit: &mut impl Visit) {
    let mut at = 0;
    while L::PAIRS && channels - at >= 2 * L::WIDTH {
        visit_columns::<L, 2>(lanes, rows, at, visit);
        at += 2 * L::WIDTH;
    }
    while channels - at >= L::WIDTH {
        visit_columns::<L, 1>(lanes, rows, at, visit);
        at += L::WIDTH;
    }
    if at < channels {
        visit_columns::<L::Narrow, 1>(lanes.narrow(), rows, at, visit);
    }
}

/// Divides rows into the largest groups that the registers hold, then fours, twos and ones.
#[inline(always)]
fn visit_columns<L: Lanes, const V: usize>(lanes: L, rows: usize, at: usize, visit: &mut impl Visit) {
    let mut row = 0;
    while row < rows {
        row += match rows - row {
            1 => visit_block::<L, 1, V>(lanes, row, at, visit),
            2 | 3 => visit_block::<L, 2, V>(lanes, row, at, visit),
            // Four and four are faster than six and two: a group of two has too few independent
            // sums to hide their latency.
            8.. if L::ROWS >= 8 => visit_block::<L, 8, V>(lanes, row, at, visit),
            6 | 7 | 9.. if L::ROWS >= 6 => visit_block::<L, 6, V>(lanes, row, at, visit),
            _ => visit_block::<L, 4, V>(lanes, row, at, visit),
        };
    }
}

#[inline(always)]
fn visit_block<L: Lanes, const R: usize, const V: usize>(
    lanes: L,
    row: usize,
    at: usize,
    visit: &mut impl Visit,
) -> usize {
    let _ = visit.block::<L, R, V>(lanes, row, at);
    R
}
