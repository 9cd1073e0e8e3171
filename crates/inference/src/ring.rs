//! The newest columns of a stream as one slice of memory, without moving any.

use crate::kernel::difference;

/// The newest `N` columns. Every column is kept twice, `N` places apart, so that wherever the oldest stands, the `N` columns from it on are
/// in order and side by side. When a column leaves, its two copies have to be the same still: whoever writes a column writes both. In front there are `N` - 1 columns of zeros for good:
/// the first columns after [`Self::clear`] have those before them.
#[derive(Clone, Copy, Debug)]
#[repr(align(4))]
pub(crate) struct Ring<A, const IN: usize, const N: usize> {
    /// The first of three times `N` is never shown: arrays have no length of `3 N - 1`.
    columns: [[[A; IN]; N]; 3],
    /// The place behind the zeros' first at which the newest `N` columns begin; `usize::MAX` before there is any.
    start: usize,
    /// Its complement.
    not_start: usize,
    /// Bits in which the copies of the column that left last were different, and what was found since; 0 is none.
    altered: usize,
}

/// Not 0 where two columns differ. Word by word where both stand at a word's address, as they do wherever a column takes whole words.
#[inline]
fn compare<A: bytemuck::Pod + PartialEq, const IN: usize>(first: &[A; IN], second: &[A; IN]) -> usize {
    match (bytemuck::try_cast_slice(first), bytemuck::try_cast_slice(second)) {
        (Ok(first), Ok(second)) => difference(first, second) as usize,
        _ => usize::from(first != second),
    }
}

impl<A: bytemuck::Pod + Default + PartialEq, const IN: usize, const N: usize> Ring<A, IN, N> {
    /// `N` columns of zeros: the causal padding.
    pub(crate) fn new() -> Self {
        Self { columns: [[[A::default(); IN]; N]; 3], start: usize::MAX, not_start: 0, altered: 0 }
    }

    /// Forgets the columns: from the next push on it is as [`Self::new`].
    #[inline]
    pub(crate) const fn clear(&mut self) {
        self.start = usize::MAX;
        self.not_start = 0;
    }

    /// Puts a column in the place of the oldest.
    #[inline]
    pub(crate) fn push(&mut self, column: &[A; IN]) {
        if let Some((first, second)) = self.open().split_first_mut()
            && let Some(second) = second.get_mut(N - 1)
        {
            (*first, *second) = (*column, *column);
        }
    }

    /// Lets the oldest column go; its place is the newest's, which is to be written by [`Self::newest`].
    #[inline]
    pub(crate) fn open(&mut self) -> &mut [[A; IN]] {
        let [_, first, second] = &self.columns;
        let order = self.start ^ !self.not_start;
        // Over the zeros at first, then over the two copies: 0, 1, .., 2 N - 2, N - 1, ..
        let start = self.start.wrapping_add(1);
        let start = if start < 2 * N - 1 { start } else { N - 1 };
        (self.start, self.not_start) = (start, !start);
        let slot = Self::slot(start);
        // A place that there is not is one that has been altered.
        let difference = match (first.get(slot), second.get(slot)) {
            (Some(first), Some(second)) => compare(first, second),
            _ => 1,
        };
        self.altered = difference | order;
        self.newest()
    }

    /// Takes what was found wrong while the newest column was written for something altered, unless it is 0.
    #[inline]
    pub(crate) const fn mark(&mut self, found: u32) {
        self.altered |= found as usize;
    }

    /// Memory from the newest column's first copy on: the second one is its column `N`.
    #[inline]
    pub(crate) fn newest(&mut self) -> &mut [[A; IN]] {
        let slot = Self::slot(self.start);
        let [_, copies @ ..] = &mut self.columns;
        copies.as_flattened_mut().get_mut(slot..).unwrap_or_default()
    }

    /// The newest column's place in either copy, told by where the columns begin.
    #[inline]
    const fn slot(start: usize) -> usize {
        if start < N { start } else { start.wrapping_sub(N) }
    }

    /// Not 0 where the column that left last was no longer what had been put there, the order of the columns is not, or the newest one has been marked.
    #[inline]
    pub(crate) const fn altered(&self) -> usize {
        self.altered
    }

    /// The columns, oldest first.
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
    /// Its memory, to be disturbed.
    pub(crate) fn bytes(&mut self) -> &mut [u8] {
        let [_, copies @ ..] = &mut self.columns;
        bytemuck::cast_slice_mut(copies.as_flattened_mut().as_flattened_mut())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cleared_ring_is_a_new_one() {
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
    fn a_bit_that_flips_in_either_copy_is_found_when_its_column_leaves() {
        let mut ring = Ring::<i16, 4, 3>::new();
        (0..10).for_each(|newest| ring.push(&[newest; 4]));
        let leaves = |mut ring: Ring<i16, 4, 3>| {
            let pushes = (1..5).find(|_| {
                ring.push(&[7; 4]);
                ring.altered() != 0
            });
            assert!((ring.push(&[7; 4]), ring.altered()).1 == 0, "and is gone then");
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
    fn a_mark_is_told_with_its_column_and_is_gone_with_the_next() {
        let mut ring = Ring::<i16, 2, 3>::new();
        ring.push(&[1, 2]);
        ring.mark(0);
        assert_eq!(ring.altered(), 0);
        ring.mark(8);
        ring.mark(0);
        assert_ne!(ring.altered(), 0);
        ring.push(&[3, 4]);
        assert_eq!(ring.altered(), 0);
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
