//! Something small that is kept over a loss of power: the configuration.
//!
//! Records of 256 bytes in two places, each a half of a flash memory of its own. A record is written behind the last one; when a place is
//! full, the other is erased and gone on with. So there is a whole record at any moment once there has been one, and what is read is the newest
//! whole one: the old value or the new one, never a mixture.
//!
//! | bytes | what |
//! |---|---|
//! | 0..4 | number of the record, counting up |
//! | 4..6 | version of the value's form, chosen by whoever keeps it |
//! | 6..8 | bytes of the value |
//! | 8..252 | the value in postcard's encoding, filled up with ones |
//! | 252..256 | CRC-32 (ISO-HDLC) of everything before |

use embedded_storage::nor_flash::NorFlash;
use inference::image::check_sum;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Bytes of a record.
pub const RECORD: usize = 256;
/// Bytes before the value.
const HEAD: usize = 8;
/// Longest value in its encoding.
pub const LONGEST: usize = RECORD - HEAD - 4;

/// Why a value was not kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeepError {
    /// It is longer than [`LONGEST`].
    TooLong,
    /// The flash did not do what it was told; what was kept before still is.
    Flash,
}

/// The newest record's place.
#[derive(Clone, Copy, Debug)]
struct Newest {
    number: u32,
    offset: u32,
}

/// Keeps one value in a flash memory.
#[derive(Debug)]
pub struct Keeper<M> {
    memory: M,
    newest: Option<Newest>,
}

impl<M: NorFlash> Keeper<M> {
    /// Looks for the newest whole record.
    pub fn start(memory: M) -> Self {
        let mut keeper = Self { memory, newest: None };
        let end = u32::try_from(keeper.memory.capacity()).unwrap_or(0);
        for offset in (0..end).step_by(RECORD) {
            let Some(record) = keeper.read(offset) else { continue };
            let Some(number) = whole(&record) else { continue };
            if keeper.newest.is_none_or(|newest| newest.number < number) {
                keeper.newest = Some(Newest { number, offset });
            }
        }
        keeper
    }

    /// The value kept; nothing if there is none, or if it has another form.
    pub fn value<T: DeserializeOwned>(&mut self, version: u16) -> Option<T> {
        let record = self.read(self.newest?.offset)?;
        let (head, body) = record.split_first_chunk::<HEAD>()?;
        let [_, _, _, _, version_low, version_high, length_low, length_high] = *head;
        let length = u16::from_le_bytes([length_low, length_high]);
        let value = body.get(..usize::from(length))?;
        let same = u16::from_le_bytes([version_low, version_high]) == version;
        same.then(|| postcard::from_bytes(value).ok()).flatten()
    }

    /// Keeps a value in place of the one before.
    ///
    /// # Errors
    ///
    /// The value is too long, or the flash failed; the value before is then still kept.
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

    /// The memory, given back.
    pub fn into_memory(self) -> M {
        self.memory
    }

    /// Where the next record goes: behind the newest where it is blank, else at the front of the other half, erased.
    fn place(&mut self) -> Option<u32> {
        let half = u32::try_from(self.memory.capacity() / 2).ok().filter(|&half| half >= RECORD as u32)?;
        let in_second = self.newest.is_some_and(|newest| newest.offset >= half);
        if let Some(newest) = self.newest {
            let end = if in_second { half.saturating_mul(2) } else { half };
            let mut candidate = newest.offset.saturating_add(RECORD as u32);
            while candidate.saturating_add(RECORD as u32) <= end {
                // An interrupted record is passed over.
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
    *sum = check_sum(body).to_le_bytes();
    Some(record)
}

/// The record's number, if its check sum matches.
fn whole(record: &[u8; RECORD]) -> Option<u32> {
    let (body, sum) = record.split_last_chunk::<4>()?;
    let (number, _) = body.split_first_chunk::<4>()?;
    (check_sum(body) == u32::from_le_bytes(*sum)).then_some(u32::from_le_bytes(*number))
}
