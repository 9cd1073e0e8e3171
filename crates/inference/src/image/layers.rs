//! Loading user-defined networks: layers without header and checksum, as [`super::write::layers`]
//! writes them.

use super::{ImageError, LayerName, Reader, Unproven, prove};

impl Unproven {
    /// Converts to the reason for refusing an image, with the layer's name.
    pub(crate) fn named(self, name: impl FnOnce(u8) -> LayerName) -> ImageError {
        match self {
            Self::Malformed { .. } => ImageError::TooShort,
            Self::Overflow { layer, output, largest } => {
                ImageError::Overflow { layer: name(layer), output, largest }
            }
            Self::Scale { layer } => ImageError::Scale { layer: name(layer) },
        }
    }
}

/// Layers that are read from their bytes.
pub trait ReadLayers<'a>: Sized {
    /// Reads the layers and checks their shapes against this type. `layer` names the first one.
    fn read(reader: &mut Reader<'a>, layer: LayerName) -> Result<Self, ImageError>;
}

/// Loads a network from the bytes of its layers and proves that none of its sums can overflow. The
/// bytes must be at an address divisible by 4. `network` names it in messages.
///
/// There is no checksum: the caller protects the bytes ([`super::checksum`]).
///
/// # Errors
///
/// The reason, for a layer whose shape differs from the type's, missing or additional bytes, or a
/// layer whose sums could overflow.
pub fn load_layers<'a, N: ReadLayers<'a>>(layers: &'a [u8], network: &'static str) -> Result<N, ImageError> {
    let mut reader = Reader::new(layers);
    let loaded = N::read(&mut reader, LayerName { network, index: 0 })?;
    if !reader.is_empty() {
        return Err(ImageError::Trailing);
    }
    prove(layers).map_err(|unproven| unproven.named(|index| LayerName { network, index }))?;
    Ok(loaded)
}
