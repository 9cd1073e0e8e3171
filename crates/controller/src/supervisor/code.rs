//! Continuous check of the code in flash: a flipped bit ends the run.
//!
//! The check is a CRC-32 ([`link::crc32`]) over code and constants except the networks, which
//! [`crate::store::Scrubber`] checks and which may be replaced. It detects every change within a
//! word and every two flipped bits; of all other changes it misses one in four thousand million.
//!
//! The build seals an image: it replaces the word [`UNSEALED`], which the check leaves out, by the
//! CRC. Thereby a flip before the start is detected as well. The CRC of an image without a seal is
//! compared with that of its first pass.

use core::ops::Range;

use inference::BearingMaterial;
use link::crc32::Digest;

/// Placeholder of the seal.
pub const UNSEALED: u32 = 0x5EA1_0FF5;
/// Number of address ranges that are checked: vector table and code, then the constants around the
/// built-in model images and the seal.
pub(crate) const SPANS: usize = BearingMaterial::COUNT + 3;

/// Returns the address ranges to check: the code, then what the model images and the seal leave of
/// the constants. `seal` is the address of the seal.
#[must_use]
pub fn spans(
    code: Range<usize>,
    constants: &Range<usize>,
    images: &[Range<usize>; BearingMaterial::COUNT],
    seal: usize,
) -> [Range<usize>; SPANS] {
    let seal = seal..seal.saturating_add(size_of::<u32>());
    let mut spans = [const { 0..0 }; SPANS];
    let [first, others @ ..] = &mut spans;
    *first = code;
    let mut start = constants.start;
    for span in others {
        let left_out = images.iter().chain([&seal]).filter(|range| range.start >= start);
        let next = left_out.min_by_key(|range| range.start);
        *span = start..next.map_or(constants.end, |range| range.start);
        start = next.map_or(constants.end, |range| range.end);
    }
    spans
}

/// Returns the seal of an image: the CRC-32 of the words in its [`spans`].
pub fn seal_of(words: impl Iterator<Item = u32>) -> u32 {
    let mut crc = Digest::default();
    words.for_each(|word| crc.update_word(word));
    crc.value()
}

/// Reads one image repeatedly.
#[derive(Clone, Debug)]
pub struct CodeCheck {
    /// Ascending addresses, divisible by 4.
    spans: [Range<usize>; SPANS],
    expected: Option<u32>,
    span: usize,
    address: usize,
    crc: Digest,
    is_corrupted: bool,
}

impl CodeCheck {
    /// Starts a pass. `seal` is the word that the build may have replaced.
    #[must_use]
    pub fn new(spans: [Range<usize>; SPANS], seal: u32) -> Self {
        let [first, ..] = &spans;
        Self {
            address: first.start,
            spans,
            expected: (seal != UNSEALED).then_some(seal),
            span: 0,
            crc: Digest::default(),
            is_corrupted: false,
        }
    }

    /// Reads at most `count` words. Returns whether any pass so far had a wrong CRC.
    pub(crate) fn step(&mut self, count: usize, read: impl Fn(usize) -> u32) -> bool {
        let Some(span) = self.spans.get(self.span) else {
            self.end_of_pass();
            return self.is_corrupted;
        };
        let end = span.end.min(self.address.saturating_add(count.saturating_mul(4)));
        let mut crc = self.crc;
        for address in (self.address..end).step_by(4) {
            crc.update_word(read(address));
        }
        self.crc = crc;
        self.address = end;
        if end >= span.end {
            self.span = self.span.wrapping_add(1);
            self.address = self.spans.get(self.span).map_or(0, |next| next.start);
        }
        self.is_corrupted
    }

    /// Reads everything once. Returns whether it is corrupted.
    pub(crate) fn pass(&mut self, read: impl Fn(usize) -> u32) -> bool {
        for _ in 0..=SPANS {
            self.step(usize::MAX / 8, &read);
        }
        self.is_corrupted
    }

    /// Returns the number of words in a pass.
    #[must_use]
    pub fn words(&self) -> usize {
        self.spans.iter().map(|span| span.len() / 4).fold(0, usize::saturating_add)
    }

