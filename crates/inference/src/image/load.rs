//! Loading a network of one's own: layers without header and check sum, as [`super::write::layers`] writes them.

use super::{LayerName, Reader, Unproven, prove};
use crate::activation::Activation;
use crate::chain::Chain;
use crate::error::ImageError;

impl Unproven {
    /// The reason for refusing an image, with the layer's name.
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

/// Takes a network from the bytes of its layers, which must lie at an address divisible by 4, and proves that none of its sums
/// can overflow. `network` names it in messages.
///
/// Refused, with the reason: a layer of another shape than the type's, missing or further bytes, a layer whose sums could
/// overflow. There is no check sum: whoever stores the bytes sees to that ([`super::check_sum`]).
pub fn load<'a, N: Chain<'a, A, IN>, A: Activation, const IN: usize>(
    layers: &'a [u8],
    network: &'static str,
) -> Result<N, ImageError> {
    let mut reader = Reader::new(layers);
    let chain = N::read(&mut reader, LayerName { network, index: 0 })?;
    if !reader.is_empty() {
        return Err(ImageError::Trailing);
    }
    prove(layers).map_err(|unproven| unproven.named(|index| LayerName { network, index }))?;
    Ok(chain)
}
