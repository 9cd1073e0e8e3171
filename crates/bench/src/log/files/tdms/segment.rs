//! Segments of a TDMS file: objects with their properties, and the places of their values.

use super::bytes::{Cursor, Flaw, Kind};
use super::objects::{Object, Piece, Property};
use super::{MAX_NAMES, MAX_VALUES};
use std::collections::HashMap;

/// First bytes of a file.
pub(in crate::log::files) const TDMS: &[u8] = b"TDSm";

/// Bits of the table of contents of a segment.
const HAS_OBJECTS: u32 = 1 << 1;
const HAS_NEW_LIST: u32 = 1 << 2;
const HAS_DATA: u32 = 1 << 3;
const IS_INTERLEAVED: u32 = 1 << 5;
const IS_BIG: u32 = 1 << 6;

const LEAD_BYTES: usize = 28;
/// Place of the next segment in a file whose writer was stopped.
const UNKNOWN: u64 = u64::MAX;
/// Marks of an object in the list of a segment, in place of the length of its index.
const NO_DATA: u32 = u32::MAX;
const AS_BEFORE: u32 = 0;
const CARD_NUMBERS: u32 = 0x1269;
const CARD_LINES: u32 = 0x126A;
/// Data type of the channel of a card.
const CARD_TYPE: u32 = u32::MAX;
/// Maximum number of passes times objects, which bounds the time that a file can take.
const MAX_STEPS: usize = 1_000_000_000;
/// Maximum number of stretches of values that do not follow each other evenly.
const MAX_PIECES: usize = 5_000_000;
/// Maximum number of buffers and numbers of a card in one channel.
const MAX_CARD: u32 = 1024;

/// Place of an object's values in a chunk.
#[derive(Clone, Debug)]
enum Index {
    /// `count` values, with their size together; the size of a text is given by the file.
    Plain { kind: Kind, count: usize, bytes: usize },
    /// Numbers of a measuring card in rows of a buffer; all channels of a segment share the widths
    /// of the rows. `None` for content that cannot be read.
    Card { number: Option<(Kind, usize, usize)>, count: usize, widths: Vec<usize> },
}

/// Objects of all segments; the error has the start of the segment.
pub(super) fn objects(bytes: &[u8]) -> Result<Vec<Object>, (Flaw, usize)> {
    let mut file = File::default();
    let mut at = 0;
    while at < bytes.len() {
        at = file.segment(bytes, at).map_err(|flaw| (flaw, at))?;
    }
    Ok(file.objects)
}

/// Objects found so far.
#[derive(Default)]
struct File {
    objects: Vec<Object>,
    by_path: HashMap<String, usize>,
    /// Last index of each object.
    indices: Vec<Option<Index>>,
    /// Objects with data in the current segment, in order.
    active: Vec<usize>,
    values: usize,
    pieces: usize,
    steps: usize,
}

impl File {
    /// Reads the segment at `at` and returns the start of the next one.
    fn segment(&mut self, bytes: &[u8], at: usize) -> Result<usize, Flaw> {
        let rest = bytes.get(at..).ok_or(Flaw::Damage)?;
        let mut lead = Cursor::new(rest, false);
        if lead.take(4)? != TDMS {
            return Err(Flaw::Damage);
        }
        let contents = lead.u32()?;
        lead.is_big = contents & IS_BIG != 0;
        let _version = lead.u32()?;
        let (next, data) = (lead.u64()?, lead.count()?);
        let next = if next == UNKNOWN { rest.len() } else { place(next)? };
        let data = data.checked_add(LEAD_BYTES).ok_or(Flaw::Damage)?;
        if next > rest.len() || data > next {
            return Err(Flaw::Damage);
        }
        if contents & HAS_NEW_LIST != 0 {
            self.active.clear();
        }
        if contents & HAS_OBJECTS != 0 {
            let head = rest.get(LEAD_BYTES..data).ok_or(Flaw::Damage)?;
            self.list(&mut Cursor::new(head, lead.is_big))?;
        }
        if contents & HAS_DATA != 0 && next > data {
            self.step()?;
            self.data((at + data, at + next), contents & IS_INTERLEAVED != 0, lead.is_big)?;
        }
        Ok(at + next)
    }

