//! Message to frame.
//!
//! The COBS stage is written out here because a controller that must not contain a panic cannot link the `cobs` crate's encoder
//! with overflow checks on; the crate is the oracle in the tests.
//!
//! Estimates have a way of their own, [`encode_estimate`]: same bytes, a fixed number of instructions, for the controller's tick.

use core::hint::black_box;

use serde::Serialize;

use crate::check_sum::{START, take_word};
use crate::{DELIMITER, EstimateLayout, MAX_FRAME, MAX_PAYLOAD, NumberedEstimate, crc32};

/// The message does not fit into a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncodeError;

impl core::fmt::Display for EncodeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "message longer than a frame of {MAX_FRAME} bytes")
    }
}

impl core::error::Error for EncodeError {}

/// Encodes a message into `frame` and returns the part that goes on the wire, delimiter included.
///
/// # Errors
///
/// The message does not fit; none of this crate's messages is that long.
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

/// Bytes of an estimate's message with its CRC.
const ESTIMATE_PAYLOAD: usize = 52;
/// Bytes of an estimate on the wire.
pub const ESTIMATE_FRAME: usize = ESTIMATE_PAYLOAD + 2;
/// Position of [`crate::ToHost::Estimate`] among the variants.
const ESTIMATE_KIND: u8 = 2;

/// Encodes an estimate: the bytes that [`encode`] gives for [`crate::ToHost::Estimate`], word by word and without a branch on data.
///
/// `parity` is that of its floats as they were computed ([`crate::EstimateFrame::parity`]). With another one, a bit of them has flipped since; the check sum
/// is then wrong, so that nobody takes the frame. It is looked at behind the check sum: what flips before that or later shows, too.
#[inline]
pub fn encode_estimate(estimate: &NumberedEstimate, parity: u32, frame: &mut [u8; ESTIMATE_FRAME]) {
    let EstimateLayout([dropped, low, high], fields) = (*estimate).into();
    let [a, b, c, d, e, f, g, h, i, j, k] = fields;
    let first = [ESTIMATE_KIND, dropped, low, high];
    let mut words = [first, a, b, c, d, e, f, g, h, i, j, k, [0; 4]].map(u32::from_le_bytes);
    let [message @ .., sum] = &mut words;
    *sum = !message.iter().fold(START, |sum, word| take_word(sum, *word));
    let [_, _, _, _, numbers @ .., _, _] = &*black_box(message);
    *sum ^= numbers.iter().fold(parity, |found, number| found ^ number);

    // From the end: a zero becomes the distance to the next one, the delimiter being the last.
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

/// What stuffing makes of the zeros of a word, by which of its four bytes are zeros.
#[derive(Clone, Copy)]
struct Zeros {
    /// In place of each zero but the last the distance to the next one in the word, of the last one that to the word's end.
    within: u32,
    /// 1 in place of the last zero: times the distance from the word's end to the next zero.
    open: u32,
    /// Distance from the first zero to the word's start; of all four bytes without one.
    passed: u32,
    /// 1 without a zero: the distance goes on growing.
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

/// Which bytes of a word are zeros, a bit each.
fn zeros(word: u32) -> usize {
    const LOW: u32 = 0x7F7F_7F7F;
    // The highest bit of each byte: set unless all of its bits are clear.
    let others = (word & LOW).wrapping_add(LOW) | word;
    // Bits 7, 15, 23 and 31 side by side.
    ((!others & !LOW).wrapping_mul(1 << 21 | 1 << 14 | 1 << 7 | 1) >> 28) as usize
}

/// COBS for payloads below 254 bytes: zeros are replaced by the distance to the next one. Returns the bytes written.
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
        fn stuffing_is_that_of_the_cobs_crate(payload in prop::collection::vec(prop_oneof![Just(0_u8), any::<u8>()], 1..MAX_PAYLOAD)) {
            let mut ours = [0xAA; MAX_FRAME];
            let len = stuff(&payload, &mut ours).unwrap();
            let mut theirs = cobs::encode_vec(&payload);
            theirs.push(DELIMITER);
            prop_assert_eq!(&ours[..len], &theirs[..]);
        }

        #[test]
        fn an_estimate_s_own_way_gives_the_same_bytes(dropped in any::<u8>(), low in any::<u8>(), high in prop_oneof![Just(0_u8), any::<u8>()], words in prop::array::uniform11(prop_oneof![Just(0_u32), 0..300_u32, any::<u32>()])) {
            let estimate = NumberedEstimate::from(EstimateLayout([dropped, low, high], words.map(u32::to_le_bytes)));
            let mut frame = [0; MAX_FRAME];
            let mut own = [0xAA; ESTIMATE_FRAME];
            encode_estimate(&estimate, estimate.estimate.parity(), &mut own);
            prop_assert_eq!(encode(&ToHost::Estimate(estimate), &mut frame).unwrap(), &own);
        }
    }

    #[test]
    fn a_number_that_is_not_what_it_was_spoils_the_frame() {
        let sound = EstimateFrame { normal_force_n: 7.5, flags: 3, ..EstimateFrame::default() };
        let frames = |estimate, parity| {
            let mut frame = [0; ESTIMATE_FRAME];
            encode_estimate(
                &NumberedEstimate { estimate, ..NumberedEstimate::default() },
                parity,
                &mut frame,
            );
            let mut decoder = Decoder::new();
            frame.iter().filter_map(|&byte| decoder.push::<ToHost>(byte)).collect::<Vec<_>>()
        };
        assert!(matches!(frames(sound, sound.parity())[..], [Ok(ToHost::Estimate(_))]));
        for bit in 0..32 {
            let flip = |value: f32| f32::from_bits(value.to_bits() ^ 1 << bit);
            let flipped = [
                EstimateFrame { normal_force_n: flip(sound.normal_force_n), ..sound },
                EstimateFrame { force_y_n: flip(sound.force_y_n), ..sound },
                EstimateFrame { force_z_n: flip(sound.force_z_n), ..sound },
                EstimateFrame { friction_torque_nm: flip(sound.friction_torque_nm), ..sound },
                EstimateFrame { deformation_m: flip(sound.deformation_m), ..sound },
                EstimateFrame { contact_angle_rad: flip(sound.contact_angle_rad), ..sound },
            ];
            for estimate in flipped {
                assert_eq!(frames(estimate, sound.parity()), [Err(FrameError::Crc)], "{estimate:?}");
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
