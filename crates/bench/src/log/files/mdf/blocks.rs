//! Blocks of an MDF file: groups, channels and the places of their records.
//!
//! A block is a header (kind, length, number of links), links to other blocks, and data. Chains of
//! blocks may not return to a block that was read before, so a damaged file cannot be endless.

use std::collections::HashSet;

/// Length of a block's header.
const HEAD_BYTES: usize = 24;
/// Place of the first block.
const FIRST: u64 = 64;
/// Maximum depth of structures in structures.
const MAX_DEPTH: usize = 8;

/// Error in words.
pub(super) type Flaw = String;

/// Block of a file.
#[derive(Clone, Copy)]
pub(super) struct Block<'a> {
    pub(super) kind: &'a [u8],
    links: &'a [u8],
    pub(super) data: &'a [u8],
}

impl<'a> Block<'a> {
    /// Reads the block at a place; the error says what is damaged.
    pub(super) fn at(bytes: &'a [u8], place: u64) -> Result<Self, Flaw> {
        Self::parse(bytes, place).ok_or_else(|| format!("a damaged block at byte {place}"))
    }

    fn parse(bytes: &'a [u8], place: u64) -> Option<Self> {
        let rest = bytes.get(usize::try_from(place).ok()?..)?;
        let kind = rest.get(..4)?.strip_prefix(b"##")?;
        let length = usize::try_from(u64_at(rest, 8)?).ok()?;
        let links = usize::try_from(u64_at(rest, 16)?).ok()?.checked_mul(8)?;
        let body = rest.get(HEAD_BYTES..length)?;
        let (links, data) = body.split_at_checked(links)?;
        Some(Self { kind, links, data })
    }

    /// Reads the block of a kind at a place.
    pub(super) fn read(bytes: &'a [u8], place: u64, kind: &[u8]) -> Result<Self, Flaw> {
        let block = Self::at(bytes, place)?;
        if block.kind == kind { Ok(block) } else { Err(format!("a damaged block at byte {place}")) }
    }

    /// Place of another block; 0 if there is none.
    pub(super) fn link(&self, index: usize) -> u64 {
        u64_at(self.links, 8 * index).unwrap_or(0)
    }

    /// Places of the blocks from a link on.
    pub(super) fn links_from(&self, first: usize) -> Vec<u64> {
        (first..self.links.len() / 8).map(|index| self.link(index)).collect()
    }

    pub(super) fn u8(&self, at: usize) -> Result<u8, Flaw> {
        self.data.get(at).copied().ok_or_else(|| "a block that is too short".to_owned())
    }

    pub(super) fn u16(&self, at: usize) -> Result<u16, Flaw> {
        self.array(at).map(u16::from_le_bytes)
    }

    pub(super) fn u32(&self, at: usize) -> Result<u32, Flaw> {
        self.array(at).map(u32::from_le_bytes)
    }

    pub(super) fn u64(&self, at: usize) -> Result<u64, Flaw> {
        self.array(at).map(u64::from_le_bytes)
    }

    fn array<const N: usize>(&self, at: usize) -> Result<[u8; N], Flaw> {
        let found = self.data.get(at..).and_then(|rest| rest.first_chunk());
        found.copied().ok_or_else(|| "a block that is too short".to_owned())
    }
}

fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    bytes.get(at..)?.first_chunk().map(|bytes| u64::from_le_bytes(*bytes))
}

/// Text of a block, or the text in its XML; empty without one.
pub(super) fn text(bytes: &[u8], place: u64) -> String {
    let Some(block) = Block::at(bytes, place).ok().filter(|_| place != 0) else { return String::new() };
    let data = block.data.split(|byte| *byte == 0).next().unwrap_or_default();
    let text = String::from_utf8_lossy(data);
    let inner = |text: &str| Some(plain(text.split_once("<TX>")?.1.split_once("</TX>")?.0));
    let found = if block.kind == b"MD" { inner(&text).unwrap_or_default() } else { text.into_owned() };
    found.trim().to_owned()
}

/// Text of XML without the entities that every document knows.
fn plain(xml: &str) -> String {
    let known = [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&apos;", "'"), ("&amp;", "&")];
    known.iter().fold(xml.to_owned(), |text, (entity, letter)| text.replace(entity, letter))
}

/// Channels that share their records.
#[derive(Debug)]
pub(super) struct Group {
    pub(super) name: String,
    /// Bytes of a record: its number, the values, the marks of invalid values.
    pub(super) number_bytes: usize,
    pub(super) value_bytes: usize,
    pub(super) mark_bytes: usize,
    /// Number of the group in the records of several groups.
    pub(super) number: u64,
    /// Number of records.
    pub(super) count: u64,
    /// Block or list of blocks with the records, and the groups whose records it contains.
    pub(super) records: u64,
    pub(super) siblings: Vec<Sibling>,
    pub(super) channels: Vec<Channel>,
}

/// Size of a group's records among those of other groups; `None` for values of variable length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sibling {
    pub(super) number: u64,
    pub(super) bytes: Option<usize>,
}

