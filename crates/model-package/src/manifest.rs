//! Manifest of a model package: the part that is signed.
//!
//! 96 bytes, integers little-endian:
//!
//! | bytes | content |
//! |---|---|
//! | 0..8 | magic |
//! | 8..10 | format |
//! | 10..12 | board, see [`board`] |
//! | 12..16 | version of the model, from 1 on |
//! | 16..20 | bit 0: accepted even if older than the running package; bit 1: revokes older keys |
//! | 20..24 | bytes after manifest and signature |
//! | 24..28, 28..32 | bytes of the image for bearing 0 and 1; 0: none |
//! | 32..36, 36..40 | samples of the self-test for bearing 0 and 1 |
//! | 40..64 | image and samples of bearings 2, 3 and 4, 8 bytes each; unused: 0 |
//! | 64..96 | SHA-512/256 of the bytes after manifest and signature |
//!
//! The signature covers these bytes directly and all others through the hash. So it can be checked
//! before anything is erased.

use inference::BearingMaterial;
use link::update::{MANIFEST_LENGTH, UpdateRefusal};
use sha2::{Digest, Sha512_256};

use crate::self_test::RECORD_LENGTH;

/// Boards for which packages are made.
pub mod board {
    /// Code of [`ALL`]'s entry for the STM32F405.
    pub const STM32F405: u16 = 0x0405;
    /// Code of [`ALL`]'s entry for the STM32H743.
    pub const STM32H743: u16 = 0x0743;
    /// Code of [`ALL`]'s entry for the MPS2+.
    pub const MPS2_AN505: u16 = 0x0505;

    /// Boards that share their packages.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Board {
        /// Code in a manifest.
        pub code: u16,
        /// Name on the command line: the feature of the crate `firmware`.
        pub name: &'static str,
        /// Description.
        pub title: &'static str,
    }

    /// Every board; the first one is the default.
    pub const ALL: [Board; 3] = [
        Board {
            code: STM32F405,
            name: "stm32f405",
            title: "STM32F405: all boards with it, and the emulator",
        },
        Board { code: STM32H743, name: "stm32h743", title: "STM32H743: all boards with it" },
        Board { code: MPS2_AN505, name: "mps2-an505", title: "Arm MPS2+ with image AN505" },
    ];
}

/// Magic of a package.
const MAGIC: [u8; 8] = *b"PINTLEP\n";
/// Version of the format.
const FORMAT: u16 = 1;
/// Minimum number of self-test samples: enough that the result no longer depends on the networks'
/// start.
pub const MIN_SAMPLES: u32 = 2 * inference::WINDOW as u32;

/// Maximum step from the lowest accepted version: a date of eight digits can be a version. A
/// version shuts out all lower ones, so no single package must leave few higher ones.
pub const MAX_VERSION_STEP: u32 = 100_000_000;
/// Maximum version that a package is made with.
pub const MAX_VERSION: u32 = u32::MAX - MAX_VERSION_STEP;

const MAY_BE_OLDER: u32 = 1;
const REVOKES_OLDER_KEYS: u32 = 1 << 1;

/// Words for image lengths and numbers of samples.
const PART_WORDS: usize = 10;
const _: () = assert!(2 * BearingMaterial::COUNT <= PART_WORDS);

/// Returns the places of an image's length and of its number of samples among these words.
///
/// The first format had two bearings: two lengths, then two numbers of samples. Later bearings have
/// both words side by side.
const fn part_words(code: usize) -> [usize; 2] {
    if code < 2 { [code, code + 2] } else { [2 * code, 2 * code + 1] }
}

/// Contents of a manifest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Manifest {
    /// Code of the board.
    pub board: u16,
    /// Version of the model, 1 or more.
    pub version: u32,
    /// True if the package is accepted even if it is older than the running one.
    pub may_be_older: bool,
    /// True if the controller, once the package is installed, no longer trusts the keys that its
    /// firmware lists before the one that signed it.
    pub revokes_older_keys: bool,
    /// Bytes of the image by bearing code; 0 if there is none.
    pub images: [u32; BearingMaterial::COUNT],
    /// Number of self-test samples by bearing code.
    pub samples: [u32; BearingMaterial::COUNT],
    /// SHA-512/256 of the payload.
    pub hash: [u8; 32],
}

/// Returns the hash of a package's payload.
#[must_use]
pub fn hash_of(payload: &[u8]) -> [u8; 32] {
    Sha512_256::digest(payload).into()
}

impl Manifest {
    /// Number of bytes after manifest and signature.
    #[must_use]
    pub const fn length(&self) -> u32 {
        let (mut length, mut code) = (0_u32, 0);
        while code < BearingMaterial::COUNT {
            let records = self.samples[code].saturating_mul(RECORD_LENGTH as u32);
            length = length.saturating_add(self.images[code]).saturating_add(records);
            code += 1;
        }
        length
    }

