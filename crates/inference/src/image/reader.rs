//! Cursor over an image's bytes: every read is bounded and in place.

use super::{ImageError, LayerName, LayerShape, WeightForm};

/// Bytes not yet read.
#[derive(Clone, Debug)]
pub struct Reader<'a> {
    remaining: &'a [u8],
}

impl<'a> Reader<'a> {
    /// Creates a reader of `bytes`, which should be at an address divisible by 4.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { remaining: bytes }
    }

    /// Decides whether everything has been read.
    pub fn is_empty(&self) -> bool {
        self.remaining.is_empty()
    }

    /// Reads the next `N` bytes.
    pub(crate) fn chunk<const N: usize>(&mut self) -> Result<&'a [u8; N], ImageError> {
        let (chunk, remaining) = self.remaining.split_first_chunk().ok_or(ImageError::TooShort)?;
        self.remaining = remaining;
        Ok(chunk)
    }

    /// Reads the next `count` values.
    pub(crate) fn slice<T: bytemuck::Pod>(&mut self, count: usize) -> Result<&'a [T], ImageError> {
        let length = count.checked_mul(size_of::<T>()).ok_or(ImageError::TooShort)?;
        let (bytes, remaining) = self.remaining.split_at_checked(length).ok_or(ImageError::TooShort)?;
        self.remaining = remaining;
        if !bytes.as_ptr().cast::<u32>().is_aligned() {
            return Err(ImageError::Alignment);
        }
        bytemuck::try_cast_slice(bytes).map_err(|_| ImageError::Alignment)
    }

    /// Reads the next `N` values.
    pub(crate) fn array<T: bytemuck::Pod, const N: usize>(&mut self) -> Result<&'a [T; N], ImageError> {
        self.slice(N)?.try_into().map_err(|_| ImageError::TooShort)
    }

    /// Reads the next layer's shape, which must be `expected` in some storage form; returns the
    /// form.
    pub(crate) fn shape(
        &mut self,
        layer: LayerName,
        expected: impl Fn(WeightForm) -> LayerShape,
    ) -> Result<WeightForm, ImageError> {
        let found = LayerShape::from_bytes(self.chunk()?);
        let form = found.map_or(WeightForm::Packed, |shape| shape.form);
        let expected = expected(form);
        if found == Some(expected) { Ok(form) } else { Err(ImageError::Shape { layer, found, expected }) }
    }

    /// Reads the next four bytes.
    pub(crate) fn u32(&mut self) -> Result<u32, ImageError> {
        self.chunk().copied().map(u32::from_le_bytes)
    }
}
