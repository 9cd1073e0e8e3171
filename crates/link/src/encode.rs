//! Encoding of messages as frames.
//!
//! COBS is written out here because a controller without panics cannot link the encoder of the
//! `cobs` crate with overflow checks on. The tests use that crate as the oracle.
//!
//! [`encode_estimate`] encodes estimates separately: the same bytes in a constant number of
//! instructions, for the controller's tick.

use core::hint::black_box;

use serde::Serialize;

use crate::crc32::{INITIAL, update_word};
use crate::sample::VALUES;
use crate::{DELIMITER, EstimateLayout, MAX_FRAME, MAX_PAYLOAD, NumberedEstimate, crc32};

/// Error: the message does not fit into a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncodeError;

impl core::fmt::Display for EncodeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "message longer than a frame of {MAX_FRAME} bytes")
    }
}

impl core::error::Error for EncodeError {}

/// Encodes a message into `frame` and returns the part to send, delimiter included.
///
/// # Errors
///
/// The message does not fit. Messages whose fields are in their ranges do.
pub fn encode<'a, M: Serialize>(
    message: &M,
    frame: &'a mut [u8; MAX_FRAME],
) -> Result<&'a [u8], EncodeError> {
    let mut payload = [0; MAX_PAYLOAD];
    let used = postcard::to_slice(message, &mut payload).map_err(|_| EncodeError)?;
    let (sum, used) = (crc32(used).to_le_bytes(), used.len());
    let (_, rest) = payload.split_at_mut_checked(used).ok_or(EncodeError)?;
    *rest.first_chunk_mut().ok_or(EncodeError)? = sum;
    let payload = used.checked_add(sum.len()).and_then(|len| payload.get(..len)).ok_or(EncodeError)?;
    let len = stuff(payload, frame).ok_or(EncodeError)?;
    frame.get(..len).ok_or(EncodeError)
}

/// Length of an estimate's message with its CRC, in bytes.
const ESTIMATE_PAYLOAD: usize = 4 * (VALUES + 7);
/// Length of an estimate on the wire, in bytes.
pub const ESTIMATE_FRAME: usize = ESTIMATE_PAYLOAD + 2;
/// Index of [`crate::ToHost::Estimate`] among the variants.
const ESTIMATE_KIND: u8 = 2;

/// Encodes an estimate: the bytes that [`encode`] gives for [`crate::ToHost::Estimate`], word by
/// word and without a branch on data.
///
/// `difference` gets the bits of the floats ([`crate::EstimateFrame::value_bits`]). It returns
/// 0 if they are those that were computed. If not, the CRC of the frame is made wrong, so the host
/// rejects it. The floats are checked after the CRC was computed, so that a later flip is detected
/// too.
#[inline]
pub fn encode_estimate(
    estimate: &NumberedEstimate,
    difference: impl FnOnce(&[u32; VALUES]) -> u32,
    frame: &mut [u8; ESTIMATE_FRAME],
) {
    let EstimateLayout([dropped, low, high], fields) = (*estimate).into();
    let mut words = [0; ESTIMATE_PAYLOAD / 4];
    let [first, content @ .., _] = &mut words;
    *first = u32::from_le_bytes([ESTIMATE_KIND, dropped, low, high]);
    *content = fields.map(u32::from_le_bytes);
    let [message @ .., sum] = &mut words;
    *sum = !message.iter().fold(INITIAL, |sum, word| update_word(sum, *word));
    let [_, _, _, _, values @ .., _, _] = &*black_box(message);
    *sum ^= difference(values);

    // Backwards: a zero becomes the distance to the next one; the delimiter is the last zero.
    let mut distance = 1_u32;
    for word in words.iter_mut().rev() {
        let Zeros { within, open, passed, kept } = ZEROS[zeros(*word)];
        *word |= open.wrapping_mul(distance).wrapping_add(within);
        distance = kept.wrapping_mul(distance).wrapping_add(passed);
    }
    let [code, payload @ .., delimiter] = frame;
    *code = distance as u8;
    let (places, _) = payload.as_chunks_mut::<4>();
    for (place, word) in places.iter_mut().zip(words) {
        *place = word.to_le_bytes();
    }
    *delimiter = DELIMITER;
}

/// Stuffing of one word, selected by which of its four bytes are zeros.
#[derive(Clone, Copy)]
struct Zeros {
    /// Distances in place of zeros: to the next zero in the word, or from the last zero to the end
    /// of the word.
    within: u32,
    /// Has a 1 in place of the last zero. It is multiplied by the distance from the word's end to
    /// the next zero.
    open: u32,
    /// Distance from the first zero to the start of the word; 4 without a zero.
    passed: u32,
    /// 1 if the word has no zero, so that the distance grows on.
    kept: u32,
}