    /// Reads the list of objects of a segment.
    fn list(&mut self, cursor: &mut Cursor<'_>) -> Result<(), Flaw> {
        for _ in 0..cursor.u32()? {
            let path = cursor.text()?;
            let object = self.object(path)?;
            let index = match cursor.u32()? {
                NO_DATA => None,
                AS_BEFORE => self.indices.get(object).ok_or(Flaw::Damage)?.clone(),
                CARD_NUMBERS => Some(card(cursor, true)?),
                CARD_LINES => Some(card(cursor, false)?),
                _ => Some(plain(cursor)?),
            };
            let has_data = match &index {
                Some(Index::Plain { count, bytes, .. }) => *count > 0 && *bytes > 0,
                Some(Index::Card { count, .. }) => *count > 0,
                None => false,
            };
            self.step()?;
            if !has_data {
                self.active.retain(|known| *known != object);
            } else if !self.active.contains(&object) {
                self.active.push(object);
            }
            if let (Some(index), Some(own)) = (index, self.indices.get_mut(object)) {
                *own = Some(index);
            }
            for _ in 0..cursor.u32()? {
                let name = cursor.text()?;
                let value = property(cursor)?;
                if let Some(object) = self.objects.get_mut(object) {
                    object.set(name, value);
                }
            }
        }
        Ok(())
    }

    /// Counts a pass over the objects with data.
    fn step(&mut self) -> Result<(), Flaw> {
        self.steps = self.steps.saturating_add(self.active.len());
        if self.steps <= MAX_STEPS { Ok(()) } else { Err(Flaw::TooLarge) }
    }

    /// Number of an object, which is added if it is new.
    fn object(&mut self, path: String) -> Result<usize, Flaw> {
        if let Some(known) = self.by_path.get(&path) {
            return Ok(*known);
        }
        if self.objects.len() >= MAX_NAMES {
            return Err(Flaw::TooLarge);
        }
        self.objects.push(Object { path: parts(&path), ..Object::default() });
        self.indices.push(None);
        self.by_path.insert(path, self.objects.len() - 1);
        Ok(self.objects.len() - 1)
    }

    /// Adds the places of the values between two bytes of the file.
    fn data(&mut self, (start, end): (usize, usize), interleaved: bool, is_big: bool) -> Result<(), Flaw> {
        let active: Vec<(usize, Index)> = self
            .active
            .iter()
            .filter_map(|object| Some((*object, self.indices.get(*object)?.clone()?)))
            .collect();
        let widths = active.iter().find_map(|(_, index)| match index {
            Index::Card { widths, .. } => Some(widths.clone()),
            Index::Plain { .. } => None,
        });
        let layout = Layout { start, end, is_big };
        let pieces = match widths {
            Some(widths) => layout.card(&active, &widths)?,
            None if interleaved => layout.interleaved(&active)?,
            None => layout.contiguous(&active)?,
        };
        for (object, piece) in pieces {
            let Some(object) = self.objects.get_mut(object) else { continue };
            let Some(piece) = piece else {
                object.refusal = Some("texts, complex numbers or lines of a measuring card");
                continue;
            };
            let values = piece.count.checked_mul(piece.chunks).ok_or(Flaw::Damage)?;
            self.values = self.values.checked_add(values).ok_or(Flaw::TooLarge)?;
            if self.values > MAX_VALUES {
                return Err(Flaw::TooLarge);
            }
            object.count += values;
            if values > 0 && !object.pieces.last_mut().is_some_and(|last| last.continues(&piece)) {
                self.pieces += 1;
                object.pieces.push(piece);
            }
            if self.pieces > MAX_PIECES {
                return Err(Flaw::TooLarge);
            }
        }
        Ok(())
    }
}

/// Place of the next segment, from the start of this one.
fn place(next: u64) -> Result<usize, Flaw> {
    usize::try_from(next).ok().and_then(|next| next.checked_add(LEAD_BYTES)).ok_or(Flaw::Damage)
}

