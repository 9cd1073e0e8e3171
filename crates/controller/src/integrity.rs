//! Protection of memory against bit flips, applied to state from outside.
//!
//! The numerics do not depend on this module. The owner of a state wraps it in [`Guarded`], which
//! stores a word sum with the state. The owner checks the sum before it reads the state and forms
//! it anew after it has changed the state. A value that waits in memory during other work is
//! guarded in the same way.
//!
//! * **State of the filter**: [`Guarded`] from the end of a tick to the start of the next.
//! * **Estimate of the filter**: [`Guarded`] while the networks work.
//! * **Numbers of an estimate until they are encoded**: word sum, checked by the monitor and when
//!   the frame is encoded.
//! * **Open impact, block of estimates, records that wait**: [`Guarded`] ([`crate::impacts`]).
//! * **Configuration and everything derived from it**: CRC-32, formed when it is set and checked in
//!   the idle loop.
//! * **Code in flash**: CRC-32, in the idle loop ([`crate::supervisor::code`]).
//! * **Networks in use**: CRC-32, one word a tick (`store::scrub`).
//! * **History of the networks**: stored twice and compared (crate `inference`).
//! * **Plausibility checks, alarms**: no protection. An error of a check leaves with its samples, a
//!   raised alarm ends with the tracked quantity.
//!
//! There are two checksums. The word sum costs two instructions a word and serves within a tick and
//! from one tick to the next. It detects every flip of a single bit, but it is linear: two flips in
//! different words cancel in about one of 32 pairs. Everything else has a CRC-32 ([`link::crc32`]),
//! which detects every flip of two bits and every change within a word.

use contact::{FrictionLaw, StribeckShape};
use fixed::types::U2F30;
use inference::Flags;
use link::crc32::Digest;
use nalgebra::SMatrix;

pub(crate) use inference::word_sum::{WordSum, read_anew};

/// A checksum that takes words.
pub(crate) trait Checksum {
    /// Adds a word.
    fn add_word(&mut self, word: u32);
}

impl Checksum for WordSum {
    #[inline]
    fn add_word(&mut self, word: u32) {
        self.add_word(word);
    }
}

impl Checksum for Digest {
    #[inline]
    fn add_word(&mut self, word: u32) {
        self.update_word(word);
    }
}

/// A value that can be added to a checksum word by word.
///
/// [`words!`] implements it for a struct. Every field is named there, so a field that is forgotten
/// does not compile.
pub(crate) trait Words {
    /// Adds every word of the value to a checksum.
    fn add_to(&self, sum: &mut impl Checksum);

    /// Returns the sum of the value alone.
    #[inline]
    fn word_sum(&self) -> WordSum {
        let mut sum = WordSum::default();
        self.add_to(&mut sum);
        sum
    }
}

/// Implements [`Words`] for a struct, field by field.
macro_rules! words {
    ($type:ty { $($field:ident),+ $(,)? }) => {
        impl $crate::integrity::Words for $type {
            #[inline]
            fn add_to(&self, sum: &mut impl $crate::integrity::Checksum) {
                let Self { $($field),+ } = self;
                $($crate::integrity::Words::add_to($field, sum);)+
            }
        }
    };
}
pub(crate) use words;

/// Implements [`Words`] for types that convert to a word without loss.
macro_rules! one_word {
    ($($type:ty => |$value:ident| $word:expr),+ $(,)?) => {
        $(impl Words for $type {
            #[inline]
            fn add_to(&self, sum: &mut impl Checksum) {
                let $value = *self;
                sum.add_word($word);
            }
        })+
    };
}

one_word! {
    u32 => |value| value,
    i32 => |value| value.cast_unsigned(),
    f32 => |value| value.to_bits(),
    bool => |value| u32::from(value),
    u8 => |value| u32::from(value),
    u16 => |value| u32::from(value),
    U2F30 => |value| value.to_bits(),
    Flags => |value| value.bits(),
}

impl Words for i64 {
    #[inline]
    fn add_to(&self, sum: &mut impl Checksum) {
        self.cast_unsigned().add_to(sum);
    }
}

impl Words for u64 {
    #[inline]
    fn add_to(&self, sum: &mut impl Checksum) {
        sum.add_word(*self as u32);
        sum.add_word((*self >> 32) as u32);
    }
}

impl<const R: usize, const C: usize> Words for SMatrix<f32, R, C> {
    #[inline]
    fn add_to(&self, sum: &mut impl Checksum) {
        self.as_slice().iter().for_each(|value| value.add_to(sum));
    }
}

impl<T: Words> Words for Option<T> {
    #[inline]
    fn add_to(&self, sum: &mut impl Checksum) {
        self.is_some().add_to(sum);
        if let Some(value) = self {
            value.add_to(sum);
        }
    }
}