static ZEROS: [Zeros; 16] = {
    let mut table = [Zeros { within: 0, open: 0, passed: 0, kept: 1 }; 16];
    let mut zeros = 0;
    while zeros < 16 {
        let mut entry = table[zeros];
        let mut byte = 4;
        while byte > 0 {
            byte -= 1;
            if zeros >> byte & 1 == 1 {
                entry.within |= entry.passed << (8 * byte);
                entry.open |= entry.kept << (8 * byte);
                entry.passed = 0;
                entry.kept = 0;
            }
            entry.passed += 1;
        }
        table[zeros] = entry;
        zeros += 1;
    }
    table
};

/// Returns one bit for each byte of a word that is zero.
fn zeros(word: u32) -> usize {
    const LOW: u32 = 0x7F7F_7F7F;
    // Sets the highest bit of each byte unless all its bits are clear.
    let others = (word & LOW).wrapping_add(LOW) | word;
    // Collects bits 7, 15, 23 and 31.
    ((!others & !LOW).wrapping_mul(1 << 21 | 1 << 14 | 1 << 7 | 1) >> 28) as usize
}

/// Applies COBS to a payload of fewer than 254 bytes: each zero becomes the distance to the next
/// one. Returns the number of bytes written.
fn stuff(payload: &[u8], frame: &mut [u8]) -> Option<usize> {
    let mut code_at = 0_usize;
    let mut end = 1_usize;
    for &byte in payload {
        if byte == 0 {
            *frame.get_mut(code_at)? = distance(code_at, end)?;
            code_at = end;
        } else {
            *frame.get_mut(end)? = byte;
        }
        end = end.checked_add(1)?;
    }
    *frame.get_mut(code_at)? = distance(code_at, end)?;
    *frame.get_mut(end)? = DELIMITER;
    end.checked_add(1)
}

fn distance(from: usize, to: usize) -> Option<u8> {
    u8::try_from(to.checked_sub(from)?).ok().filter(|&d| d < u8::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Decoder, EstimateFrame, FrameError, ToHost};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn stuffing_equals_that_of_the_cobs_crate(
            payload in prop::collection::vec(prop_oneof![Just(0_u8), any::<u8>()], 1..MAX_PAYLOAD),
        ) {
            let mut ours = [0xAA; MAX_FRAME];
            let len = stuff(&payload, &mut ours).unwrap();
            let mut theirs = cobs::encode_vec(&payload);
            theirs.push(DELIMITER);
            prop_assert_eq!(&ours[..len], &theirs[..]);
        }

        #[test]
        fn the_encoding_of_estimates_gives_the_bytes_of_the_general_one(
            dropped in any::<u8>(),
            low in any::<u8>(),
            high in prop_oneof![Just(0_u8), any::<u8>()],
            words in prop::array::uniform24(prop_oneof![Just(0_u32), 0..300_u32, any::<u32>()]),
        ) {
            let layout = EstimateLayout([dropped, low, high], words.map(u32::to_le_bytes));
            let estimate = NumberedEstimate::from(layout);
            let mut frame = [0; MAX_FRAME];
            let mut own = [0xAA; ESTIMATE_FRAME];
            encode_estimate(&estimate, |_| 0, &mut own);
            prop_assert_eq!(encode(&ToHost::Estimate(estimate), &mut frame).unwrap(), &own);
        }
    }

    #[test]
    fn a_flipped_bit_of_a_number_corrupts_the_frame() {
        let sound = EstimateFrame { normal_force_n: 7.5, flags: 3, ..EstimateFrame::default() };
        let frames = |estimate: EstimateFrame, computed: [u32; VALUES]| {
            let mut frame = [0; ESTIMATE_FRAME];
            encode_estimate(
                &NumberedEstimate { estimate, ..NumberedEstimate::default() },
                |values| values.iter().zip(computed).fold(0, |found, (now, then)| found | (now ^ then)),
                &mut frame,
            );
            let mut decoder = Decoder::new();
            frame.iter().filter_map(|&byte| decoder.push::<ToHost>(byte)).collect::<Vec<_>>()
        };
        assert!(matches!(frames(sound, sound.value_bits())[..], [Ok(ToHost::Estimate(_))]));
        for bit in 0..32 {
            let flip = |value: f32| f32::from_bits(value.to_bits() ^ 1 << bit);
            for place in 0..VALUES {
                let (mut values, mut estimate) = (sound.values(), sound);
                values[place] = flip(values[place]);
                estimate.set_values(values);
                assert_eq!(frames(estimate, sound.value_bits()), [Err(FrameError::Crc)], "{estimate:?}");
            }
        }
    }

    #[test]
    fn a_message_too_long_is_refused() {
        let mut frame = [0; MAX_FRAME];
        for words in [62, 63, 64, 80] {
            let message = vec![[1_u8; 4]; words];
            let fits = 1 + 4 * words + 4 <= MAX_PAYLOAD;
            assert_eq!(encode(&message, &mut frame).is_ok(), fits, "{words}");
        }
    }
}