/// Group and channel of a path: `/'group'/'channel'`, in which a quote is doubled.
fn parts(path: &str) -> Vec<String> {
    let (mut out, mut letters) = (Vec::new(), path.chars().peekable());
    let mut part: Option<String> = None;
    while let Some(letter) = letters.next() {
        match (&mut part, letter) {
            (None, '\'') => part = Some(String::new()),
            (None, _) => {}
            (Some(text), '\'') if letters.peek() == Some(&'\'') => {
                letters.next();
                text.push('\'');
            }
            (Some(_), '\'') => out.extend(part.take()),
            (Some(text), letter) => text.push(letter),
        }
    }
    out
}

fn plain(cursor: &mut Cursor<'_>) -> Result<Index, Flaw> {
    let kind = Kind::from_code(cursor.u32()?)?;
    let (dimension, count) = (cursor.u32()?, cursor.count()?);
    if dimension != 1 {
        return Err(Flaw::Damage);
    }
    let bytes = if kind.size() == 0 {
        cursor.count()?
    } else {
        kind.size().checked_mul(count).ok_or(Flaw::Damage)?
    };
    Ok(Index::Plain { kind, count, bytes })
}

/// Reads the index of a measuring card's channel, which has numbers or digital lines.
fn card(cursor: &mut Cursor<'_>, has_numbers: bool) -> Result<Index, Flaw> {
    let (data_type, dimension, count) = (cursor.u32()?, cursor.u32()?, cursor.count()?);
    let scalers = cursor.u32()?;
    if data_type != CARD_TYPE && Kind::from_code(data_type).is_err() || dimension != 1 || scalers > MAX_CARD {
        return Err(Flaw::Damage);
    }
    let mut numbers = Vec::new();
    for _ in 0..scalers {
        let (kind, buffer, offset) = (cursor.u32()?, cursor.u32()? as usize, cursor.u32()? as usize);
        // Format of the sample, and number of the scale.
        cursor.take(if has_numbers { 8 } else { 5 })?;
        numbers.push((kind, buffer, offset));
    }
    let buffers = cursor.u32()?;
    if buffers > MAX_CARD {
        return Err(Flaw::Damage);
    }
    let widths = (0..buffers).map(|_| Ok(cursor.u32()? as usize)).collect::<Result<Vec<_>, _>>()?;
    let number = match numbers.as_slice() {
        [(kind, buffer, offset)] if has_numbers => Some((Kind::of_card(*kind)?, *buffer, *offset)),
        _ => None,
    };
    Ok(Index::Card { number, count, widths })
}

fn property(cursor: &mut Cursor<'_>) -> Result<Property, Flaw> {
    let code = cursor.u32()?;
    Ok(match Kind::from_code(code)? {
        Kind::Other(0) => Property::Text(cursor.text()?),
        kind => {
            let bytes = cursor.take(kind.size())?;
            match kind {
                Kind::Timestamp => Property::Stamp(kind.stamp(bytes, cursor.is_big)),
                _ => kind.number(bytes, cursor.is_big, 0).map_or(Property::Other, Property::Number),
            }
        }
    })
}

/// Stretch of a file with the chunks of one segment.
#[derive(Clone, Copy)]
struct Layout {
    start: usize,
    end: usize,
    is_big: bool,
}

/// Object and the place of its values; `None` for content that is no number.
type Pieces = Vec<(usize, Option<Piece>)>;

impl Layout {
    /// Number of complete chunks of a size.
    fn chunks(self, chunk_bytes: usize) -> usize {
        (self.end - self.start).checked_div(chunk_bytes).unwrap_or(0)
    }

