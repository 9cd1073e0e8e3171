//! Records of a file or of one of its chunks. Layout: "MCAP Format Specification", version 0.

use super::cursor::Cursor;
use super::table::Flaw;
use crate::log::files::file::guarded;
use flate2::Crc;
use std::borrow::Cow;
use std::io::Read;

/// Size of a record's kind and length.
const HEAD_BYTES: usize = 9;
/// Maximum size of an unpacked chunk.
pub(super) const MAX_CHUNK_BYTES: usize = 1 << 28;

/// Record that is of interest.
pub(super) enum Record<'a> {
    Schema(u16, Schema<'a>),
    Channel(u16, Channel),
    Message(Message<'a>),
    Chunk(Chunk<'a>),
    /// End of the data, with their checksum or 0.
    DataEnd(u32),
    Other,
}

/// Definition of a type of messages.
pub(super) struct Schema<'a> {
    pub(super) name: String,
    pub(super) encoding: String,
    pub(super) text: &'a [u8],
}

/// Source of messages.
#[derive(PartialEq, Eq, Hash)]
pub(super) struct Channel {
    pub(super) schema: u16,
    pub(super) topic: String,
    pub(super) encoding: String,
}

/// Message as it is stored.
pub(super) struct Message<'a> {
    pub(super) channel: u16,
    /// Time at which it was recorded, in ns.
    pub(super) log_time: u64,
    pub(super) data: &'a [u8],
}

/// Records that are packed together.
pub(super) struct Chunk<'a> {
    size: u64,
    checksum: u32,
    compression: String,
    data: &'a [u8],
}

/// Returns the record at a place and the place after it.
pub(super) fn record(bytes: &[u8], at: usize) -> Result<(Record<'_>, usize), Flaw> {
    let mut head = Cursor::packed(bytes.get(at..).unwrap_or_default());
    let (kind, length) = (head.u8()?, head.u64()?);
    let length = usize::try_from(length).map_err(|_| Flaw::from("a record beyond the end"))?;
    let mut body = Cursor::packed(head.take(length).map_err(|_| Flaw::from("a record beyond the end"))?);
    let record = match kind {
        0 => return Err("a record of kind 0".into()),
        3 => Record::Schema(
            body.u16()?,
            Schema { name: body.text()?, encoding: body.text()?, text: body.counted()? },
        ),
        4 => Record::Channel(
            body.u16()?,
            Channel { schema: body.u16()?, topic: body.text()?, encoding: body.text()? },
        ),
        5 => {
            let (channel, _sequence, log_time, _published) =
                (body.u16()?, body.u32()?, body.u64()?, body.u64()?);
            Record::Message(Message { channel, log_time, data: body.rest() })
        }
        6 => {
            let (_first, _last, size, checksum) = (body.u64()?, body.u64()?, body.u64()?, body.u32()?);
            let (compression, length) = (body.text()?, body.u64()?);
            let data = body.take(usize::try_from(length).unwrap_or(usize::MAX))?;
            Record::Chunk(Chunk { size, checksum, compression, data })
        }
        15 => Record::DataEnd(body.u32()?),
        _ => Record::Other,
    };
    Ok((record, at + HEAD_BYTES + length))
}

impl<'a> Chunk<'a> {
    /// Size of the records in bytes.
    pub(super) fn size(&self) -> Result<usize, Flaw> {
        let size = usize::try_from(self.size).ok().filter(|size| *size <= MAX_CHUNK_BYTES);
        size.ok_or(Flaw::TooLarge)
    }

    /// Returns the records unpacked.
    pub(super) fn records(&self) -> Result<Cow<'a, [u8]>, Flaw> {
        let size = self.size()?;
        let records = match self.compression.as_str() {
            "" => Cow::Borrowed(self.data),
            "lz4" => Cow::Owned(guarded(|| lz4(self.data, size))?),
            "zstd" => Cow::Owned(guarded(|| zstd(self.data, size))?),
            other => return Err(format!("compression `{}`", other.escape_debug()).into()),
        };
        if records.len() != size {
            return Err(format!("other than the {size} bytes that it states").into());
        }
        if !is_intact(&records, self.checksum) {
            return Err("a wrong checksum".into());
        }
        Ok(records)
    }
}

/// Appends at most one byte more than the stated size. Writers may pad what is after the end.
fn append(out: &mut Vec<u8>, source: &mut impl Read, size: usize) -> std::io::Result<()> {
    out.try_reserve_exact(size - out.len())?;
    source.by_ref().take((size - out.len()) as u64).read_to_end(out)?;
    let mut next = [0];
    if out.len() == size && matches!(source.read(&mut next), Ok(1)) {
        out.extend(next);
    }
    Ok(())
}

fn lz4(data: &[u8], size: usize) -> std::io::Result<Vec<u8>> {
    let mut out = Vec::new();
    append(&mut out, &mut lz4_flex::frame::FrameDecoder::new(data), size)?;
    Ok(out)
}

/// Unpacks one frame or several.
fn zstd(data: &[u8], size: usize) -> std::io::Result<Vec<u8>> {
    let (mut out, mut rest) = (Vec::new(), data);
    while out.len() < size && !rest.is_empty() {
        let most = MAX_CHUNK_BYTES as u64;
        let frame = ruzstd::decoding::StreamingDecoder::new_with_max_window_size(&mut rest, most);
        append(&mut out, &mut frame.map_err(std::io::Error::other)?, size)?;
    }
    Ok(out)
}

/// Returns whether bytes have a checksum; 0 stands for none.
pub(super) fn is_intact(bytes: &[u8], checksum: u32) -> bool {
    let mut crc = Crc::new();
    checksum == 0 || {
        crc.update(bytes);
        crc.sum() == checksum
    }
}
