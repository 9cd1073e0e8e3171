//! Writing model images: the counterpart of [`crate::Model::load`], for the quantisation tool.
//!
//! It is here so that the format has one home. The controller does not call it.

use super::{CRC_LENGTH, HEADER_LENGTH, Header, LayerKind, LayerShape, WeightForm, checksum};
use crate::kernel::BLOCK;
use crate::scale::Scale;
use crate::storage::{Packed8, Packed16, Storage, Wide};

/// Contents of a layer.
#[derive(Clone, Copy, Debug)]
pub struct LayerParts<'a> {
    /// Shape of the layer.
    pub shape: LayerShape,
    /// One bias per output, at the sum's scale.
    pub biases: &'a [i32],
    /// One multiplier per output for a convolution; empty for a head.
    pub multipliers: &'a [i32],
    /// Scale of a head; not used for a convolution.
    pub scale: Scale,
    /// Weights `[output][tap]`, taps column by column, oldest first.
    pub weights: &'a [i16],
}

/// Reason why something could not be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WriteError {
    /// The output buffer is too small.
    NoRoom,
    /// The lengths of the parts do not match the shape.
    Lengths,
}

impl core::fmt::Display for WriteError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::NoRoom => "no room for the image",
            Self::Lengths => "a layer's parts do not have the lengths of its shape",
        })
    }
}

impl core::error::Error for WriteError {}

/// Output buffer that is filled from its front.
struct Room<'a> {
    bytes: &'a mut [u8],
    used: usize,
}

impl Room<'_> {
    fn put(&mut self, bytes: &[u8]) -> Result<(), WriteError> {
        let slot = self.bytes.get_mut(self.used..).and_then(|rest| rest.get_mut(..bytes.len()));
        slot.ok_or(WriteError::NoRoom)?.copy_from_slice(bytes);
        self.used += bytes.len();
        Ok(())
    }

    fn group<S: Storage>(&mut self, row: &[i16], group: usize) -> Result<(), WriteError> {
        let mut word = 0u32;
        for (tap, &weight) in row.iter().skip(group * S::TAPS).take(S::TAPS).enumerate() {
            S::put(&mut word, tap, weight);
        }
        self.put(&word.to_le_bytes())
    }

    /// Writes the outputs, in blocks of four while possible, each with its bias and multiplier if
    /// it has them.
    fn outputs<S: Storage>(
        &mut self,
        [biases, multipliers]: [&[i32]; 2],
        parts: &LayerParts<'_>,
    ) -> Result<(), WriteError> {
        let (shape, outputs) = (&parts.shape, parts.shape.outputs as usize);
        let mut first = 0;
        while first < outputs {
            let together = if outputs - first >= BLOCK { BLOCK } else { 1 };
            let own = first..first + together;
            self.put(bytemuck::cast_slice(biases.get(own.clone()).unwrap_or_default()))?;
            for group in 0..shape.groups() {
                for row in parts.weights.chunks(shape.taps()).skip(first).take(together) {
                    self.group::<S>(row, group)?;
                }
            }
            self.put(bytemuck::cast_slice(multipliers.get(own).unwrap_or_default()))?;
            first += together;
        }
        Ok(())
    }

    fn layer(&mut self, parts: &LayerParts<'_>) -> Result<(), WriteError> {
        let LayerParts { shape, biases, multipliers, scale, weights } = *parts;
        let outputs = shape.outputs as usize;
        let factors = if shape.kind == LayerKind::Convolution { outputs } else { 0 };
        if biases.len() != outputs || multipliers.len() != factors || weights.len() != outputs * shape.taps()
        {
            return Err(WriteError::Lengths);
        }
        self.put(&shape.to_bytes())?;
        let around = match shape.kind {
            LayerKind::Convolution => [biases, multipliers],
            LayerKind::Head => {
                self.put(&scale.multiplier.to_le_bytes())?;
                self.put(&scale.shift.to_le_bytes())?;
                self.put(bytemuck::cast_slice(biases))?;
                [&[][..]; 2]
            }
        };
        match (shape.form, shape.input_bits) {
            (WeightForm::Wide, _) => self.outputs::<Wide>(around, parts),
            (WeightForm::Packed, 8) => self.outputs::<Packed8>(around, parts),
            (WeightForm::Packed, _) => self.outputs::<Packed16>(around, parts),
        }
    }
}

/// Writes layers without header and checksum; returns their length in bytes.
pub fn layers(layers: &[LayerParts<'_>], out: &mut [u8]) -> Result<usize, WriteError> {
    let mut room = Room { bytes: out, used: 0 };
    for layer in layers {
        room.layer(layer)?;
    }
    Ok(room.used)
}

/// Returns the length in bytes of an image with layers of these shapes.
pub fn image_length<'s>(shapes: impl IntoIterator<Item = &'s LayerShape>) -> usize {
    HEADER_LENGTH + shapes.into_iter().map(LayerShape::length).sum::<usize>() + CRC_LENGTH
}

/// Writes a complete image, the layers of the collision network before those of the friction
/// network; returns its length in bytes. Nothing is proven here: load the image afterwards.
pub fn image(header: &Header, parts: &[LayerParts<'_>], out: &mut [u8]) -> Result<usize, WriteError> {
    let (head, rest) = out.split_first_chunk_mut::<HEADER_LENGTH>().ok_or(WriteError::NoRoom)?;
    let length = HEADER_LENGTH + layers(parts, rest)? + CRC_LENGTH;
    *head = header.to_bytes(u32::try_from(length).map_err(|_| WriteError::NoRoom)?);
    seal(out.get_mut(..length).ok_or(WriteError::NoRoom)?);
    Ok(length)
}

/// Writes the checksum of everything before it at the end of an image.
pub fn seal(image: &mut [u8]) {
    if let Some((body, sum)) = image.split_last_chunk_mut::<CRC_LENGTH>() {
        *sum = checksum(body).to_le_bytes();
    }
}