impl Group {
    /// Bytes of a record without the number of the group.
    pub(super) fn record_bytes(&self) -> usize {
        self.value_bytes + self.mark_bytes
    }
}

/// Channel of a group.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    pub(super) name: String,
    pub(super) unit: String,
    /// Kind of the channel, of the quantity that it synchronises, and of its values.
    pub(super) kind: u8,
    pub(super) synchronises: u8,
    pub(super) data_type: u8,
    pub(super) bit_offset: u32,
    pub(super) byte_offset: usize,
    pub(super) bits: u32,
    pub(super) flags: u32,
    pub(super) mark_bit: usize,
    pub(super) conversion: u64,
    /// Content of a record that is not one number, in words.
    pub(super) refusal: Option<&'static str>,
}

/// Groups of a file with their channels, at most `most` channels.
pub(super) fn groups(bytes: &[u8], max_channels: usize) -> Result<Vec<Group>, Flaw> {
    let mut file = File { bytes, known: HashSet::new(), groups: Vec::new(), channels: 0, max_channels };
    let mut place = Block::read(bytes, FIRST, b"HD")?.link(0);
    while place != 0 {
        let data_group = file.next(place, b"DG")?;
        file.data_group(&data_group)?;
        place = data_group.link(0);
    }
    Ok(file.groups)
}

/// Groups found so far.
struct File<'a> {
    bytes: &'a [u8],
    /// Places of the blocks that were read.
    known: HashSet<u64>,
    groups: Vec<Group>,
    channels: usize,
    max_channels: usize,
}

impl<'a> File<'a> {
    /// Reads a block of a chain.
    fn next(&mut self, place: u64, kind: &[u8]) -> Result<Block<'a>, Flaw> {
        if !self.known.insert(place) {
            return Err("blocks that refer to each other in a circle".into());
        }
        Block::read(self.bytes, place, kind)
    }

    /// Reads the groups that share a list of records.
    fn data_group(&mut self, data_group: &Block<'a>) -> Result<(), Flaw> {
        let number_bytes = usize::from(data_group.u8(0)?);
        let first = self.groups.len();
        let (mut place, mut siblings) = (data_group.link(1), Vec::new());
        while place != 0 {
            let block = self.next(place, b"CG")?;
            let flags = block.u16(16)?;
            let (value_bytes, mark_bytes) = (block.u32(24)? as usize, block.u32(28)? as usize);
            let is_variable = flags & 1 != 0;
            let number = block.u64(0)?;
            siblings.push(Sibling { number, bytes: (!is_variable).then_some(value_bytes + mark_bytes) });
            let mut channels = Vec::new();
            self.list(block.link(1), 0, &mut channels)?;
            let name = text(self.bytes, block.link(2));
            let name = if name.is_empty() { self.groups.len().to_string() } else { name };
            self.groups.push(Group {
                name,
                number_bytes,
                value_bytes,
                mark_bytes,
                number,
                count: block.u64(8)?,
                records: data_group.link(2),
                siblings: Vec::new(),
                channels,
            });
            place = block.link(0);
        }
        for group in self.groups.iter_mut().skip(first) {
            group.siblings.clone_from(&siblings);
        }
        Ok(())
    }

    /// Lists a chain of channels, and below each structure its parts.
    fn list(&mut self, first: u64, depth: usize, out: &mut Vec<Channel>) -> Result<(), Flaw> {
        if depth > MAX_DEPTH {
            return Err(format!("structures that are nested more than {MAX_DEPTH} deep"));
        }
        let mut place = first;
        while place != 0 {
            let block = self.next(place, b"CN")?;
            let inner = block.link(1);
            let inner_kind = if inner == 0 { &b""[..] } else { Block::at(self.bytes, inner)?.kind };
            let refusal = match inner_kind {
                b"" | b"CN" => None,
                b"CA" => Some("an array in each record"),
                _ => Some("a variant, a union or a list in each record"),
            };
            out.push(channel(self.bytes, &block, refusal)?);
            self.channels += 1;
            if self.channels > self.max_channels {
                return Err(format!("more than {} channels", self.max_channels));
            }
            if inner_kind == b"CN" {
                self.list(inner, depth + 1, out)?;
            }
            place = block.link(0);
        }
        Ok(())
    }
}

fn channel(bytes: &[u8], block: &Block<'_>, refusal: Option<&'static str>) -> Result<Channel, Flaw> {
    Ok(Channel {
        name: text(bytes, block.link(2)),
        unit: text(bytes, block.link(6)),
        kind: block.u8(0)?,
        synchronises: block.u8(1)?,
        data_type: block.u8(2)?,
        bit_offset: u32::from(block.u8(3)?),
        byte_offset: block.u32(4)? as usize,
        bits: block.u32(8)?,
        flags: block.u32(12)?,
        mark_bit: block.u32(16)? as usize,
        conversion: block.link(4),
        refusal,
    })
}
