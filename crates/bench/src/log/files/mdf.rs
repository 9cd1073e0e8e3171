//! MDF files of version 4 (`.mf4`; CANape, INCA, asammdf, CSS loggers), plain or compressed.
//!
//! Channels of numbers are listed with their unit, by name or, where two groups have the same name,
//! as `group/channel`; a group is called by its name, else by its number from 0. Conversions are
//! applied, and samples that are marked as invalid are missing values. A channel that is only
//! counted (a virtual one) has the values of its conversion. Texts and other contents are refused
//! when a column asks for them, files of version 3 and records of several groups in one block
//! (unsorted files) at once.

use super::file::{LogFile, MAX_NAMES, MAX_ROWS, guarded, refused, unique_names};
use crate::log::LogError;
use flate2::read::ZlibDecoder;
use mdf4_rs::index::{DataBlockInfo, IndexedChannel, IndexedChannelGroup};
use mdf4_rs::{ByteRangeReader, DecodedValue, Error, MdfIndex};
use std::cell::RefCell;
use std::io::Read;

/// First bytes of a file.
pub(super) const MDF: &[u8] = b"MDF     ";
/// First bytes of a file whose writer was stopped.
pub(super) const UNFINISHED: &[u8] = b"UnFinMF ";
/// First digit of the version, in the file's first bytes.
const VERSION_AT: usize = 8;

/// Length of a block's header.
const HEAD_BYTES: usize = 24;
/// Length of the header of a compressed block.
const ZIPPED_HEAD_BYTES: usize = 48;
/// Maximum size of the records of a group.
const MAX_BYTES: usize = 1 << 30;
/// Records that are decoded at a time.
const BATCH: usize = 16_384;
/// Channels without stored values.
const VIRTUAL: [u8; 2] = [3, 6];
/// Channel of texts or other contents of variable length.
const VARIABLE: u8 = 1;

const READABLE: &str = "complete MDF of version 4; asammdf converts other files";

/// Channels of a file.
pub(super) struct Mdf {
    bytes: Vec<u8>,
    index: MdfIndex,
    /// Group and channel of each column.
    places: Vec<(usize, usize)>,
    names: Vec<String>,
    groups: Vec<String>,
    /// Group whose records were read last.
    records: RefCell<Option<(usize, Vec<u8>)>>,
}

impl Mdf {
    pub(super) fn open(file: &str, bytes: Vec<u8>) -> Result<Self, LogError> {
        let refuse = |found: String| LogError::content(file, found, READABLE);
        if bytes.starts_with(UNFINISHED) {
            return Err(refuse("an MDF file that its writer did not finish".into()));
        }
        if bytes.get(VERSION_AT) != Some(&b'4') {
            let version = bytes.get(VERSION_AT..).unwrap_or_default();
            let version = String::from_utf8_lossy(version.get(..4).unwrap_or_default()).into_owned();
            return Err(refuse(format!("MDF of version {}", version.trim())));
        }
        let mut blocks = Blocks { bytes: &bytes, budget: 16 * bytes.len() + (1 << 16) };
        let index = guarded(|| MdfIndex::from_reader(&mut blocks, bytes.len() as u64)).map_err(refuse)?;
        let (mut places, mut columns) = (Vec::new(), Vec::new());
        for (number, group) in index.channel_groups.iter().enumerate() {
            let name = group.name.clone().filter(|name| !name.is_empty());
            let name = name.unwrap_or_else(|| number.to_string());
            for (position, channel) in group.channels.iter().enumerate() {
                places.push((number, position));
                columns.push((name.clone(), channel.name.clone().unwrap_or_default()));
            }
        }
        if columns.is_empty() {
            return Err(LogError::content(file, "no channels", "a channel for each signal"));
        }
        if columns.len() > MAX_NAMES {
            return Err(LogError::content(file, "too many channels", format!("at most {MAX_NAMES}")));
        }
        let names = unique_names(&columns);
        let groups = columns.into_iter().map(|(group, _)| group).collect();
        Ok(Self { bytes, index, places, names, groups, records: RefCell::default() })
    }

    fn channel(&self, index: usize) -> Option<(usize, &IndexedChannelGroup, &IndexedChannel)> {
        let (number, position) = *self.places.get(index)?;
        let group = self.index.channel_groups.get(number)?;
        Some((number, group, group.channels.get(position)?))
    }

