//! A recorded link session as a file.
//!
//! Little endian. Header: `PINTLREC`, version (u16, 1), protocol of the link (u8), 0 (u8), build of
//! the controller (32 bytes of text, padded with zeros), number of frames (u32), length of the
//! frames in bytes (u64), CRC-32 of the header. Then the frames, each: direction (u8: 0 to the
//! controller, 1 to the host), 1 if a sample had been sent (u8), its sequence number (u32), length
//! (u16), the bytes as on the wire. Last the CRC-32 of the frames.

use super::{Direction, RecordedFrame};
use bench::atomic;
use link::{BUILD_ID_LEN, BuildId, MAX_FRAME, PROTOCOL_VERSION, crc32};
use std::path::Path;

/// First bytes of the file.
pub const MAGIC: [u8; 8] = *b"PINTLREC";
/// Version of the format.
const VERSION: u16 = 1;

/// A recorded link session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recording {
    /// Build of the controller that was recorded.
    pub build_id: BuildId,
    /// Every frame, in the order in which the host sent or received it.
    pub frames: Vec<RecordedFrame>,
}

/// A defect of a recording.
#[derive(Debug, thiserror::Error)]
#[error("byte {at}: found {found}; expected {expected}")]
pub struct RecordingError {
    /// Byte offset in the file.
    pub at: usize,
    /// Description of what was found.
    pub found: String,
    /// Description of what was expected.
    pub expected: &'static str,
}

impl Recording {
    /// Encodes the file.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut body = Vec::new();
        for frame in &self.frames {
            body.extend([frame.way as u8, u8::from(frame.sequence.is_some())]);
            body.extend(frame.sequence.unwrap_or_default().to_le_bytes());
            body.extend((frame.bytes.len() as u16).to_le_bytes());
            body.extend(&frame.bytes);
        }
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend([PROTOCOL_VERSION, 0]);
        bytes.extend(self.build_id.0);
        bytes.extend((self.frames.len() as u32).to_le_bytes());
        bytes.extend((body.len() as u64).to_le_bytes());
        bytes.extend(crc32(&bytes).to_le_bytes());
        let sum = crc32(&body);
        bytes.extend(body);
        bytes.extend(sum.to_le_bytes());
        bytes
    }

    /// Writes the file completely or not at all.
    ///
    /// # Errors
    ///
    /// It cannot be written.
    pub fn write(&self, path: &Path) -> std::io::Result<()> {
        atomic::write(path, &self.to_bytes())
    }

    /// Decodes a file.
    ///
    /// # Errors
    ///
    /// It is not a recording, has another version, or is damaged.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, RecordingError> {
        let mut rest = Cursor { bytes, at: 0 };
        if rest.take::<8>()? != MAGIC {
            return Err(rest.wrong(8, "other first bytes".into(), "a recording, which begins with PINTLREC"));
        }
        let version = u16::from_le_bytes(rest.take()?);
        if version != VERSION {
            return Err(rest.wrong(2, format!("version {version} of the format"), "version 1"));
        }
        let [protocol, _] = rest.take()?;
        let build_id = BuildId(rest.take::<BUILD_ID_LEN>()?);
        let count = u32::from_le_bytes(rest.take()?);
        let length = u64::from_le_bytes(rest.take()?);
        rest.checksum(0, "a complete header")?;
        if protocol != PROTOCOL_VERSION {
            return Err(rest.wrong(
                4,
                format!("protocol {protocol}"),
                "the protocol of this host: the file is from another build",
            ));
        }
        let start = rest.at;
        let left = (bytes.len() - start) as u64;
        if length.checked_add(4) != Some(left) {
            return Err(rest.wrong(
                0,
                format!("{left} bytes after the header"),
                "the length in the header, and 4 more",
            ));
        }
        let mut frames = Vec::new();
        for _ in 0..count {
            let way = match rest.take()? {
                [0] => Direction::ToController,
                [1] => Direction::ToHost,
                [other] => return Err(rest.wrong(1, format!("way {other}"), "0 or 1")),
            };
            let [has_sequence] = rest.take()?;
            let sequence = u32::from_le_bytes(rest.take()?);
            let length = usize::from(u16::from_le_bytes(rest.take()?));
            if length > MAX_FRAME {
                return Err(rest.wrong(
                    2,
                    format!("a frame of {length} bytes"),
                    "at most the length of a frame",
                ));
            }
            let bytes = rest.slice(length)?.to_vec();
            frames.push(RecordedFrame { way, sequence: (has_sequence != 0).then_some(sequence), bytes });
        }
        rest.checksum(start, "complete frames")?;
        if rest.at != bytes.len() {
            return Err(rest.wrong(0, "more bytes".into(), "the end"));
        }
        Ok(Self { build_id, frames })
    }
}

struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    fn slice(&mut self, length: usize) -> Result<&'a [u8], RecordingError> {
        let end = self.at.saturating_add(length);
        let slice =
            self.bytes.get(self.at..end).ok_or_else(|| self.wrong(0, "the end".into(), "more bytes"))?;
        self.at = end;
        Ok(slice)
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], RecordingError> {
        let slice = self.slice(N)?;
        slice.first_chunk().copied().ok_or_else(|| self.wrong(N, "the end".into(), "more bytes"))
    }

    /// Reads a checksum and compares it with everything from `start` on.
    fn checksum(&mut self, start: usize, expected: &'static str) -> Result<(), RecordingError> {
        let found = crc32(self.bytes.get(start..self.at).unwrap_or_default());
        if self.take()? == found.to_le_bytes() {
            Ok(())
        } else {
            Err(self.wrong(4, "a checksum that does not match".into(), expected))
        }
    }

    /// Creates an error about something `back` bytes before the current position.
    const fn wrong(&self, back: usize, found: String, expected: &'static str) -> RecordingError {
        RecordingError { at: self.at.saturating_sub(back), found, expected }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn recording() -> impl Strategy<Value = Recording> {
        let frame = (any::<bool>(), any::<Option<u32>>(), prop::collection::vec(any::<u8>(), 0..MAX_FRAME))
            .prop_map(|(to_host, sequence, bytes)| RecordedFrame {
                way: if to_host { Direction::ToHost } else { Direction::ToController },
                sequence,
                bytes,
            });
        (prop::collection::vec(frame, 0..20), "[a-z0-9-]{0,32}")
            .prop_map(|(frames, name)| Recording { build_id: BuildId::new(&name), frames })
    }

    proptest! {
        #[test]
        fn a_written_recording_reads_back(recording in recording()) {
            prop_assert_eq!(Recording::from_bytes(&recording.to_bytes()).unwrap(), recording);
        }

        #[test]
        fn a_changed_or_cut_file_is_refused(
            recording in recording(),
            at in any::<prop::sample::Index>(),
            bit in 0..8,
        ) {
            let bytes = recording.to_bytes();
            let mut changed = bytes.clone();
            changed[at.index(bytes.len())] ^= 1_u8 << bit;
            prop_assert!(Recording::from_bytes(&changed).is_err());
            prop_assert!(Recording::from_bytes(&bytes[..at.index(bytes.len())]).is_err());
            let longer = [bytes, vec![0]].concat();
            prop_assert!(Recording::from_bytes(&longer).is_err());
        }

        #[test]
        fn garbage_is_refused_without_panic(
            bytes in prop::collection::vec(any::<u8>(), 0..300),
            begins in any::<bool>(),
        ) {
            let start = if begins { &MAGIC[..] } else { &[] };
            prop_assert!(Recording::from_bytes(&[start, &bytes].concat()).is_err());
        }
    }
}
