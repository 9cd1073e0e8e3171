//! The code in flash is read over and over: a bit that is not what it was ends the run.
//!
//! A sum over the words of code and constants, networks apart (those are [`crate::store::scrub`]'s and may be replaced):
//!
//! ```text
//! s' = K rotl(s xor word, 5)  modulo 2^32
//! ```
//!
//! Every step is one to one in the word as in the sum, so whatever changes within one word is noticed for certain, anything else but for one
//! case in 2^32. The build seals an image: the word [`UNSEALED`] is replaced by the one with which the whole comes to [`SEALED`]
//! ([`sealing`]), so that a flip from before the start is noticed, too. An image that nobody has sealed is held against its own first pass.
//!
//! A word costs some seven instructions.

use core::ops::Range;

/// What stands for the seal until there is one.
pub const UNSEALED: u32 = 0x5EA1_0FF5;
/// The sum of a sealed image.
pub const SEALED: u32 = 0x9142_7E35;
/// Pieces that the code may come in.
pub const SPANS: usize = 4;

/// What a sum begins with.
pub(crate) const START: u32 = u32::MAX;
const FACTOR: u32 = 0x9E37_79B1;
/// `FACTOR` times this is 1 modulo 2^32.
const INVERSE: u32 = inverse(FACTOR);
const TURN: u32 = 5;

/// The inverse of an odd number modulo 2^32, by Newton's iteration: each round doubles the bits that are right.
const fn inverse(number: u32) -> u32 {
    let mut inverse = number;
    let mut round = 0;
    while round < 5 {
        inverse = inverse.wrapping_mul(2_u32.wrapping_sub(number.wrapping_mul(inverse)));
        round += 1;
    }
    inverse
}

/// Takes a word.
#[inline]
pub(crate) const fn add(sum: u32, word: u32) -> u32 {
    (sum ^ word).rotate_left(TURN).wrapping_mul(FACTOR)
}

/// The word that must stand between the words before and behind it for the whole to come to [`SEALED`].
#[must_use]
pub fn sealing(before: impl Iterator<Item = u32>, behind: impl DoubleEndedIterator<Item = u32>) -> u32 {
    let at = before.fold(START, add);
    let from = |sum: u32| sum.wrapping_mul(INVERSE).rotate_right(TURN);
    let after = behind.rev().fold(SEALED, |sum, word| from(sum) ^ word);
    from(after) ^ at
}

/// Reads one image over and over.
#[derive(Clone, Debug)]
pub struct CodeCheck {
    /// Addresses, in order, divisible by 4.
    spans: [Range<usize>; SPANS],
    expected: Option<u32>,
    span: usize,
    address: usize,
    sum: u32,
    altered: bool,
}

impl CodeCheck {
    /// Starts a pass. `seal` is the word that the build may have replaced.
    #[must_use]
    pub fn new(spans: [Range<usize>; SPANS], seal: u32) -> Self {
        let [first, ..] = &spans;
        Self {
            address: first.start,
            spans,
            expected: (seal != UNSEALED).then_some(SEALED),
            span: 0,
            sum: START,
            altered: false,
        }
    }

    /// Reads so many words and perhaps a few less; whether any pass so far came to another sum than it should.
    pub fn step(&mut self, count: usize, read: impl Fn(usize) -> u32) -> bool {
        let Some(span) = self.spans.get(self.span) else {
            self.end_of_pass();
            return self.altered;
        };
        let end = span.end.min(self.address.saturating_add(count.saturating_mul(4)));
        let mut sum = self.sum;
        for address in (self.address..end).step_by(4) {
            sum = add(sum, read(address));
        }
        self.sum = sum;
        self.address = end;
        if end >= span.end {
            self.span = self.span.wrapping_add(1);
            self.address = self.spans.get(self.span).map_or(0, |next| next.start);
        }
        self.altered
    }

    /// Reads all of it once; whether it is altered.
    pub fn pass(&mut self, read: impl Fn(usize) -> u32) -> bool {
        for _ in 0..=SPANS {
            self.step(usize::MAX / 8, &read);
        }
        self.altered
    }

    /// Words of a pass.
    #[must_use]
    pub fn words(&self) -> usize {
        self.spans.iter().map(|span| span.len() / 4).fold(0, usize::saturating_add)
    }

    fn end_of_pass(&mut self) {
        self.altered |= *self.expected.get_or_insert(self.sum) != self.sum;
        self.span = 0;
        self.address = self.spans.first().map_or(0, |first| first.start);
        self.sum = START;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// An image of 90 words at address 400 in four pieces, sealed at its 33rd word.
    fn image() -> (Vec<u32>, [Range<usize>; SPANS]) {
        let mut words: Vec<u32> = (0..90_u32).map(|index| index.wrapping_mul(0x0101_4567) ^ 77).collect();
        words[33] = sealing(words[..33].iter().copied(), words[34..].iter().copied());
        (words, [400..440, 440..480, 480..480, 480..760])
    }

    fn reader(words: &[u32]) -> impl Fn(usize) -> u32 {
        |address| words[(address - 400) / 4]
    }

    #[test]
    fn a_sealed_image_passes_in_steps_of_any_length() {
        let (words, spans) = image();
        for count in [1, 7, 64, 1_000] {
            let mut check = CodeCheck::new(spans.clone(), words[33]);
            assert_eq!(check.words(), 90);
            assert!((0..1_000).all(|_| !check.step(count, reader(&words))), "{count}");
            assert!(!check.pass(reader(&words)));
        }
    }

    #[test]
    fn an_image_without_a_seal_is_held_against_its_first_pass() {
        let (mut words, spans) = image();
        words[33] = UNSEALED;
        let mut check = CodeCheck::new(spans, UNSEALED);
        assert!(!check.pass(reader(&words)) && !check.pass(reader(&words)));
        words[80] ^= 1;
        assert!(check.pass(reader(&words)));
    }

    proptest! {
        #[test]
        fn whatever_changes_within_a_word_is_noticed(place in 0_usize..90, change in 1_u32..) {
            let (mut words, spans) = image();
            let seal = words[33];
            words[place] ^= change;
            // Even a seal that looks as if there were none.
            let mut check = CodeCheck::new(spans, seal);
            prop_assert!(check.pass(reader(&words)));
            words[place] ^= change;
            prop_assert!(check.pass(reader(&words)), "once altered, altered for good");
        }
    }
}
