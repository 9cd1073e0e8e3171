//! The manifest of a model package: what was signed.
//!
//! 96 bytes, whole numbers little-endian:
//!
//! | bytes | what |
//! |---|---|
//! | 0..8 | magic |
//! | 8..10 | format |
//! | 10..12 | board, see [`board`] |
//! | 12..16 | version of the model, from 1 on |
//! | 16..20 | bit 0: to be taken even when older than what runs; all others 0 |
//! | 20..24 | bytes behind manifest and signature |
//! | 24..28, 28..32 | bytes of the image for bearing 0 and 1; 0: none |
//! | 32..36, 36..40 | samples of the self-test for bearing 0 and 1 |
//! | 40..64 | 0 |
//! | 64..96 | SHA-512/256 of the bytes behind manifest and signature |
//!
//! The signature is over these bytes alone: through the hash it covers all the others. So it can be checked before anything is erased.

use link::update::{MANIFEST_LENGTH, UpdateRefusal};
use sha2::{Digest, Sha512_256};

use crate::self_test::RECORD_LENGTH;

/// Codes of the boards that packages are made for.
pub mod board {
    /// STM32F405: the boards and the emulator alike.
    pub const STM32F405: u16 = 0x0405;
    /// Arm MPS2+ with image AN505.
    pub const MPS2_AN505: u16 = 0x0505;
}

/// Magic of a package.
pub const MAGIC: [u8; 8] = *b"PINTLEP\n";
/// Version of the format.
pub const FORMAT: u16 = 1;
/// Samples that a self-test must have: as many as leave nothing of the networks' start.
pub const LEAST_SAMPLES: u32 = 2 * inference::WINDOW as u32;

const MAY_BE_OLDER: u32 = 1;

/// What a package says about itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Manifest {
    /// Board that it was made for.
    pub board: u16,
    /// Version of the model, from 1 on.
    pub version: u32,
    /// Whether it is to be taken even when older than what runs.
    pub may_be_older: bool,
    /// Bytes of the image by bearing code; 0: none.
    pub images: [u32; 2],
    /// Samples of the self-test by bearing code.
    pub samples: [u32; 2],
    /// SHA-512/256 of the payload.
    pub hash: [u8; 32],
}

/// Hash of a package's payload.
#[must_use]
pub fn hash_of(payload: &[u8]) -> [u8; 32] {
    Sha512_256::digest(payload).into()
}

impl Manifest {
    /// Bytes behind manifest and signature.
    #[must_use]
    pub const fn length(&self) -> u32 {
        let [first, second] = self.images;
        let [a, b] = self.samples;
        let samples = a.saturating_add(b).saturating_mul(RECORD_LENGTH as u32);
        first.saturating_add(second).saturating_add(samples)
    }

