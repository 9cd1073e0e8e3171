//! The newest columns of a stream as one slice of memory, without moving any.

/// The newest `N` columns. Every column is kept twice, `N` places apart, so that wherever the oldest stands, the `N` columns from it on are
/// in order and side by side.
#[derive(Clone, Copy, Debug)]
#[repr(align(4))]
pub(crate) struct Ring<A, const IN: usize, const N: usize> {
    columns: [[[A; IN]; N]; 2],
    oldest: usize,
}

/// Copies a column; word by word where both stand at a word's address, as they do wherever a column takes whole words.
#[inline]
fn copy<A: bytemuck::Pod, const IN: usize>(from: &[A; IN], to: &mut [A; IN]) {
    let words = bytemuck::try_cast_slice(from).ok().zip(bytemuck::try_cast_slice_mut(to).ok());
    let copied = words.is_some_and(|(from, to): (&[u32], &mut [u32])| {
        to.iter_mut().zip(from).for_each(|(to, from)| *to = *from);
        true
    });
    if !copied {
        *to = *from;
    }
}

impl<A: bytemuck::Pod + Default, const IN: usize, const N: usize> Ring<A, IN, N> {
    /// `N` columns of zeros: the causal padding.
    pub(crate) fn new() -> Self {
        Self { columns: [[[A::default(); IN]; N]; 2], oldest: 0 }
    }

    /// Forgets the columns: as [`Self::new`], but for those that no slice will show before they are written.
    #[inline]
    pub(crate) fn clear(&mut self) {
        let [first, _] = &mut self.columns;
        first.iter_mut().skip(1).for_each(|column| *column = [A::default(); IN]);
        self.oldest = 0;
    }

    /// Puts a column in the place of the oldest.
    #[inline]
    pub(crate) fn push(&mut self, column: &[A; IN]) {
        for half in &mut self.columns {
            if let Some(slot) = half.get_mut(self.oldest) {
                copy(column, slot);
            }
        }
        let next = self.oldest.wrapping_add(1);
        self.oldest = if next < N { next } else { 0 };
    }

    /// The columns, oldest first.
    #[inline]
    pub(crate) fn columns(&self) -> &[[A; IN]; N] {
        let [first, _] = &self.columns;
        self.columns.as_flattened().get(self.oldest..).and_then(<[_]>::first_chunk).unwrap_or(first)
    }
}

impl<A: bytemuck::Pod + Default, const IN: usize, const N: usize> Default for Ring<A, IN, N> {
    fn default() -> Self {
        Self::new()
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
    fn the_newest_columns_are_in_order() {
        let mut ring = Ring::<i16, 2, 3>::new();
        for newest in 1i16..20 {
            ring.push(&[newest, -newest]);
            let expected = [newest - 2, newest - 1, newest].map(|at| [at.max(0), -at.max(0)]);
            assert_eq!(ring.columns(), &expected);
        }
    }
}
