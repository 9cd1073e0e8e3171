//! Message to frame.
//!
//! The COBS stage is written out here because a controller that must not contain a panic cannot link the `cobs` crate's encoder
//! with overflow checks on; the crate is the oracle in the tests.
//!
//! Estimates have a way of their own, [`encode_estimate`]: same bytes, a fixed number of instructions, for the controller's tick.

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
#[inline]
pub fn encode_estimate(estimate: &NumberedEstimate, frame: &mut [u8; ESTIMATE_FRAME]) {
    let EstimateLayout([dropped, low, high], fields) = (*estimate).into();
    let [a, b, c, d, e, f, g, h, i, j, k] = fields;
    let first = [ESTIMATE_KIND, dropped, low, high];
    let mut words = [first, a, b, c, d, e, f, g, h, i, j, k, [0; 4]].map(u32::from_le_bytes);
    let [message @ .., sum] = &mut words;
    *sum = !message.iter().fold(START, |sum, word| take_word(sum, *word));

    // From the end: a zero becomes the distance to the next one, the delimiter being the last.
    let mut distance = 1_u32;
    for word in words.iter_mut().rev() {
        for shift in [24, 16, 8, 0] {
            let byte = *word >> shift & 0xFF;
            // All ones for a zero.
            let is_zero = (byte.wrapping_sub(1).cast_signed() >> 31).cast_unsigned();
            *word |= (distance & is_zero) << shift;
            distance = (distance & !is_zero).wrapping_add(1);
        }
    }
    let [code, payload @ .., delimiter] = frame;
    *code = distance as u8;
    let (places, _) = payload.as_chunks_mut::<4>();
    for (place, word) in places.iter_mut().zip(words) {
        *place = word.to_le_bytes();
    }
    *delimiter = DELIMITER;
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
    use crate::ToHost;
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
            encode_estimate(&estimate, &mut own);
            prop_assert_eq!(encode(&ToHost::Estimate(estimate), &mut frame).unwrap(), &own);
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
