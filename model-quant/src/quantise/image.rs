//! Model images in aligned memory, with activations of either width.

use inference::image::{HEADER_LENGTH, LayerShape, SHAPE_LENGTH};
use inference::{ContactState, Estimate, Header, ImageError, Model, Pair};
use std::ops::Deref;
use std::path::Path;

/// Bytes at an address divisible by 4.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlignedImage {
    words: Vec<u32>,
    length: usize,
}

impl AlignedImage {
    /// Creates an image of zeros.
    pub(crate) fn zeros(length: usize) -> Self {
        Self { words: vec![0; length.div_ceil(4)], length }
    }

    /// Copies bytes to an aligned address.
    pub fn copy(bytes: &[u8]) -> Self {
        let mut image = Self::zeros(bytes.len());
        for (slot, byte) in image.bytes_mut().iter_mut().zip(bytes) {
            *slot = *byte;
        }
        image
    }

    /// Reads a file.
    ///
    /// # Errors
    ///
    /// The operating system's.
    pub(crate) fn read(path: &Path) -> std::io::Result<Self> {
        std::fs::read(path).map(|bytes| Self::copy(&bytes))
    }

    /// Bytes, mutable.
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        bytemuck::cast_slice_mut::<u32, u8>(&mut self.words).get_mut(..self.length).unwrap_or_default()
    }
}

impl Deref for AlignedImage {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        bytemuck::cast_slice::<u32, u8>(&self.words).get(..self.length).unwrap_or_default()
    }
}

/// A model with activations of either width.
#[derive(Clone, Copy, Debug)]
pub enum AnyModel<'a> {
    /// 16 bits between the layers.
    Sixteen(Model<'a, i16>),
    /// 8 bits: compact.
    Eight(Model<'a, i8>),
}

impl<'a> AnyModel<'a> {
    /// Checks an image and borrows it. The output width of the first layer selects the variant.
    ///
    /// # Errors
    ///
    /// Those of [`Model::load`].
    pub fn load(image: &'a [u8]) -> Result<Self, ImageError> {
        let shape = image.get(HEADER_LENGTH..).and_then(<[u8]>::first_chunk::<SHAPE_LENGTH>);
        match shape.and_then(LayerShape::from_bytes) {
            Some(LayerShape { output_bits: 8, .. }) => Model::load(image).map(Self::Eight),
            _ => Model::load(image).map(Self::Sixteen),
        }
    }

    /// Header of the image.
    pub fn header(&self) -> Header {
        match self {
            Self::Sixteen(model) => model.header(),
            Self::Eight(model) => model.header(),
        }
    }
}

/// [`Pair`] for a model of either width.
#[derive(Clone, Debug)]
pub enum AnyPair<'a> {
    /// 16 bits between the layers.
    Sixteen(Box<Pair<'a, i16>>),
    /// 8 bits: compact.
    Eight(Box<Pair<'a, i8>>),
}

impl<'a> AnyPair<'a> {
    /// Starts with an empty history.
    pub fn new(model: AnyModel<'a>) -> Self {
        match model {
            AnyModel::Sixteen(model) => Self::Sixteen(Box::new(Pair::new(model))),
            AnyModel::Eight(model) => Self::Eight(Box::new(Pair::new(model))),
        }
    }

    /// Takes one sample in SI units.
    pub fn push(&mut self, state: &ContactState) -> Estimate {
        match self {
            Self::Sixteen(pair) => pair.push(state),
            Self::Eight(pair) => pair.push(state),
        }
    }

    /// Clears the history.
    pub(crate) fn reset(&mut self) {
        match self {
            Self::Sixteen(pair) => pair.reset(),
            Self::Eight(pair) => pair.reset(),
        }
    }
}
