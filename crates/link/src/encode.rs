//! Message to frame.
//!
//! The COBS stage is written out here because a controller that must not contain a panic cannot link the `cobs` crate's encoder
//! with overflow checks on; the crate is the oracle in the tests.

use serde::Serialize;

use crate::{CRC, DELIMITER, MAX_FRAME, MAX_PAYLOAD};

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
    let payload = postcard::to_slice_crc32(message, &mut payload, CRC.digest()).map_err(|_| EncodeError)?;
    let len = stuff(payload, frame).ok_or(EncodeError)?;
    frame.get(..len).ok_or(EncodeError)
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
    }

    #[test]
    fn a_message_too_long_is_refused() {
        let mut frame = [0; MAX_FRAME];
        assert_eq!(
            encode(&([1_u8; 32], [1_u8; 32], [1_u8; 32], [1_u8; 32], [1_u8; 32], [1_u8; 32]), &mut frame),
            Err(EncodeError)
        );
    }
}
