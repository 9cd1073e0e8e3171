//! The two bearings that networks are shipped for, and their images.

use crate::image::{CRC_LENGTH, HEADER_LENGTH, prove};

/// Material of the bearing a network was trained for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Bearing {
    /// Babbitt alloy.
    Babbitt,
    /// Engineering plastic alloy.
    Plastic,
}

impl Bearing {
    /// Every bearing, in the order of their codes.
    pub const ALL: [Self; 2] = [Self::Babbitt, Self::Plastic];

    /// Lower-case name, as on the command line and in file names.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Babbitt => "babbitt",
            Self::Plastic => "plastic",
        }
    }

    /// Code of the bearing in model images and frames.
    pub const fn code(self) -> u8 {
        match self {
            Self::Babbitt => 0,
            Self::Plastic => 1,
        }
    }

    /// The bearing of a code, if there is one.
    pub const fn from_code(code: u8) -> Option<Self> {
        match code {
            0 => Some(Self::Babbitt),
            1 => Some(Self::Plastic),
            _ => None,
        }
    }
}

/// An image at an address that its weights can be read from.
#[repr(C, align(4))]
struct Aligned<T: ?Sized>(T);

static BABBITT: &Aligned<[u8]> = &Aligned(*include_bytes!("../models/babbitt.pintle"));
static PLASTIC: &Aligned<[u8]> = &Aligned(*include_bytes!("../models/plastic.pintle"));

/// The image shipped for a bearing: both of its networks in one blob.
pub fn shipped(bearing: Bearing) -> &'static [u8] {
    match bearing {
        Bearing::Babbitt => &BABBITT.0,
        Bearing::Plastic => &PLASTIC.0,
    }
}

/// No sum of a shipped network can overflow.
const _: () = {
    assert!(is_proven(include_bytes!("../models/babbitt.pintle")));
    assert!(is_proven(include_bytes!("../models/plastic.pintle")));
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
    fn codes_round_trip() {
        for bearing in Bearing::ALL {
            assert_eq!(Bearing::from_code(bearing.code()), Some(bearing));
        }
        assert_eq!(Bearing::from_code(2), None);
    }

    #[test]
    fn shipped_images_load_and_belong_to_their_bearing() {
        for bearing in Bearing::ALL {
            let model: Model = Model::load(shipped(bearing)).expect("shipped image");
            assert_eq!(model.header().bearing, bearing);
        }
    }
}