    fn end_of_pass(&mut self) {
        let found = self.crc.value();
        self.is_corrupted |= *self.expected.get_or_insert(found) != found;
        self.span = 0;
        self.address = self.spans.first().map_or(0, |first| first.start);
        self.crc = Digest::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Place of the seal in the test's image.
    const SEAL: usize = 33;

    /// A sealed image of 90 words at address 400; the pieces between its ends are empty.
    fn image() -> (Vec<u32>, [Range<usize>; SPANS]) {
        let mut words: Vec<u32> = (0..90_u32).map(|index| index.wrapping_mul(0x0101_4567) ^ 77).collect();
        // A word sum, which rotates by 7 bits, does not see these two become zeros.
        words[51] = words[50].rotate_left(7);
        words[SEAL] = seal_of(words[..SEAL].iter().chain(&words[SEAL + 1..]).copied());
        let mut spans = [const { 480..480 }; SPANS];
        spans[..2].clone_from_slice(&[400..440, 440..480]);
        spans[SPANS - 2..].clone_from_slice(&[480..532, 536..760]);
        (words, spans)
    }

    fn is_corrupted(words: &[u32]) -> bool {
        CodeCheck::new(image().1, words[SEAL]).pass(reader(words))
    }

    #[test]
    fn model_images_and_the_seal_are_left_out_in_any_order() {
        const END: usize = 300 + 100 * BearingMaterial::COUNT;
        let images: [_; BearingMaterial::COUNT] =
            std::array::from_fn(|index| 300 + 100 * index..360 + 100 * index);
        let mut reversed = images.clone();
        reversed.reverse();
        // The seal is after the images.
        let expected: [_; SPANS] = std::array::from_fn(|index| match index {
            0 => 0..100,
            1 => 200..300,
            _ if index == SPANS - 1 => END - 16..END,
            _ if index == SPANS - 2 => END - 40..END - 20,
            _ => 160 + 100 * index..200 + 100 * index,
        });
        for images in [&images, &reversed] {
            assert_eq!(spans(0..100, &(200..END), images, END - 20), expected);
        }
        // The seal is the first word, or the last.
        let first: [_; SPANS] = std::array::from_fn(|index| match index {
            0 => 0..100,
            1 => 200..200,
            2 => 204..300,
            _ => 60 + 100 * index..100 + 100 * index,
        });
        assert_eq!(spans(0..100, &(200..END), &images, 200), first);
        let mut last = expected;
        last[SPANS - 2] = END - 40..END - 4;
        last[SPANS - 1] = END..END;
        assert_eq!(spans(0..100, &(200..END), &images, END - 4), last);
    }

    #[test]
    fn words_that_become_zeros_are_detected() {
        let (mut words, _) = image();
        words[50..52].fill(0);
        assert!(is_corrupted(&words));
    }

    fn reader(words: &[u32]) -> impl Fn(usize) -> u32 {
        |address| words[(address - 400) / 4]
    }

    #[test]
    fn a_sealed_image_passes_in_steps_of_any_length() {
        let (words, spans) = image();
        for count in [1, 7, 64, 1_000] {
            let mut check = CodeCheck::new(spans.clone(), words[SEAL]);
            assert_eq!(check.words(), 89);
            assert!((0..1_000).all(|_| !check.step(count, reader(&words))), "{count}");
            assert!(!check.pass(reader(&words)));
        }
    }

    #[test]
    fn an_unsealed_image_is_compared_with_its_first_pass() {
        let (mut words, spans) = image();
        words[SEAL] = UNSEALED;
        let mut check = CodeCheck::new(spans, UNSEALED);
        assert!(!check.pass(reader(&words)) && !check.pass(reader(&words)));
        words[80] ^= 1;
        assert!(check.pass(reader(&words)));
    }

    proptest! {
        #[test]
        fn every_change_within_a_word_is_detected(place in 0_usize..90, change in 1_u32..) {
            let (mut words, spans) = image();
            words[place] ^= change;
            let mut check = CodeCheck::new(spans, words[SEAL]);
            prop_assert!(check.pass(reader(&words)));
            words[place] ^= change;
            prop_assert!(check.pass(reader(&words)), "corruption is permanent");
        }

        #[test]
        fn every_two_flipped_bits_are_detected(first in 0_usize..90 * 32, second in 0_usize..90 * 32) {
            prop_assume!(first != second);
            let (mut words, _) = image();
            for bit in [first, second] {
                words[bit / 32] ^= 1 << (bit % 32);
            }
            prop_assert!(is_corrupted(&words));
        }
    }
}