impl Words for FrictionLaw<f32> {
    fn add_to(&self, sum: &mut impl Checksum) {
        let Self {
            coulomb_coefficient,
            static_coefficient,
            stribeck_speed_m_s,
            shape,
            viscous_slope_s_m,
            viscous_onset_m_s,
            regularisation_m_s,
        } = *self;
        [coulomb_coefficient, static_coefficient, stribeck_speed_m_s].add_to(sum);
        [viscous_slope_s_m, viscous_onset_m_s, regularisation_m_s].add_to(sum);
        matches!(shape, StribeckShape::Gauss).add_to(sum);
    }
}

impl<T: Words, const N: usize> Words for [T; N] {
    #[inline]
    fn add_to(&self, sum: &mut impl Checksum) {
        self.iter().for_each(|value| value.add_to(sum));
    }
}

/// A state with its word sum.
#[derive(Clone, Debug, Default)]
pub(crate) struct Guarded<T> {
    value: T,
    sum: WordSum,
}

impl<T: Words> Guarded<T> {
    /// Guards a value.
    pub(crate) fn new(value: T) -> Self {
        let sum = value.word_sum();
        Self { value, sum }
    }

    /// Returns true if a bit of the value or of its sum has flipped since the sum was formed.
    #[inline]
    #[must_use]
    pub(crate) fn is_corrupted(&self) -> bool {
        self.value.word_sum() != self.sum
    }

    /// The value, to be changed. The sum is stale until [`Self::seal`].
    #[inline]
    pub(crate) const fn value_mut(&mut self) -> &mut T {
        &mut self.value
    }

    /// Forms the sum anew. If `corrupted`, it is made wrong, so that the next check finds the state
    /// corrupted.
    #[inline]
    pub(crate) fn seal(&mut self, corrupted: bool) {
        self.sum = self.value.word_sum().marked(corrupted);
    }

    /// Stores a value that waits while something else works.
    #[inline]
    pub(crate) fn store(&mut self, value: T) {
        self.value = value;
        self.seal(false);
        read_anew(self);
    }

    /// Reads the value back from memory, not from a copy in a register; returns it with
    /// [`Self::is_corrupted`].
    #[inline]
    pub(crate) fn load(&mut self) -> (T, bool)
    where
        T: Copy,
    {
        read_anew(self);
        (self.value, self.is_corrupted())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Copy, Debug, Default)]
    struct State {
        integer: i32,
        wide: i64,
        float: f32,
        pair: [u32; 2],
        set: bool,
    }
    words!(State { integer, wide, float, pair, set });

    const STATE: State = State { integer: -7, wide: 1 << 40, float: 2.5, pair: [3, 4], set: true };

    #[test]
    fn every_flipped_bit_of_value_or_sum_is_detected() {
        let guarded = Guarded::new(STATE);
        assert!(!guarded.is_corrupted());
        let flip = |change: &dyn Fn(&mut Guarded<State>)| {
            let mut flipped = guarded.clone();
            change(&mut flipped);
            flipped.is_corrupted()
        };
        for bit in 0..32 {
            assert!(flip(&|g| g.value.integer ^= 1 << bit), "bit {bit}");
            assert!(flip(&|g| g.value.wide ^= 1 << (2 * bit)), "bit {bit}");
            assert!(flip(&|g| g.value.wide ^= 2 << (2 * bit)), "bit {bit}");
            assert!(
                flip(&|g| g.value.float = f32::from_bits(g.value.float.to_bits() ^ 1 << bit)),
                "bit {bit}"
            );
            assert!(flip(&|g| g.value.pair[0] ^= 1 << bit), "bit {bit}");
            assert!(flip(&|g| g.value.pair[1] ^= 1 << bit), "bit {bit}");
        }
        assert!(flip(&|g| g.value.set = false));
        assert!(flip(&|g| g.sum = g.sum.marked(true)));
    }

    #[test]
    fn a_change_is_accepted_once_it_is_sealed() {
        let mut guarded = Guarded::new(STATE);
        guarded.value_mut().integer = 9;
        assert!(guarded.is_corrupted());
        guarded.seal(false);
        assert!(!guarded.is_corrupted() && guarded.value.integer == 9);
        guarded.seal(true);
        assert!(guarded.is_corrupted());
    }

    #[test]
    fn a_stored_value_is_loaded_back() {
        let mut guarded = Guarded::<State>::default();
        guarded.store(STATE);
        let (value, corrupted) = guarded.load();
        assert!(!corrupted && value.wide == STATE.wide);
        guarded.value.pair[1] ^= 1;
        assert!(guarded.load().1);
    }
}
