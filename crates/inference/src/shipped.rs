//! Model images shipped with this crate: one for every bearing material.

use contact::BearingMaterial;

use crate::image::{CRC_LENGTH, HEADER_LENGTH, prove};

/// An image at an address that its weights can be read from.
#[repr(C, align(4))]
struct Aligned<T: ?Sized>(T);

/// Embeds the image of a material by its name.
macro_rules! image {
    ($name:literal) => {
        &Aligned(*include_bytes!(concat!("../models/", $name, ".pintle")))
    };
}

/// Images in the order of [`BearingMaterial::ALL`].
static IMAGES: [&Aligned<[u8]>; BearingMaterial::COUNT] = contact::embed_for_each_material!(image);

/// Returns the image of a material: both of its networks in one blob.
pub const fn shipped(material: BearingMaterial) -> &'static [u8] {
    &IMAGES[material as usize].0
}

/// Proves that no sum of a shipped network can overflow.
const _: () = {
    let mut materials: &[BearingMaterial] = &BearingMaterial::ALL;
    while let Some((material, others)) = materials.split_first() {
        assert!(is_proven(shipped(*material)));
        materials = others;
    }
};

const fn is_proven(image: &[u8]) -> bool {
    let Some((body, _)) = image.split_last_chunk::<CRC_LENGTH>() else { return false };
    let Some((_, networks)) = body.split_first_chunk::<HEADER_LENGTH>() else { return false };
    prove(networks).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Model;

    #[test]
    fn shipped_images_load_and_belong_to_their_material() {
        for material in BearingMaterial::ALL {
            let model: Model = Model::load(shipped(material)).expect("shipped image");
            assert_eq!(model.header().bearing, material);
        }
    }
}
