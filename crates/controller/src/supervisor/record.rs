//! The fault record as words in RAM that start-up does not clear.
//!
//! | word | content |
//! |---|---|
//! | 0 | [`MAGIC`] |
//! | 1 | state: [`FRESH`] until a start has reported it, [`REPORTED`] after |
//! | 2 | kind: 0 core, 1 stack overflow, 2 panic, `0x100 + mask` starved |
//! | 3-9 | PC, LR, CFSR, HFSR, address, MSP, build |
//! | 10 | 1 if the address is known |
//! | 11 | count |
//! | 12 | CRC-32 (ISO-HDLC) over the words before it, little endian |
//!
//! After power-on the RAM holds arbitrary values; a record is valid only with its checksum. Flipped
//! bits make it invalid and never another record: CRC-32 detects every error of up to 5 bits in
//! this length.

use link::BuildId;
use link::crc32::{INITIAL, crc32, update_word};
use link::start::{FaultKind, FaultRecord};

/// Number of words in a record.
pub const WORDS: usize = 13;
/// First word; changes with the layout.
pub const MAGIC: u32 = 0x504E_4601;
/// The record has not been reported yet.
const FRESH: u32 = 0xF7E5_F7E5;
/// A start has reported the record; it remains for its count.
const REPORTED: u32 = 0x0DD0_0DD0;

const STARVED: u32 = 0x100;

/// Returns the CRC-32 of the words before the last.
fn checksum(words: &[u32]) -> u32 {
    !words.iter().fold(INITIAL, |state, word| update_word(state, *word))
}

/// Returns the number that identifies a build's name in a record.
#[must_use]
pub fn build_hash(build: &BuildId) -> u32 {
    crc32(build.0.split(|&byte| byte == 0).next().unwrap_or_default())
}

/// Encodes a record as words.
#[must_use]
pub fn encode(record: &FaultRecord, fresh: bool) -> [u32; WORDS] {
    let kind = match record.kind {
        FaultKind::Core => 0,
        FaultKind::StackOverflow => 1,
        FaultKind::Panic => 2,
        FaultKind::Starved { missing } => STARVED | u32::from(missing),
    };
    let state = if fresh { FRESH } else { REPORTED };
    let (known, address) = (u32::from(record.address.is_some()), record.address.unwrap_or(0));
    let FaultRecord { pc, lr, cfsr, hfsr, msp, build, count, .. } = *record;
    let body = [MAGIC, state, kind, pc, lr, cfsr, hfsr, address, msp, build, known, count];
    let [a, b, c, d, e, f, g, h, i, j, k, l] = body;
    [a, b, c, d, e, f, g, h, i, j, k, l, checksum(&body)]
}

/// Decodes a record. Returns it with whether it has not been reported yet.
#[must_use]
pub fn decode(words: &[u32; WORDS]) -> Option<(FaultRecord, bool)> {
    let [magic, state, kind, pc, lr, cfsr, hfsr, address, msp, build, known, count, sum] = *words;
    let (body, _) = words.split_last_chunk::<1>()?;
    if magic != MAGIC || checksum(body) != sum {
        return None;
    }
    let kind = match (kind, kind & !0xFF, kind.to_le_bytes()) {
        (0, ..) => FaultKind::Core,
        (1, ..) => FaultKind::StackOverflow,
        (2, ..) => FaultKind::Panic,
        (_, STARVED, [missing, ..]) => FaultKind::Starved { missing },
        _ => return None,
    };
    let address = (known == 1).then_some(address);
    Some((FaultRecord { kind, pc, lr, cfsr, hfsr, address, msp, build, count }, state == FRESH))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn records() -> impl Strategy<Value = FaultRecord> {
        let kind = prop_oneof![
            Just(FaultKind::Core),
            Just(FaultKind::StackOverflow),
            Just(FaultKind::Panic),
            any::<u8>().prop_map(|missing| FaultKind::Starved { missing }),
        ];
        (kind, any::<[u32; 7]>(), any::<Option<u32>>()).prop_map(|(kind, words, address)| {
            let [pc, lr, cfsr, hfsr, msp, build, count] = words;
            FaultRecord { kind, pc, lr, cfsr, hfsr, address, msp, build, count }
        })
    }

    proptest! {
        #[test]
        fn a_written_record_is_read_back(record in records(), fresh: bool) {
            prop_assert_eq!(decode(&encode(&record, fresh)), Some((record, fresh)));
        }

        #[test]
        fn flipped_bits_are_never_another_record(
            record in records(),
            flips in prop::collection::btree_set((0..WORDS, 0_u32..32), 1..=5),
        ) {
            let mut words = encode(&record, true);
            for (word, bit) in flips {
                words[word] ^= 1 << bit;
            }
            prop_assert_eq!(decode(&words), None);
        }

        #[test]
        fn random_ram_is_no_record(words: [u32; WORDS]) {
            prop_assert_eq!(decode(&words), None);
        }
    }

    #[test]
    fn cleared_ram_is_no_record() {
        assert_eq!(decode(&[0; WORDS]), None);
        assert_eq!(decode(&[u32::MAX; WORDS]), None);
    }

    #[test]
    fn a_build_is_known_by_its_name() {
        assert_eq!(build_hash(&BuildId::new("123456789")), 0xCBF4_3926, "the check value of CRC-32/ISO-HDLC");
    }
}
