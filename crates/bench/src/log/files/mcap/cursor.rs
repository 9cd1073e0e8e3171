//! Bytes from which fields are read in order: packed, or aligned to their size.

use super::table::Flaw;

/// Place in a record or a message.
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    is_big: bool,
    is_aligned: bool,
}

impl<'a> Cursor<'a> {
    /// Returns a cursor over packed fields, least significant byte first.
    pub(super) fn packed(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, is_big: false, is_aligned: false }
    }

    /// Returns a cursor over fields that begin at multiples of their size.
    pub(super) fn aligned(bytes: &'a [u8], is_big: bool) -> Self {
        Self { bytes, at: 0, is_big, is_aligned: true }
    }

    /// Number of bytes after the cursor.
    pub(super) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Takes the next bytes without alignment.
    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], Flaw> {
        let end = self.at.checked_add(count).filter(|end| *end <= self.bytes.len());
        let end = end.ok_or_else(|| Flaw::from("content that ends too early"))?;
        let taken = self.bytes.get(self.at..end).unwrap_or_default();
        self.at = end;
        Ok(taken)
    }

    /// Takes all bytes that are left.
    pub(super) fn rest(&mut self) -> &'a [u8] {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        self.at = self.bytes.len();
        rest
    }

    /// Takes an array of numbers of a size in bytes.
    pub(super) fn array(&mut self, count: usize, size: usize) -> Result<&'a [u8], Flaw> {
        if self.is_aligned && count > 0 {
            self.take(self.at.next_multiple_of(size) - self.at)?;
        }
        self.take(count.saturating_mul(size))
    }

    /// Bytes of a number, least significant byte first.
    fn number<const SIZE: usize>(&mut self) -> Result<[u8; SIZE], Flaw> {
        let mut out = [0; SIZE];
        let taken = self.array(1, SIZE)?;
        out.iter_mut().zip(taken).for_each(|(to, from)| *to = *from);
        if self.is_big {
            out.reverse();
        }
        Ok(out)
    }

    pub(super) fn u8(&mut self) -> Result<u8, Flaw> {
        self.number().map(u8::from_le_bytes)
    }

    pub(super) fn u16(&mut self) -> Result<u16, Flaw> {
        self.number().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Result<u32, Flaw> {
        self.number().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Result<u64, Flaw> {
        self.number().map(u64::from_le_bytes)
    }

    /// Takes bytes after their number.
    pub(super) fn counted(&mut self) -> Result<&'a [u8], Flaw> {
        let count = self.u32()? as usize;
        self.take(count)
    }

    pub(super) fn text(&mut self) -> Result<String, Flaw> {
        self.counted().map(|bytes| String::from_utf8_lossy(bytes).into_owned())
    }
}