    /// Numbers of a column.
    fn numbers(&self, index: usize) -> Result<Vec<f64>, String> {
        let (number, group, channel) = self.channel(index).ok_or("no such column")?;
        if group.record_count > MAX_ROWS as u64 {
            return Err(format!("more than {MAX_ROWS} rows"));
        }
        if VIRTUAL.contains(&channel.channel_type) {
            return counted(channel, group.record_count);
        }
        if channel.channel_type == VARIABLE {
            return Err("contents of variable length".into());
        }
        if group.record_id_size != 0 {
            return Err("records of several groups in one block".into());
        }
        let mut cached = self.records.borrow_mut();
        if cached.as_ref().is_none_or(|(known, _)| *known != number) {
            *cached = Some((number, self.records(group)?));
        }
        let records = cached.as_ref().map_or(&[][..], |(_, records)| records);
        decode(group, channel, records)
    }

    /// Records of a group, one after another: a record may begin in one block and end in the next.
    fn records(&self, group: &IndexedChannelGroup) -> Result<Vec<u8>, String> {
        let size = (group.record_size as usize).saturating_add(group.invalidation_bytes as usize);
        let wanted = usize::try_from(group.record_count).ok().and_then(|count| count.checked_mul(size));
        let wanted = wanted.filter(|wanted| *wanted <= MAX_BYTES);
        let wanted = wanted.ok_or_else(|| format!("more than {} MB of records", MAX_BYTES >> 20))?;
        let mut out = Vec::new();
        for block in &group.data_blocks {
            let damaged = || format!("a damaged block at byte {}", block.file_offset);
            let start = usize::try_from(block.file_offset).map_err(|_| damaged())?;
            let length = usize::try_from(block.size).map_err(|_| damaged())?;
            let end = start.checked_add(length).ok_or_else(damaged)?;
            let block = self.bytes.get(start..end).ok_or_else(damaged)?;
            match block.first_chunk() {
                Some(b"##DZ") => out.extend(unzipped(block, wanted - out.len()).ok_or_else(damaged)?),
                _ => out.extend(block.get(HEAD_BYTES..).ok_or_else(damaged)?),
            }
            if out.len() >= wanted {
                break;
            }
        }
        if out.len() < wanted {
            return Err(format!("{} bytes of records in place of {wanted}", out.len()));
        }
        out.truncate(wanted);
        Ok(out)
    }
}

impl LogFile for Mdf {
    fn format(&self) -> &'static str {
        "MDF"
    }

    fn names(&self) -> &[String] {
        &self.names
    }

    fn group(&self, index: usize) -> &str {
        self.groups.get(index).map_or("", String::as_str)
    }

    fn unit(&self, index: usize) -> &str {
        self.channel(index).and_then(|(.., channel)| channel.unit.as_deref()).unwrap_or("")
    }

    fn values(&self, file: &str, index: usize, wanted: &str, _: bool) -> Result<Vec<f64>, LogError> {
        let name = self.names.get(index).map_or("", String::as_str);
        self.numbers(index).map_err(|found| refused(file, (name, wanted), found, "numbers in sorted records"))
    }
}

/// Values of a channel that is counted: its conversion of 0, 1, 2, ...
fn counted(channel: &IndexedChannel, count: u64) -> Result<Vec<f64>, String> {
    let value = |index: u64| {
        let stored = DecodedValue::UnsignedInteger(index);
        let value = match &channel.conversion {
            Some(conversion) => conversion.apply_decoded(stored, &[])?,
            None => stored,
        };
        Ok::<f64, Error>(value.as_f64().unwrap_or(f64::NAN))
    };
    guarded(|| (0..count).map(value).collect())
}

/// Decodes the records of a group. The library takes every block for whole records, so it is given
/// one block at a time that contains whole records.
fn decode(group: &IndexedChannelGroup, channel: &IndexedChannel, records: &[u8]) -> Result<Vec<f64>, String> {
    let size = group.record_size as usize + group.invalidation_bytes as usize;
    let mut out = Vec::new();
    for batch in records.chunks(size.saturating_mul(BATCH).max(1)) {
        let block =
            DataBlockInfo { file_offset: 0, size: (HEAD_BYTES + batch.len()) as u64, is_compressed: false };
        let group = IndexedChannelGroup {
            channels: vec![channel.clone()],
            data_blocks: vec![block],
            ..without_channels(group)
        };
        let index = MdfIndex { file_size: 0, channel_groups: vec![group] };
        let values = guarded(|| index.read_channel_values(0, 0, &mut Records(batch)))?;
        let is_number = |value: &DecodedValue| value.as_f64().is_some();
        if values.iter().flatten().next().is_some_and(|first| !is_number(first)) {
            return Err("content that is no number".into());
        }
        out.extend(values.iter().map(|v| v.as_ref().and_then(DecodedValue::as_f64).unwrap_or(f64::NAN)));
    }
    Ok(out)
}