    /// The bytes that are signed.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; MANIFEST_LENGTH] {
        let mut bytes = [0; MANIFEST_LENGTH];
        let numbers = [
            self.version,
            u32::from(self.may_be_older),
            self.length(),
            self.images[0],
            self.images[1],
            self.samples[0],
            self.samples[1],
        ];
        let parts = MAGIC
            .into_iter()
            .chain(FORMAT.to_le_bytes())
            .chain(self.board.to_le_bytes())
            .chain(numbers.into_iter().flat_map(u32::to_le_bytes))
            .chain([0; 24])
            .chain(self.hash);
        for (to, from) in bytes.iter_mut().zip(parts) {
            *to = from;
        }
        bytes
    }

    /// Reads a manifest and checks what it says against itself and against the board.
    ///
    /// # Errors
    ///
    /// Of another kind, format or board; lengths that are not those of a package.
    pub fn parse(bytes: &[u8; MANIFEST_LENGTH], this_board: u16) -> Result<Self, UpdateRefusal> {
        let (words, _) = bytes.as_chunks::<4>();
        let &[magic_low, magic_high, kind, ref numbers @ ..] = words else {
            return Err(UpdateRefusal::Magic);
        };
        if [magic_low, magic_high].as_flattened() != MAGIC {
            return Err(UpdateRefusal::Magic);
        }
        let [format_low, format_high, board_low, board_high] = kind;
        let (format, board) =
            (u16::from_le_bytes([format_low, format_high]), u16::from_le_bytes([board_low, board_high]));
        if format != FORMAT {
            return Err(UpdateRefusal::Format { found: format, expected: FORMAT });
        }
        let &[version, flags, length, first, second, samples, more_samples, _, _, _, _, _, _, ref hash @ ..] =
            numbers
        else {
            return Err(UpdateRefusal::Magic);
        };
        let mut manifest = Self {
            board,
            version: u32::from_le_bytes(version),
            may_be_older: u32::from_le_bytes(flags) == MAY_BE_OLDER,
            images: [first, second].map(u32::from_le_bytes),
            samples: [samples, more_samples].map(u32::from_le_bytes),
            hash: [0; 32],
        };
        for (to, from) in manifest.hash.iter_mut().zip(hash.as_flattened()) {
            *to = *from;
        }
        if board != this_board {
            return Err(UpdateRefusal::Board { found: board, expected: this_board });
        }
        // Written back it must be the same: flags, length and reserved bytes are what they have to be. A sum that did not fit is odd.
        let sound = u32::from_le_bytes(length) == manifest.length()
            && manifest.length().is_multiple_of(4)
            && manifest.to_bytes() == *bytes
            && manifest.images.iter().any(|&bytes| bytes > 0)
            && manifest.images.iter().zip(manifest.samples).all(|(&bytes, samples)| {
                bytes.is_multiple_of(4) && if bytes > 0 { samples >= LEAST_SAMPLES } else { samples == 0 }
            });
        if sound { Ok(manifest) } else { Err(UpdateRefusal::Lengths) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manifest() -> Manifest {
        Manifest {
            board: board::STM32F405,
            version: 7,
            may_be_older: false,
            images: [8380, 0],
            samples: [32, 0],
            hash: hash_of(b"payload"),
        }
    }

    fn parse(manifest: &Manifest) -> Result<Manifest, UpdateRefusal> {
        Manifest::parse(&manifest.to_bytes(), board::STM32F405)
    }

    #[test]
    fn a_manifest_survives_its_bytes() {
        assert_eq!(parse(&manifest()), Ok(manifest()));
        let older = Manifest { may_be_older: true, ..manifest() };
        assert_eq!(parse(&older), Ok(older));
        assert_eq!(manifest().length(), 8380 + 32 * 32);
    }

    #[test]
    fn one_that_contradicts_itself_is_refused() {
        for wrong in [
            Manifest { images: [0, 0], samples: [0, 0], ..manifest() },
            Manifest { images: [8381, 0], ..manifest() },
            Manifest { samples: [LEAST_SAMPLES - 1, 0], ..manifest() },
            Manifest { samples: [32, 32], ..manifest() },
            Manifest { images: [u32::MAX - 3, u32::MAX - 3], samples: [u32::MAX; 2], ..manifest() },
        ] {
            assert_eq!(parse(&wrong), Err(UpdateRefusal::Lengths), "{wrong:?}");
        }
        assert_eq!(
            Manifest::parse(&manifest().to_bytes(), 1),
            Err(UpdateRefusal::Board { found: board::STM32F405, expected: 1 })
        );
    }

    #[test]
    fn every_bit_outside_the_hash_and_the_version_is_checked() {
        let bytes = manifest().to_bytes();
        for bit in (0..64 * 8).filter(|bit| !(12 * 8..16 * 8).contains(bit)) {
            let mut altered = bytes;
            altered[bit / 8] ^= 1 << (bit % 8);
            // The one flag has a meaning of its own.
            let read = Manifest::parse(&altered, board::STM32F405);
            assert_eq!(read.is_ok(), bit == 16 * 8, "bit {bit}");
        }
    }
}
