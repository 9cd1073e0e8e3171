//! Records of a group, from one block, a list of blocks or compressed blocks.

use super::blocks::{Block, Flaw, Group};
use flate2::read::ZlibDecoder;
use std::collections::{HashMap, HashSet};
use std::io::Read;

/// Maximum size of the records of a group.
const MAX_BYTES: usize = 1 << 30;

/// Records of a group without the numbers of the group, one after another.
pub(super) fn records(bytes: &[u8], group: &Group) -> Result<Vec<u8>, Flaw> {
    let size = group.record_bytes();
    let wanted = usize::try_from(group.count).ok().and_then(|count| count.checked_mul(size));
    let wanted = wanted.filter(|wanted| *wanted <= MAX_BYTES);
    let wanted = wanted.ok_or_else(|| format!("more than {} MB of records", MAX_BYTES >> 20))?;
    let mut stream = Stream { bytes, known: HashSet::new(), out: Vec::new(), max_bytes: MAX_BYTES };
    if group.number_bytes == 0 {
        stream.max_bytes = wanted;
    }
    stream.add(group.records)?;
    let mut found = if group.number_bytes == 0 { stream.out } else { sorted(&stream.out, group)? };
    if found.len() < wanted {
        return Err(format!("{} bytes of records in place of {wanted}", found.len()));
    }
    found.truncate(wanted);
    Ok(found)
}

/// Blocks of records that are put together.
struct Stream<'a> {
    bytes: &'a [u8],
    known: HashSet<u64>,
    out: Vec<u8>,
    /// Bytes that are wanted.
    max_bytes: usize,
}

impl Stream<'_> {
    /// Appends the records of a block or of a list of blocks.
    fn add(&mut self, place: u64) -> Result<(), Flaw> {
        if place == 0 || self.out.len() >= self.max_bytes {
            return Ok(());
        }
        if !self.known.insert(place) {
            return Err("blocks that refer to each other in a circle".into());
        }
        let block = Block::at(self.bytes, place)?;
        let left = self.max_bytes - self.out.len();
        match block.kind {
            b"DT" | b"DV" => self.out.extend(block.data.iter().take(left)),
            b"DZ" => {
                let data =
                    unzipped(&block, left).ok_or_else(|| format!("a damaged block at byte {place}"))?;
                self.out.extend(data);
            }
            b"HL" => self.add(block.link(0))?,
            b"DL" => return self.list(block),
            b"LD" => return Err("a separate block for the values of each channel".into()),
            _ => return Err(format!("a damaged block at byte {place}")),
        }
        Ok(())
    }

    /// Appends the blocks of a list and of those after it.
    fn list(&mut self, first: Block<'_>) -> Result<(), Flaw> {
        let mut list = first;
        loop {
            for place in list.links_from(1) {
                self.add(place)?;
            }
            let next = list.link(0);
            if next == 0 || self.out.len() >= self.max_bytes {
                return Ok(());
            }
            if !self.known.insert(next) {
                return Err("blocks that refer to each other in a circle".into());
            }
            list = Block::read(self.bytes, next, b"DL")?;
        }
    }
}

/// Records of one group among those of others: each begins with the number of its group.
fn sorted(stream: &[u8], group: &Group) -> Result<Vec<u8>, Flaw> {
    let sizes: HashMap<u64, Option<usize>> = group.siblings.iter().map(|s| (s.number, s.bytes)).collect();
    let (mut out, mut rest) = (Vec::new(), stream);
    while rest.len() > group.number_bytes {
        let (head, body) = rest.split_at(group.number_bytes);
        let number = head.iter().rev().take(8).fold(0, |sum, byte| (sum << 8) | u64::from(*byte));
        let size = match sizes.get(&number) {
            Some(Some(size)) => *size,
            // The length of the values, then the values.
            Some(None) => 4 + body.first_chunk().map_or(0, |length| u32::from_le_bytes(*length) as usize),
            None => return Err("a record of no group".into()),
        };
        let Some((record, next)) = body.split_at_checked(size) else { break };
        if number == group.number {
            out.extend(record);
        }
        rest = next;
    }
    Ok(out)
}

/// Unpacks a compressed block, of which at most `most` bytes and some more are of interest. In a
/// transposed block the bytes of the same place in all rows follow each other.
fn unzipped(block: &Block<'_>, max_bytes: usize) -> Option<Vec<u8>> {
    let kind = block.u8(2).ok()?;
    let width = block.u32(4).ok()? as usize;
    let length = usize::try_from(block.u64(8).ok()?).ok()?;
    if length > MAX_BYTES || length > max_bytes.checked_add(1 << 24)? {
        return None;
    }
    let mut data = Vec::new();
    ZlibDecoder::new(block.data.get(24..)?).take(length as u64 + 1).read_to_end(&mut data).ok()?;
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