/// Layout of a group's records without its channels, which may be many.
fn without_channels(group: &IndexedChannelGroup) -> IndexedChannelGroup {
    IndexedChannelGroup {
        name: None,
        comment: None,
        record_id_size: group.record_id_size,
        record_size: group.record_size,
        invalidation_bytes: group.invalidation_bytes,
        record_count: group.record_count,
        channels: Vec::new(),
        data_blocks: Vec::new(),
    }
}

/// Unpacks a compressed block, of which at most `most` bytes and a byte more are of interest. In a
/// transposed block the bytes of the same place in all rows follow each other.
fn unzipped(block: &[u8], most: usize) -> Option<Vec<u8>> {
    let head = block.get(..ZIPPED_HEAD_BYTES)?;
    let kind = *head.get(26)?;
    let width = u32::from_le_bytes(*head.get(28..)?.first_chunk()?) as usize;
    let length = usize::try_from(u64::from_le_bytes(*head.get(32..)?.first_chunk()?)).ok()?;
    if length > MAX_BYTES || length > most.checked_add(1 << 24)? {
        return None;
    }
    let mut data = Vec::new();
    ZlibDecoder::new(block.get(ZIPPED_HEAD_BYTES..)?).take(length as u64 + 1).read_to_end(&mut data).ok()?;
    if data.len() != length {
        return None;
    }
    if kind == 0 {
        return Some(data);
    }
    let rows = length.checked_div(width)?;
    let mut out = vec![0; length];
    let (turned, rest) = data.split_at_checked(rows * width)?;
    for (place, byte) in turned.iter().enumerate() {
        *out.get_mut(place % rows * width + place / rows)? = *byte;
    }
    out.get_mut(rows * width..)?.copy_from_slice(rest);
    Some(out)
}

/// Bytes of a file for the library. The budget ends circles of blocks.
struct Blocks<'a> {
    bytes: &'a [u8],
    budget: usize,
}

impl Blocks<'_> {
    /// Returns whether the file has room for a block with its links, for which the library reserves
    /// memory; true for other bytes.
    fn has_room(&self, found: &[u8], offset: u64) -> bool {
        let field = |at: usize| Some(u64::from_le_bytes(*found.get(at..)?.first_chunk()?));
        if !found.starts_with(b"##") {
            return true;
        }
        let (Some(length), Some(links)) = (field(8), field(16)) else { return false };
        let least = links.checked_mul(8).and_then(|links| links.checked_add(HEAD_BYTES as u64));
        let end = offset.checked_add(length);
        least.is_some_and(|least| least <= length) && end.is_some_and(|end| end <= self.bytes.len() as u64)
    }
}

impl ByteRangeReader for Blocks<'_> {
    type Error = Error;

    fn read_range(&mut self, offset: u64, length: u64) -> Result<Vec<u8>, Error> {
        let range = usize::try_from(offset).ok().zip(usize::try_from(length).ok());
        let range = range.and_then(|(start, length)| self.bytes.get(start..start.checked_add(length)?));
        let found = range.ok_or_else(|| flaw(format!("{length} bytes at byte {offset}, beyond the end")))?;
        if found.is_empty() || !self.has_room(found, offset) {
            return Err(flaw(format!("a damaged block at byte {offset}")));
        }
        let left = self.budget.checked_sub(found.len().max(HEAD_BYTES));
        self.budget = left.ok_or_else(|| flaw("blocks that refer to each other in a circle".into()))?;
        Ok(found.to_vec())
    }
}

/// Records as the block at the start of a file.
struct Records<'a>(&'a [u8]);

impl ByteRangeReader for Records<'_> {
    type Error = Error;

    fn read_range(&mut self, _: u64, _: u64) -> Result<Vec<u8>, Error> {
        Ok(self.0.to_vec())
    }
}

fn flaw(text: String) -> Error {
    Error::BlockSerializationError(text)
}
