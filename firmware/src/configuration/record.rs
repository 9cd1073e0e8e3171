//! The configuration as bytes: what is kept over a power cut, and what its check sum is taken over.
//!
//! One byte of version, the fields in postcard's encoding, CRC-32 (little endian) over both. Who keeps the bytes keeps them whole; a
//! record that was cut short or altered, or is of another version, is refused with the reason.

use link::{CONFIGURATION_VERSION, ControllerConfiguration, Reasons, crc32};

use super::validate;

/// Room for the longest record, bytes.
pub const MAX_RECORD: usize = 256;

/// Why a record is not a configuration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordError {
    /// Shorter than any record.
    TooShort,
    /// Of another version.
    Version {
        /// Found.
        found: u8,
    },
    /// The check sum does not match.
    Crc,
    /// Sound, but no configuration.
    Content,
    /// A configuration that this build does not serve.
    OutOfRange(Reasons),
}

/// A configuration's record in `room`; empty if it does not fit, which the longest does.
#[must_use]
pub fn write<'a>(configuration: &ControllerConfiguration, room: &'a mut [u8; MAX_RECORD]) -> &'a [u8] {
    let len = try_write(configuration, room).unwrap_or_default();
    room.get(..len).unwrap_or_default()
}

fn try_write(configuration: &ControllerConfiguration, room: &mut [u8; MAX_RECORD]) -> Option<usize> {
    let [version, fields @ ..] = room;
    *version = CONFIGURATION_VERSION;
    let end = postcard::to_slice(configuration, fields).ok()?.len().checked_add(1)?;
    let (record, rest) = room.split_at_mut_checked(end)?;
    *rest.first_chunk_mut()? = crc32(record).to_le_bytes();
    end.checked_add(4)
}

/// Reads a record.
///
/// # Errors
///
/// The bytes are no record of this version, or not of a configuration that can be served.
pub fn read(record: &[u8]) -> Result<ControllerConfiguration, RecordError> {
    let (content, sum) = record.split_last_chunk::<4>().ok_or(RecordError::TooShort)?;
    if crc32(content) != u32::from_le_bytes(*sum) {
        return Err(RecordError::Crc);
    }
    let (&version, fields) = content.split_first().ok_or(RecordError::TooShort)?;
    if version != CONFIGURATION_VERSION {
        return Err(RecordError::Version { found: version });
    }
    match postcard::take_from_bytes::<ControllerConfiguration>(fields) {
        Ok((configuration, [])) => {
            validate(&configuration).map_err(RecordError::OutOfRange)?;
            Ok(configuration)
        }
        _ => Err(RecordError::Content),
    }
}

/// CRC-32 of a configuration: that of its record.
#[must_use]
pub fn check_sum(configuration: &ControllerConfiguration) -> u32 {
    let mut room = [0; MAX_RECORD];
    write(configuration, &mut room).last_chunk().map_or(0, |sum| u32::from_le_bytes(*sum))
}
