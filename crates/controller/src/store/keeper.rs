//! Storage of one small value without power: the configuration.
//!
//! Records of 256 bytes in the two halves of a flash memory. A new record follows the last one.
//! When a half is full, the other one is erased and used. So at any moment there is a complete
//! record once there has been one. The newest complete record is read: the old value or the new
//! one, never a mixture.
//!
//! | bytes | content |
//! |---|---|
//! | 0..4 | number of the record, counting up |
//! | 4..6 | version of the value's layout, chosen by the caller |
//! | 6..8 | length of the value, bytes |
//! | 8..252 | value in postcard's encoding, padded with ones |
//! | 252..256 | CRC-32 (ISO-HDLC) of everything before |

use embedded_storage::nor_flash::NorFlash;
use link::crc32;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Bytes of a record.
pub const RECORD: usize = 256;
/// Bytes before the value.
const HEAD: usize = 8;
/// Maximum length of an encoded value, bytes.
pub const MAX_VALUE_LENGTH: usize = RECORD - HEAD - 4;

/// Reason why a value was not stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeepError {
    /// The value is longer than a record has room for.
    TooLong,
    /// The flash failed; the value before is still stored.
    Flash,
}

/// Number and place of the newest record.
#[derive(Clone, Copy, Debug)]
struct Newest {
    number: u32,
    offset: u32,
}

/// Stores one value in a flash memory.
#[derive(Debug)]
pub struct Keeper<M> {
    memory: M,
    newest: Option<Newest>,
}

impl<M: NorFlash> Keeper<M> {
    /// Searches for the newest complete record.
    pub fn start(memory: M) -> Self {
        let mut keeper = Self { memory, newest: None };
        let end = u32::try_from(keeper.memory.capacity()).unwrap_or(0);
        for offset in (0..end).step_by(RECORD) {
            let Some(record) = keeper.read(offset) else { continue };
            let Some(number) = valid_number(&record) else { continue };
            if keeper.newest.is_none_or(|newest| newest.number < number) {
                keeper.newest = Some(Newest { number, offset });
            }
        }
        keeper
    }

    /// Returns the stored value; `None` without one or if it has another version.
    pub fn value<T: DeserializeOwned>(&mut self, version: u16) -> Option<T> {
        let record = self.read(self.newest?.offset)?;
        let (head, body) = record.split_first_chunk::<HEAD>()?;
        let [_, _, _, _, version_low, version_high, length_low, length_high] = *head;
        let length = u16::from_le_bytes([length_low, length_high]);
        let value = body.get(..usize::from(length))?;
        let same = u16::from_le_bytes([version_low, version_high]) == version;
        same.then(|| postcard::from_bytes(value).ok()).flatten()
    }

    /// Stores a value in place of the one before.
    ///
    /// # Errors
    ///
    /// The value is too long, or the flash failed. The value before is then still stored.
    pub fn keep<T: Serialize>(&mut self, version: u16, value: &T) -> Result<(), KeepError> {
        let number = self.newest.map_or(1, |newest| newest.number.saturating_add(1));
        let record = record_of(number, version, value).ok_or(KeepError::TooLong)?;
        let offset = self.place().ok_or(KeepError::Flash)?;
        self.memory.write(offset, &record).map_err(|_| KeepError::Flash)?;
        if self.read(offset) != Some(record) {
            return Err(KeepError::Flash);
        }
        self.newest = Some(Newest { number, offset });
        Ok(())
    }

    /// Returns the memory.
    pub fn into_memory(self) -> M {
        self.memory
    }

    /// Returns the offset of the next record: after the newest one if it is blank there, else at
    /// the start of the other half, which is erased.
    fn place(&mut self) -> Option<u32> {
        let half = u32::try_from(self.memory.capacity() / 2).ok().filter(|&half| half >= RECORD as u32)?;
        let in_second = self.newest.is_some_and(|newest| newest.offset >= half);
        if let Some(newest) = self.newest {
            let end = if in_second { half.saturating_mul(2) } else { half };
            let mut candidate = newest.offset.saturating_add(RECORD as u32);
            while candidate.saturating_add(RECORD as u32) <= end {
                // An interrupted record is skipped.
                if self.read(candidate)?.iter().all(|&byte| byte == 0xFF) {
                    return Some(candidate);
                }
                candidate = candidate.saturating_add(RECORD as u32);
            }
        }
        let other = if self.newest.is_none() || in_second { 0 } else { half };
        self.memory.erase(other, other.saturating_add(half)).ok()?;
        Some(other)
    }

    fn read(&mut self, offset: u32) -> Option<[u8; RECORD]> {
        let mut record = [0; RECORD];
        self.memory.read(offset, &mut record).ok()?;
        Some(record)
    }
}

fn record_of<T: Serialize>(number: u32, version: u16, value: &T) -> Option<[u8; RECORD]> {
    let mut record = [0xFF; RECORD];
    let (body, sum) = record.split_last_chunk_mut::<4>()?;
    let (head, room) = body.split_first_chunk_mut::<HEAD>()?;
    let length = u16::try_from(postcard::to_slice(value, room).ok()?.len()).ok()?;
    let fields = number.to_le_bytes().into_iter().chain(version.to_le_bytes()).chain(length.to_le_bytes());
    for (to, from) in head.iter_mut().zip(fields) {
        *to = from;
    }
    *sum = crc32(body).to_le_bytes();
    Some(record)
}

/// Returns the record's number if its checksum matches.
fn valid_number(record: &[u8; RECORD]) -> Option<u32> {
    let (body, sum) = record.split_last_chunk::<4>()?;
    let (number, _) = body.split_first_chunk::<4>()?;
    (crc32(body) == u32::from_le_bytes(*sum)).then_some(u32::from_le_bytes(*number))
}