    /// Values of one object after those of another. An incomplete last chunk, which a stopped
    /// writer leaves, is read as far as it goes.
    fn contiguous(self, active: &[(usize, Index)]) -> Result<Pieces, Flaw> {
        let plain = |index: &Index| match index {
            Index::Plain { kind, count, bytes } => (*kind, *count, *bytes),
            Index::Card { .. } => (Kind::Other(0), 0, 0),
        };
        let add = |sum: usize, (_, index): &(usize, Index)| sum.checked_add(plain(index).2);
        let chunk_bytes = active.iter().try_fold(0, add).ok_or(Flaw::Damage)?;
        let chunks = self.chunks(chunk_bytes);
        let mut out = Pieces::new();
        for (first, chunks) in [(self.start, chunks), (self.start + chunks * chunk_bytes, 1)] {
            let mut start = first;
            let is_last = first != self.start || chunk_bytes > self.end - self.start;
            for (object, index) in active {
                let (kind, count, bytes) = plain(index);
                let left = self.end.saturating_sub(start);
                let fits =
                    if is_last { left.checked_div(kind.size()).unwrap_or(0).min(count) } else { count };
                let stride = kind.size();
                let piece =
                    Piece { kind, is_big: self.is_big, start, count: fits, stride, chunks, chunk_bytes };
                out.push((*object, (!matches!(kind, Kind::Other(_))).then_some(piece)));
                start = start.saturating_add(bytes);
            }
        }
        Ok(out)
    }

    /// One value of each object in a row.
    fn interleaved(self, active: &[(usize, Index)]) -> Result<Pieces, Flaw> {
        let kind = |index: &Index| match index {
            Index::Plain { kind, .. } => Ok(*kind),
            Index::Card { .. } => Err(Flaw::Damage),
        };
        let kinds = active.iter().map(|(_, index)| kind(index)).collect::<Result<Vec<_>, _>>()?;
        // A text has no place in a row.
        if kinds.contains(&Kind::Other(0)) {
            return Err(Flaw::Damage);
        }
        let stride: usize = kinds.iter().map(|kind| kind.size()).sum();
        let (rows, mut start) = (self.chunks(stride), self.start);
        let mut out = Pieces::new();
        for ((object, _), kind) in active.iter().zip(kinds) {
            let piece =
                Piece { kind, is_big: self.is_big, start, count: rows, stride, chunks: 1, chunk_bytes: 0 };
            out.push((*object, (!matches!(kind, Kind::Other(_))).then_some(piece)));
            start += kind.size();
        }
        Ok(out)
    }

    /// Rows of a measuring card, buffer after buffer.
    fn card(self, active: &[(usize, Index)], widths: &[usize]) -> Result<Pieces, Flaw> {
        let mut rows = vec![0; widths.len()];
        let mut out = Pieces::new();
        for (_, index) in active {
            let Index::Card { number, count, .. } = index else { return Err(Flaw::Damage) };
            let buffer = number.map_or(0, |(_, buffer, _)| buffer);
            let rows: &mut usize = rows.get_mut(buffer).ok_or(Flaw::Damage)?;
            *rows = (*rows).max(*count);
        }
        let mut starts = vec![0_usize];
        for (rows, width) in rows.iter().zip(widths) {
            let last = starts.last().copied().unwrap_or(0);
            starts
                .push(rows.checked_mul(*width).and_then(|size| size.checked_add(last)).ok_or(Flaw::Damage)?);
        }
        let chunk_bytes = starts.last().copied().unwrap_or(0);
        let chunks = self.chunks(chunk_bytes);
        for (object, index) in active {
            let Index::Card { number, count, .. } = index else { continue };
            let piece = number.and_then(|(kind, buffer, offset)| {
                let (start, width) = (starts.get(buffer)?, *widths.get(buffer)?);
                let start = self.start.checked_add(*start)?.checked_add(offset)?;
                let is_inside = offset.checked_add(kind.size())? <= width;
                let (is_big, count, stride) = (self.is_big, *count, width);
                is_inside.then_some(Piece { kind, is_big, start, count, stride, chunks, chunk_bytes })
            });
            out.push((*object, piece));
        }
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use super::parts;

    #[test]
    fn a_path_is_split_at_its_quotes() {
        assert_eq!(parts("/"), Vec::<String>::new());
        assert_eq!(parts("/'a/b'/'it''s'"), ["a/b", "it's"]);
    }
}
