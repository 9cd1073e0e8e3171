//! A cursor over an image's bytes: every read is bounded, nothing is aligned.

use crate::error::ImageError;
use crate::layout::IMAGE_LENGTH;

/// Bytes not yet read.
pub(crate) struct Reader<'a> {
    rest: &'a [u8],
    length: usize,
}

impl<'a> Reader<'a> {
    /// Reads `bytes`; `length` is the whole image's, for the message when they run out.
    pub(crate) fn new(bytes: &'a [u8], length: usize) -> Self {
        Self { rest: bytes, length }
    }

    /// The next `N` bytes in place.
    pub(crate) fn chunk<const N: usize>(&mut self) -> Result<&'a [u8; N], ImageError> {
        let (chunk, rest) = self
            .rest
            .split_first_chunk()
            .ok_or(ImageError::Length { found: self.length, expected: IMAGE_LENGTH })?;
        self.rest = rest;
        Ok(chunk)
    }

    /// The next `ROWS` groups of `COLUMNS` groups of four bytes in place.
    pub(crate) fn blocks<const COLUMNS: usize, const ROWS: usize>(
        &mut self,
    ) -> Result<&'a [[[u8; 4]; COLUMNS]; ROWS], ImageError> {
        let short = ImageError::Length { found: self.length, expected: IMAGE_LENGTH };
        let (words, _) = self.rest.as_chunks::<4>();
        let (blocks, _) = words.as_chunks::<COLUMNS>();
        let found = blocks.first_chunk::<ROWS>().ok_or(short)?;
        self.rest = self.rest.get(4 * COLUMNS * ROWS..).ok_or(short)?;
        Ok(found)
    }

    /// The next `N` bytes, copied.
    pub(crate) fn array<const N: usize>(&mut self) -> Result<[u8; N], ImageError> {
        self.chunk().copied()
    }

    /// The next two bytes.
    pub(crate) fn u16(&mut self) -> Result<u16, ImageError> {
        self.array().map(u16::from_le_bytes)
    }

    /// The next four bytes.
    pub(crate) fn u32(&mut self) -> Result<u32, ImageError> {
        self.array().map(u32::from_le_bytes)
    }

    /// The next four bytes, signed.
    pub(crate) fn i32(&mut self) -> Result<i32, ImageError> {
        self.array().map(i32::from_le_bytes)
    }

    /// The next eight bytes.
    pub(crate) fn u64(&mut self) -> Result<u64, ImageError> {
        self.array().map(u64::from_le_bytes)
    }

    /// The next four bytes as a float, whatever its value.
    pub(crate) fn f32(&mut self) -> Result<f32, ImageError> {
        self.array().map(f32::from_le_bytes)
    }
}
