//! Storage of small values without power: the configuration, the requirements on packages,
//! the number of the last start.
//!
//! Records of 256 bytes in the two halves of a flash memory. A new record follows the last one.
//! When a half is full, the other one is erased, the other values are copied there, and the new
//! record follows. If that is interrupted, the new half lacks a value that the old half has; then
//! the old half is read, which is unchanged. So of each value the old or the new one is read, never
//! a mixture. A value that did not change is not written again. Each flash word is programmed once
//! between two erasures, in one write with the rest of its record.
//!
//! | bytes | content |
//! |---|---|
//! | 0..4 | number of the record, counting up |
//! | 4 | version of the value's layout, chosen by the caller |
//! | 5 | kind of the value |
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

/// Kind of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Configuration of the controller.
    Configuration,
    /// Requirements on packages.
    Trust,
    /// Number of the last start; counts up.
    Start,
}

/// Number of kinds.
const KINDS: usize = 3;

impl Kind {
    /// All kinds, in the order of their codes.
    pub const ALL: [Self; KINDS] = [Self::Configuration, Self::Trust, Self::Start];

    const fn code(self) -> u8 {
        match self {
            Self::Configuration => 0,
            Self::Trust => 1,
            Self::Start => 2,
        }
    }
}

/// Number and place of the newest record of a kind.
#[derive(Clone, Copy, Debug)]
struct Newest {
    number: u32,
    offset: u32,
}

/// Newest record of each kind in a half.
type Records = [Option<Newest>; KINDS];

/// Stores values in a flash memory.
#[derive(Debug)]
pub struct Keeper<M> {
    memory: M,
    newest: Records,
    /// Number of the last record, also if its write was reported as failed.
    last_number: u32,
}

impl<M: NorFlash> Keeper<M> {
    /// Searches for the newest complete record of each kind.
    pub fn start(memory: M) -> Self {
        let mut keeper = Self { memory, newest: [None; KINDS], last_number: 0 };
        let half = keeper.half().unwrap_or(0);
        let [first, second] = [0, half].map(|start| keeper.records(start, half));
        let numbers = [last_number(&first), last_number(&second)];
        let [newer, older] = if numbers[0] > numbers[1] { [first, second] } else { [second, first] };
        let is_interrupted = newer.iter().zip(older).any(|(new, old)| new.is_none() && old.is_some());
        keeper.newest = if is_interrupted { older } else { newer };
        keeper.last_number = numbers[0].max(numbers[1]);
        keeper
    }

    /// Returns the stored value; `None` without one or if its layout has another version.
    pub fn value<T: DeserializeOwned>(&mut self, kind: Kind, layout: u8) -> Option<T> {
        value_in(&self.newest_record(kind).ok()??, layout)
    }

    /// Returns a number that no stored value of a kind that counts up exceeds: the largest one that
    /// can be read, plus one for each record that cannot.
    pub fn count_bound(&mut self, kind: Kind, layout: u8) -> u32 {
        let (mut largest, mut damaged) = (0_u32, 0_u32);
        let end = self.half().unwrap_or(0).saturating_mul(2);
        for offset in (0..end).step_by(RECORD) {
            let record = self.read(offset);
            let found = record.as_ref().and_then(valid_number_and_kind);
            match (record, found) {
                (Some(record), Some((_, code))) if code == kind.code() => {
                    largest = largest.max(value_in(&record, layout).unwrap_or(0));
                }
                (_, Some(_)) => {}
                (Some(record), None) if is_blank(&record) => {}
                _ => damaged = damaged.saturating_add(1),
            }
        }
        largest.saturating_add(damaged)
    }

    /// Stores a value in place of the one before. An equal one is not written again.
    ///
    /// # Errors
    ///
    /// The value is too long, or the flash failed. The value before is then still stored.
    pub fn keep<T: Serialize>(&mut self, kind: Kind, layout: u8, value: &T) -> Result<(), KeepError> {
        let body = body_of(kind, layout, value).ok_or(KeepError::TooLong)?;
        if let Ok(Some(record)) = self.newest_record(kind)
            && body_in(&record) == Some(&body)
        {
            return Ok(());
        }
        let old = self.newest;
        let written = self.place(kind).and_then(|offset| self.write(kind, offset, &body));
        if written.is_none() {
            // Until a new record is complete, the old half counts.
            self.newest = old;
        }
        written.ok_or(KeepError::Flash)
    }

    /// Returns the memory.
    pub fn into_memory(self) -> M {
        self.memory
    }

    /// Returns the memory, for tests of failures.
    pub const fn memory_mut(&mut self) -> &mut M {
        &mut self.memory
    }

    /// Length of a half; `None` if it is too short for a record of each kind.
    fn half(&self) -> Option<u32> {
        u32::try_from(self.memory.capacity() / 2).ok().filter(|&half| half >= (KINDS * RECORD) as u32)
    }

    /// Returns the newest complete record of each kind in the half that starts at an offset.
    fn records(&mut self, start: u32, half: u32) -> Records {
        let mut newest: Records = [None; KINDS];
        for offset in (start..start.saturating_add(half)).step_by(RECORD) {
            let Some(record) = self.read(offset) else { continue };
            let Some((number, code)) = valid_number_and_kind(&record) else { continue };
            if let Some(newest) = newest.get_mut(usize::from(code))
                && newest.is_none_or(|newest| newest.number < number)
            {
                *newest = Some(Newest { number, offset });
            }
        }
        newest
    }

