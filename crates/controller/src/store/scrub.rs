//! Continuous check of the networks in use: one word per tick.
//!
//! An image ends with the CRC-32 of everything before it. The CRC over the complete image is then
//! the same constant for every image ([`RESIDUE`]); another value means that a bit has flipped. A
//! round over an image of 8,380 bytes takes 2,095 ticks, so a flip is detected after at most two
//! rounds: 0.42 s at 10 kHz. The work of a tick depends neither on the data nor on the position.

use link::crc32::{INITIAL, RESIDUE, update_word};

/// Reads one image repeatedly.
#[derive(Clone, Debug)]
pub(crate) struct Scrubber {
    words: &'static [[u8; 4]],
    position: usize,
    sum: u32,
    is_corrupted: bool,
}

impl Scrubber {
    /// Starts a round over an image.
    #[must_use]
    pub(crate) const fn new(image: &'static [u8]) -> Self {
        let words = image.as_chunks::<4>().0;
        // An empty image would pass: a word of zeros is its own checksum.
        Self { words, position: 0, sum: INITIAL, is_corrupted: words.is_empty() }
    }

    /// Reads one word. Returns whether any round so far had a wrong CRC.
    #[inline]
    pub(crate) fn step(&mut self) -> bool {
        let word = self.words.get(self.position).copied().unwrap_or_default();
        let sum = update_word(self.sum, u32::from_le_bytes(word));
        let next = self.position.wrapping_add(1);
        let ended = next >= self.words.len();
        self.is_corrupted |= ended & (!sum != RESIDUE);
        // Masks instead of a branch: the last word of a round costs as much as the others.
        let keep = u32::from(!ended).wrapping_neg();
        self.sum = sum & keep | INITIAL & !keep;
        self.position = next & keep as usize;
        self.is_corrupted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use inference::{BearingMaterial, shipped};

    impl Scrubber {
        /// Returns the words of a round: the ticks that it takes.
        fn round(&self) -> usize {
            self.words.len()
        }
    }

    #[test]
    fn an_intact_image_passes_every_round() {
        for bearing in BearingMaterial::ALL {
            let mut scrubber = Scrubber::new(shipped(bearing));
            assert_eq!(scrubber.round(), shipped(bearing).len() / 4);
            assert!((0..5 * scrubber.round()).all(|_| !scrubber.step()));
        }
    }

    #[test]
    fn every_flipped_bit_is_detected_at_the_end_of_the_round() {
        let image = shipped(BearingMaterial::Plastic);
        for bit in (0..image.len() * 8).step_by(37).chain([0, image.len() * 8 - 1]) {
            let mut copy = image.to_vec();
            copy[bit / 8] ^= 1 << (bit % 8);
            let mut scrubber = Scrubber::new(copy.leak());
            let noticed = (1..).find(|_| scrubber.step());
            assert_eq!(noticed, Some(scrubber.round()), "bit {bit}");
        }
    }

    #[test]
    fn a_missing_image_is_corrupted() {
        assert!(Scrubber::new(&[]).step());
    }
}
