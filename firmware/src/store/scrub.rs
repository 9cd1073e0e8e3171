//! The networks in use are read over and over, one word a tick, and their check sum computed anew.
//!
//! An image ends with the CRC-32 of what is before it, and the CRC over the whole then comes to the same number for every image; another number
//! means that a bit is not what it was. A round over an image of 8,380 bytes takes 2,095 ticks, so an alteration is noticed after at most
//! two rounds: 0.42 s at 10 kHz. The work of a tick does not depend on what is read nor on where it is.

/// The CRC of an image with its CRC behind it, before the last inversion.
const RESIDUE: u32 = 0xDEBB_20E3;

/// Steps of four bits of the reflected CRC-32 (ISO-HDLC).
const NIBBLES: [u32; 16] = {
    let mut table = [0; 16];
    let mut index = 0;
    #[expect(clippy::indexing_slicing, reason = "run by the compiler")]
    while index < 16 {
        let mut value = index as u32;
        let mut bit = 0;
        while bit < 4 {
            value = value >> 1 ^ if value & 1 == 1 { 0xEDB8_8320 } else { 0 };
            bit += 1;
        }
        table[index] = value;
        index += 1;
    }
    table
};

/// Reads one image over and over.
#[derive(Clone, Debug)]
pub struct Scrubber {
    words: &'static [[u8; 4]],
    position: usize,
    sum: u32,
    altered: bool,
}

impl Scrubber {
    /// Starts a round over an image.
    #[must_use]
    pub const fn new(image: &'static [u8]) -> Self {
        let words = image.as_chunks::<4>().0;
        // Nothing at all would pass: a word of zeros is its own check sum.
        Self { words, position: 0, sum: u32::MAX, altered: words.is_empty() }
    }

    /// Reads one word; whether any round so far came to another number than it should.
    #[inline]
    pub fn step(&mut self) -> bool {
        let word = self.words.get(self.position).copied().unwrap_or_default();
        let mut sum = self.sum ^ u32::from_le_bytes(word);
        for _ in 0..8 {
            let step = NIBBLES.get((sum & 15) as usize).copied().unwrap_or_default();
            sum = sum >> 4 ^ step;
        }
        let next = self.position.wrapping_add(1);
        let ended = next >= self.words.len();
        self.altered |= ended & (sum != RESIDUE);
        // Masks in place of a branch: the last word of a round costs what the others cost.
        let keep = u32::from(!ended).wrapping_neg();
        self.sum = sum & keep | !keep;
        self.position = next & keep as usize;
        self.altered
    }

    /// Words of a round: ticks that it takes.
    #[must_use]
    pub const fn round(&self) -> usize {
        self.words.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use inference::{Bearing, shipped};

    #[test]
    fn a_sound_image_stays_sound_round_after_round() {
        for bearing in Bearing::ALL {
            let mut scrubber = Scrubber::new(shipped(bearing));
            assert_eq!(scrubber.round(), shipped(bearing).len() / 4);
            assert!((0..5 * scrubber.round()).all(|_| !scrubber.step()));
        }
    }

    #[test]
    fn every_flipped_bit_is_noticed_at_the_end_of_the_round() {
        let image = shipped(Bearing::Plastic);
        for bit in (0..image.len() * 8).step_by(37).chain([0, image.len() * 8 - 1]) {
            let mut copy = image.to_vec();
            copy[bit / 8] ^= 1 << (bit % 8);
            let mut scrubber = Scrubber::new(copy.leak());
            let noticed = (1..).find(|_| scrubber.step());
            assert_eq!(noticed, Some(scrubber.round()), "bit {bit}");
        }
    }

    #[test]
    fn an_image_that_is_not_there_is_altered() {
        assert!(Scrubber::new(&[]).step());
    }
}