    /// Writes a record with the next number and reads it back.
    fn write(&mut self, kind: Kind, offset: u32, body: &Body) -> Option<()> {
        let number = self.last_number.saturating_add(1);
        self.last_number = number;
        let record = record_of(number, body)?;
        self.memory.write(offset, &record).ok()?;
        if self.read(offset)? != record {
            return None;
        }
        *self.newest.get_mut(usize::from(kind.code()))? = Some(Newest { number, offset });
        Some(())
    }

    /// Returns the offset of the next record: after the newest one if it is blank there, else in
    /// the other half, which is erased. Values of other kinds are copied there first.
    fn place(&mut self, kind: Kind) -> Option<u32> {
        let half = self.half()?;
        let Some(newest) = self.newest.iter().flatten().max_by_key(|newest| newest.number).copied() else {
            return self.erase(0, half);
        };
        let is_second = newest.offset >= half;
        let end = if is_second { half.saturating_mul(2) } else { half };
        let mut candidate = newest.offset.saturating_add(RECORD as u32);
        while candidate.saturating_add(RECORD as u32) <= end {
            // An interrupted record is skipped, also one that cannot be read.
            if self.read(candidate).is_some_and(|record| is_blank(&record)) {
                return Some(candidate);
            }
            candidate = candidate.saturating_add(RECORD as u32);
        }
        let mut offset = self.erase(if is_second { 0 } else { half }, half)?;
        for other in Kind::ALL.into_iter().filter(|&other| other != kind) {
            let Some(record) = self.newest_record(other).ok()? else { continue };
            self.write(other, offset, body_in(&record)?)?;
            offset = offset.saturating_add(RECORD as u32);
        }
        Some(offset)
    }

    /// Erases a half unless it is blank, and returns its start.
    fn erase(&mut self, start: u32, half: u32) -> Option<u32> {
        let end = start.saturating_add(half);
        let mut records = (start..end).step_by(RECORD);
        if records.all(|offset| self.read(offset).is_some_and(|record| is_blank(&record))) {
            return Some(start);
        }
        self.memory.erase(start, end).ok().map(|()| start)
    }

    /// Returns the newest record of a kind, or none if there is none.
    ///
    /// # Errors
    ///
    /// The record cannot be read, or has been corrupted since the start.
    fn newest_record(&mut self, kind: Kind) -> Result<Option<[u8; RECORD]>, KeepError> {
        let newest = self.newest.get(usize::from(kind.code())).copied().flatten();
        let Some(Newest { number, offset }) = newest else { return Ok(None) };
        let record = self.read(offset).ok_or(KeepError::Flash)?;
        let is_intact = valid_number_and_kind(&record) == Some((number, kind.code()));
        if is_intact { Ok(Some(record)) } else { Err(KeepError::Flash) }
    }

    fn read(&mut self, offset: u32) -> Option<[u8; RECORD]> {
        let mut record = [0; RECORD];
        self.memory.read(offset, &mut record).ok()?;
        Some(record)
    }
}

/// Returns the value in a record; `None` if its layout has another version.
fn value_in<T: DeserializeOwned>(record: &[u8; RECORD], layout: u8) -> Option<T> {
    let (head, body) = record.split_first_chunk::<HEAD>()?;
    let [_, _, _, _, found, _, length_low, length_high] = *head;
    let value = body.get(..usize::from(u16::from_le_bytes([length_low, length_high])))?;
    (found == layout).then(|| postcard::from_bytes(value).ok()).flatten()
}

/// A record without number and checksum.
type Body = [u8; RECORD - 8];

fn is_blank(record: &[u8; RECORD]) -> bool {
    record.iter().all(|&byte| byte == 0xFF)
}

/// Number of the newest record; 0 without one.
fn last_number(records: &Records) -> u32 {
    records.iter().flatten().map(|newest| newest.number).max().unwrap_or(0)
}

fn body_of<T: Serialize>(kind: Kind, layout: u8, value: &T) -> Option<Body> {
    let mut body = [0xFF; RECORD - 8];
    let (head, room) = body.split_first_chunk_mut::<{ HEAD - 4 }>()?;
    let [low, high] = u16::try_from(postcard::to_slice(value, room).ok()?.len()).ok()?.to_le_bytes();
    *head = [layout, kind.code(), low, high];
    Some(body)
}

fn body_in(record: &[u8; RECORD]) -> Option<&Body> {
    record.get(4..)?.first_chunk()
}

fn record_of(number: u32, body: &Body) -> Option<[u8; RECORD]> {
    let mut record = [0; RECORD];
    let (summed, sum) = record.split_last_chunk_mut::<4>()?;
    let (head, rest) = summed.split_first_chunk_mut::<4>()?;
    *head = number.to_le_bytes();
    for (to, from) in rest.iter_mut().zip(body) {
        *to = *from;
    }
    *sum = crc32(summed).to_le_bytes();
    Some(record)
}

/// Returns number and kind of a record if its checksum matches.
fn valid_number_and_kind(record: &[u8; RECORD]) -> Option<(u32, u8)> {
    let (body, sum) = record.split_last_chunk::<4>()?;
    let &[a, b, c, d, _layout, kind, ..] = body else { return None };
    (crc32(body) == u32::from_le_bytes(*sum)).then_some((u32::from_le_bytes([a, b, c, d]), kind))
}
