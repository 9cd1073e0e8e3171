//! CRC-32 (ISO-HDLC), four bytes at a time.
//!
//! Four tables of 256 words: a word of the message costs a dozen instructions on the controller, where a byte at a time costs two dozen.
//! The `crc` crate, which has one table or sixteen, is the oracle in the tests. After Kounavis and Berry, "Novel table lookup-based
//! algorithms for high-performance CRC generation" (2008).

/// The polynomial 0x04C11DB7, its bits in reverse order.
const POLYNOMIAL: u32 = 0xEDB8_8320;

/// `TABLES[k][b]`: the remainder of byte `b` with `k` zero bytes behind it.
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

/// The state before the first byte.
pub(crate) const START: u32 = u32::MAX;

/// Takes four bytes, the first one lowest.
#[inline]
pub(crate) fn take_word(state: u32, word: u32) -> u32 {
    let [a, b, c, d] = (state ^ word).to_le_bytes().map(usize::from);
    TABLES[3][a] ^ TABLES[2][b] ^ TABLES[1][c] ^ TABLES[0][d]
}

/// CRC-32 of a message.
#[must_use]
pub fn crc32(message: &[u8]) -> u32 {
    let (words, rest) = message.as_chunks::<4>();
    let state = words.iter().fold(START, |state, word| take_word(state, u32::from_le_bytes(*word)));
    let state = rest.iter().fold(state, |state, &byte| {
        let [low, ..] = (state ^ u32::from(byte)).to_le_bytes();
        (state >> 8) ^ TABLES[0][usize::from(low)]
    });
    !state
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_is_that_of_the_crc_crate(message in prop::collection::vec(any::<u8>(), 0..300)) {
            let oracle = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
            prop_assert_eq!(crc32(&message), oracle.checksum(&message));
        }
    }
}
