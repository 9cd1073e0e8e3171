//! CRC-32 (ISO-HDLC), four bytes at a time: the only CRC of link and controller.
//!
//! Four tables of 256 words: a word of the message costs a dozen instructions on the controller;
//! one byte at a time would cost two dozen. The `crc` crate has one table or sixteen; it is the
//! oracle in the tests. Method: Kounavis and Berry, "Novel table lookup-based algorithms for
//! high-performance CRC generation" (2008).

use core::hash::Hasher;

/// Polynomial 0x04C11DB7 with its bits in reverse order.
const POLYNOMIAL: u32 = 0xEDB8_8320;

/// `TABLES[k][b]` is the remainder of byte `b` followed by `k` zero bytes.
static TABLES: [[u32; 256]; 4] = tables();

const fn tables() -> [[u32; 256]; 4] {
    let mut tables = [[0; 256]; 4];
    let mut byte = 0;
    while byte < 256 {
        let mut remainder = byte as u32;
        let mut bit = 0;
        while bit < 8 {
            remainder = (remainder >> 1) ^ if remainder & 1 == 1 { POLYNOMIAL } else { 0 };
            bit += 1;
        }
        tables[0][byte] = remainder;
        byte += 1;
    }
    let mut zeros = 1;
    while zeros < 4 {
        let mut byte = 0;
        while byte < 256 {
            let before = tables[zeros - 1][byte];
            tables[zeros][byte] = (before >> 8) ^ tables[0][before as usize & 0xFF];
            byte += 1;
        }
        zeros += 1;
    }
    tables
}

/// State before the first byte.
pub const INITIAL: u32 = u32::MAX;

/// [`crc32`] of any message followed by its CRC in little-endian order.
pub const RESIDUE: u32 = 0x2144_DF1C;

/// Advances the state by four bytes, the lowest byte first. The work does not depend on the data.
#[inline]
#[must_use]
pub fn update_word(state: u32, word: u32) -> u32 {
    let [a, b, c, d] = (state ^ word).to_le_bytes().map(usize::from);
    TABLES[3][a] ^ TABLES[2][b] ^ TABLES[1][c] ^ TABLES[0][d]
}

/// Returns the CRC-32 of a message.
#[must_use]
pub fn crc32(message: &[u8]) -> u32 {
    let mut digest = Digest::default();
    digest.update(message);
    digest.value()
}

/// CRC-32 of a message that arrives in parts.
#[derive(Clone, Copy, Debug)]
pub struct Digest(u32);

impl Default for Digest {
    fn default() -> Self {
        Self(INITIAL)
    }
}

impl Digest {
    /// Adds bytes.
    pub fn update(&mut self, bytes: &[u8]) {
        let (words, tail) = bytes.as_chunks::<4>();
        let state = words.iter().fold(self.0, |state, word| update_word(state, u32::from_le_bytes(*word)));
        self.0 = tail.iter().fold(state, |state, &byte| {
            let [low, ..] = (state ^ u32::from(byte)).to_le_bytes();
            (state >> 8) ^ TABLES[0][usize::from(low)]
        });
    }

    /// Adds a word, the lowest byte first.
    #[inline]
    pub fn update_word(&mut self, word: u32) {
        self.0 = update_word(self.0, word);
    }

    /// Returns the CRC of what has been added.
    #[must_use]
    pub const fn value(self) -> u32 {
        !self.0
    }
}

/// Allows the CRC of a type with a derived [`core::hash::Hash`].
impl Hasher for Digest {
    fn finish(&self) -> u64 {
        self.value().into()
    }

    fn write(&mut self, bytes: &[u8]) {
        self.update(bytes);
    }

    fn write_u32(&mut self, word: u32) {
        self.update_word(word);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_agrees_with_the_crc_crate_however_the_message_is_split(
            message in prop::collection::vec(any::<u8>(), 0..300),
            split in any::<prop::sample::Index>(),
        ) {
            let oracle = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
            prop_assert_eq!(crc32(&message), oracle.checksum(&message));
            let (first, second) = message.split_at(split.index(message.len() + 1));
            let mut digest = Digest::default();
            digest.update(first);
            digest.update(second);
            prop_assert_eq!(digest.value(), oracle.checksum(&message));
        }

        #[test]
        fn words_count_as_their_bytes_from_the_lowest(words in prop::collection::vec(any::<u32>(), 0..30)) {
            let (mut by_word, mut hashed) = (Digest::default(), Digest::default());
            for word in &words {
                by_word.update_word(*word);
                hashed.write_u32(*word);
            }
            let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
            prop_assert_eq!([by_word.value(), hashed.value()], [crc32(&bytes); 2]);
        }

        #[test]
        fn a_message_with_its_crc_has_the_residue(message in prop::collection::vec(any::<u8>(), 0..300)) {
            let sum = crc32(&message).to_le_bytes();
            prop_assert_eq!(crc32(&[&message[..], &sum].concat()), RESIDUE);
        }
    }
}