    /// Image lengths and numbers of samples in the order of the manifest's bytes.
    fn parts(&self) -> [u32; PART_WORDS] {
        let mut words = [0; PART_WORDS];
        for (code, counts) in self.images.into_iter().zip(self.samples).enumerate() {
            for (place, count) in part_words(code).into_iter().zip(<[u32; 2]>::from(counts)) {
                if let Some(word) = words.get_mut(place) {
                    *word = count;
                }
            }
        }
        words
    }

    /// Returns the bytes that are signed.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; MANIFEST_LENGTH] {
        let mut bytes = [0; MANIFEST_LENGTH];
        let flag = |is_set: bool, bit: u32| if is_set { bit } else { 0 };
        let flags = flag(self.may_be_older, MAY_BE_OLDER) | flag(self.revokes_older_keys, REVOKES_OLDER_KEYS);
        let numbers = [self.version, flags, self.length()];
        let parts = MAGIC
            .into_iter()
            .chain(FORMAT.to_le_bytes())
            .chain(self.board.to_le_bytes())
            .chain(numbers.into_iter().chain(self.parts()).flat_map(u32::to_le_bytes))
            .chain(self.hash);
        for (to, from) in bytes.iter_mut().zip(parts) {
            *to = from;
        }
        bytes
    }

    /// Parses a manifest and checks its consistency and its board.
    ///
    /// # Errors
    ///
    /// The reason: another kind, format or board, or lengths that no package has.
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
        let &[version, flags, length, ref rest @ ..] = numbers else { return Err(UpdateRefusal::Magic) };
        let Some((parts, hash)) = rest.split_first_chunk::<PART_WORDS>() else {
            return Err(UpdateRefusal::Magic);
        };
        let count = |place: usize| parts.get(place).map_or(0, |&word| u32::from_le_bytes(word));
        let mut manifest = Self {
            board,
            version: u32::from_le_bytes(version),
            may_be_older: u32::from_le_bytes(flags) & MAY_BE_OLDER != 0,
            revokes_older_keys: u32::from_le_bytes(flags) & REVOKES_OLDER_KEYS != 0,
            images: core::array::from_fn(|code| count(part_words(code)[0])),
            samples: core::array::from_fn(|code| count(part_words(code)[1])),
            hash: [0; 32],
        };
        for (to, from) in manifest.hash.iter_mut().zip(hash.as_flattened()) {
            *to = *from;
        }
        if board != this_board {
            return Err(UpdateRefusal::Board { found: board, expected: this_board });
        }
        // Serialised again it must be the same: that checks flags, length and reserved bytes. A
        // length that overflowed is odd.
        let is_consistent = u32::from_le_bytes(length) == manifest.length()
            && manifest.length().is_multiple_of(4)
            && manifest.to_bytes() == *bytes
            && manifest.images.iter().any(|&bytes| bytes > 0)
            && manifest.images.iter().zip(manifest.samples).all(|(&bytes, samples)| {
                bytes.is_multiple_of(4) && if bytes > 0 { samples >= MIN_SAMPLES } else { samples == 0 }
            });
        if is_consistent { Ok(manifest) } else { Err(UpdateRefusal::Lengths) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A value for the first bearing, 0 for the others.
    fn first_only(value: u32) -> [u32; BearingMaterial::COUNT] {
        std::array::from_fn(|code| if code == 0 { value } else { 0 })
    }

    fn manifest() -> Manifest {
        Manifest {
            board: board::STM32F405,
            version: 7,
            may_be_older: false,
            revokes_older_keys: false,
            images: first_only(8380),
            samples: first_only(32),
            hash: hash_of(b"payload"),
        }
    }

    fn parse(manifest: &Manifest) -> Result<Manifest, UpdateRefusal> {
        Manifest::parse(&manifest.to_bytes(), board::STM32F405)
    }

    #[test]
    fn a_manifest_survives_its_bytes() {
        assert_eq!(parse(&manifest()), Ok(manifest()));
        let older = Manifest { may_be_older: true, revokes_older_keys: true, ..manifest() };
        assert_eq!(parse(&older), Ok(older));
        assert_eq!(manifest().length(), 8380 + 32 * 32);
    }

    #[test]
    fn wrong_lengths_and_foreign_boards_are_refused() {
        for wrong in [
            Manifest { images: first_only(0), samples: first_only(0), ..manifest() },
            Manifest { images: first_only(8381), ..manifest() },
            Manifest { samples: first_only(MIN_SAMPLES - 1), ..manifest() },
            Manifest { samples: [32; BearingMaterial::COUNT], ..manifest() },
            Manifest {
                images: [u32::MAX - 3; BearingMaterial::COUNT],
                samples: [u32::MAX; BearingMaterial::COUNT],
                ..manifest()
            },
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
            let mut corrupted = bytes;
            corrupted[bit / 8] ^= 1 << (bit % 8);
            // The defined flags are valid.
            let read = Manifest::parse(&corrupted, board::STM32F405);
            assert_eq!(read.is_ok(), (16 * 8..16 * 8 + 2).contains(&bit), "bit {bit}");
        }
    }
}
