//! Newest columns of a stream as one slice of memory, without moving any column.

use crate::kernel::difference;

/// The newest `N` columns.
///
/// Every column is stored twice, `N` places apart. Wherever the oldest column is, the `N` columns
/// from there on are contiguous and in order. When a column leaves, its two copies must still be
/// equal; every write writes both copies. `N` - 1 columns of zeros precede them permanently: the
/// first columns after [`Self::clear`] use them as their predecessors.
#[derive(Clone, Copy, Debug)]
#[repr(align(4))]
pub(crate) struct Ring<A, const IN: usize, const N: usize> {
    /// The first of the `3 N` columns is never used: `3 N - 1` is no valid array length here.
    columns: [[[A; IN]; N]; 3],
    /// Place, counted from the second column of zeros, where the newest `N` columns begin;
    /// `usize::MAX` before the first column.
    start: usize,
    /// Complement of `start`.
    not_start: usize,
    /// Bits that differed between the copies of the column that left last, and what
    /// [`Self::mark_corrupted`] added; 0 if none.
    corruption: usize,
}

/// Returns non-zero if two columns differ. Compares words if both columns are word-aligned, which
/// every column with an integer number of words is.
#[inline]
fn compare<A: bytemuck::Pod + PartialEq, const IN: usize>(first: &[A; IN], second: &[A; IN]) -> usize {
    match (bytemuck::try_cast_slice(first), bytemuck::try_cast_slice(second)) {
        (Ok(first), Ok(second)) => difference(first, second) as usize,
        _ => usize::from(first != second),
    }
}

impl<A: bytemuck::Pod + Default + PartialEq, const IN: usize, const N: usize> Ring<A, IN, N> {
    /// Creates `N` columns of zeros: the causal padding.
    pub(crate) fn new() -> Self {
        Self { columns: [[[A::default(); IN]; N]; 3], start: usize::MAX, not_start: 0, corruption: 0 }
    }

    /// Clears the columns. After the next push the ring equals a new one with that column.
    #[inline]
    pub(crate) const fn clear(&mut self) {
        self.start = usize::MAX;
        self.not_start = 0;
    }

    /// Replaces the oldest column.
    #[inline]
    pub(crate) fn push(&mut self, column: &[A; IN]) {
        if let Some((first, second)) = self.advance().split_first_mut()
            && let Some(second) = second.get_mut(N - 1)
        {
            (*first, *second) = (*column, *column);
        }
    }

    /// Drops the oldest column and returns the memory of the newest, as [`Self::newest`]; the
    /// caller must write it.
    #[inline]
    pub(crate) fn advance(&mut self) -> &mut [[A; IN]] {
        let [_, first, second] = &self.columns;
        let order = self.start ^ !self.not_start;
        // First through the zeros, then through the two copies: 0, 1, .., 2 N - 2, N - 1, ..
        let start = self.start.wrapping_add(1);
        let start = if start < 2 * N - 1 { start } else { N - 1 };
        (self.start, self.not_start) = (start, !start);
        let slot = Self::slot(start);
        // An index outside the array is corrupted.
        let difference = match (first.get(slot), second.get(slot)) {
            (Some(first), Some(second)) => compare(first, second),
            _ => 1,
        };
        self.corruption = difference | order;
        self.newest()
    }

    /// Marks the newest column as corrupted if `found` is non-zero.
    #[inline]
    pub(crate) const fn mark_corrupted(&mut self, found: u32) {
        self.corruption |= found as usize;
    }

    /// Memory from the newest column's first copy on; the second copy is its column `N`.
    #[inline]
    pub(crate) fn newest(&mut self) -> &mut [[A; IN]] {
        let slot = Self::slot(self.start);
        let [_, copies @ ..] = &mut self.columns;
        copies.as_flattened_mut().get_mut(slot..).unwrap_or_default()
    }

    /// Returns the newest column's place in each copy, given where the columns begin.
    #[inline]
    const fn slot(start: usize) -> usize {
        if start < N { start } else { start.wrapping_sub(N) }
    }

    /// Non-zero if the column that left last or the order of the columns was corrupted, or if the
    /// newest column has been marked.
    #[inline]
    pub(crate) const fn corruption(&self) -> usize {
        self.corruption
    }

    /// Columns in order, oldest first.
    #[inline]
    pub(crate) fn columns(&self) -> &[[A; IN]; N] {
        let [zeros, first, _] = &self.columns;
        let shown = if self.start == usize::MAX { return zeros } else { self.start };
        let columns = self.columns.as_flattened().get(1..).unwrap_or_default();
        columns.get(shown..).and_then(<[_]>::first_chunk).unwrap_or(first)
    }
}

impl<A: bytemuck::Pod + Default + PartialEq, const IN: usize, const N: usize> Default for Ring<A, IN, N> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
impl<A: bytemuck::Pod, const IN: usize, const N: usize> Ring<A, IN, N> {
    /// Memory of both copies, for tests that flip bits.
    pub(crate) fn bytes(&mut self) -> &mut [u8] {
        let [_, copies @ ..] = &mut self.columns;
        bytemuck::cast_slice_mut(copies.as_flattened_mut().as_flattened_mut())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cleared_ring_equals_a_new_one() {
        for pushed in 0..7 {
            let (mut cleared, mut new) = (Ring::<i16, 2, 3>::new(), Ring::<i16, 2, 3>::new());
            (0..pushed).for_each(|_| cleared.push(&[7, 8]));
            cleared.clear();
            for newest in 1i16..8 {
                cleared.push(&[newest, -newest]);
                new.push(&[newest, -newest]);
                assert_eq!(cleared.columns(), new.columns(), "{pushed} before, {newest} since");
            }
        }
    }

    #[test]
    fn a_flipped_bit_in_either_copy_is_found_when_its_column_leaves() {
        let mut ring = Ring::<i16, 4, 3>::new();
        (0..10).for_each(|newest| ring.push(&[newest; 4]));
        let leaves = |mut ring: Ring<i16, 4, 3>| {
            let pushes = (1..5).find(|_| {
                ring.push(&[7; 4]);
                ring.corruption() != 0
            });
            assert!((ring.push(&[7; 4]), ring.corruption()).1 == 0, "and is gone then");
            pushes
        };
        assert_eq!(leaves(ring), None);
        for copy in 1..3 {
            for column in 0..3 {
                for bit in 0..16 {
                    let mut flipped = ring;
                    flipped.columns[copy][column][bit % 4] ^= 1 << bit;
                    assert!(leaves(flipped).is_some_and(|pushes| pushes <= 3));
                }
            }
        }
        for bit in 0..usize::BITS {
            let mut flipped = ring;
            flipped.start ^= 1 << bit;
            assert_eq!(leaves(flipped), Some(1));
        }
    }

    #[test]
    fn a_mark_is_reported_with_its_column_and_cleared_with_the_next() {
        let mut ring = Ring::<i16, 2, 3>::new();
        ring.push(&[1, 2]);
        ring.mark_corrupted(0);
        assert_eq!(ring.corruption(), 0);
        ring.mark_corrupted(8);
        ring.mark_corrupted(0);
        assert_ne!(ring.corruption(), 0);
        ring.push(&[3, 4]);
        assert_eq!(ring.corruption(), 0);
    }

    #[test]
    fn the_newest_columns_are_in_order() {
        let mut ring = Ring::<i16, 2, 3>::new();
        for newest in 1i16..20 {
            ring.push(&[newest, -newest]);
            let expected = [newest - 2, newest - 1, newest].map(|at| [at.max(0), -at.max(0)]);
            assert_eq!(ring.columns(), &expected);
        }
    }
}
