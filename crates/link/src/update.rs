//! The update of the model over the link: its messages, their units and limits.
//!
//! A package is a [`SignedManifest`] and the bytes that it speaks of (`firmware::store::package` tells how they are made up). The host asks, the
//! controller answers each request once; every request may be repeated, and a repeated one changes nothing:
//!
//! | request | does | answer |
//! |---|---|---|
//! | [`UpdateRequest::Status`] | nothing | [`UpdateAnswer::Status`] |
//! | [`UpdateRequest::Begin`] | checks the manifest and its signature; erases the slot not in use, or goes on where the same package was left | status with the next offset, or a refusal |
//! | [`UpdateRequest::Chunk`] | writes the bytes if they are the next | status with the next offset, whether they were written or not |
//! | [`UpdateRequest::Finish`] | checks everything, marks the slot, switches the networks | status that names the new model, or a refusal |
//! | [`UpdateRequest::Abort`] | forgets the update begun; what is written stays and can be gone on with | status |
//! | [`UpdateRequest::Refusals`] | nothing | [`UpdateAnswer::Record`] |
//!
//! After a lost link or a reset the host begins again with the same manifest and goes on from the offset in the answer. Beginning erases flash
//! and so takes up to four seconds on a board, the checks up to a tenth of a second; chunks take less than ten milliseconds.

use serde::{Deserialize, Serialize};

/// Bytes of a chunk; the last one of a package is filled up with anything.
pub const CHUNK_LENGTH: usize = 128;
/// Bytes of a manifest.
pub const MANIFEST_LENGTH: usize = 96;
/// Bytes of a signature.
pub const SIGNATURE_LENGTH: usize = 64;
/// Records of refused packages that the controller keeps: the last ones since it started.
pub const REFUSALS: usize = 8;

/// A package's manifest and the ed25519 signature over it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SignedManifest {
    /// The manifest: version, board, lengths and the hash of the bytes that follow it.
    pub manifest: [[u8; 32]; MANIFEST_LENGTH / 32],
    /// The signature.
    pub signature: [[u8; 32]; SIGNATURE_LENGTH / 32],
}

/// A part of a package's bytes behind the manifest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct UpdateChunk {
    /// Where the bytes belong: a multiple of [`CHUNK_LENGTH`], counted from the end of manifest and signature.
    pub offset: u32,
    /// The bytes; of the last chunk those past the package's end are ignored.
    pub bytes: [[u8; 32]; CHUNK_LENGTH / 32],
}

/// What the host asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum UpdateRequest {
    /// How things stand.
    Status,
    /// A package is to come.
    Begin(SignedManifest),
    /// A part of it.
    Chunk(UpdateChunk),
    /// All parts are there: check and switch.
    Finish,
    /// The update is given up.
    Abort,
    /// A record of a refused package.
    Refusals {
        /// 0 is the newest.
        index: u8,
    },
}

/// What the controller answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum UpdateAnswer {
    /// The request was served, or had been before.
    Status(UpdateStatus),
    /// It was not.
    Refused(UpdateRefusal),
    /// The record asked for; none if there are not so many.
    Record(Option<RefusedPackage>),
}

/// Where the networks in use come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ModelSource {
    /// Built into the firmware.
    #[default]
    BuiltIn,
    /// From a slot.
    Slot {
        /// 0 or 1.
        slot: u8,
        /// The package's version.
        version: u32,
        /// First four bytes of the package's hash: tells it from another one of the same version.
        hash: [u8; 4],
    },
}

/// What the packages are kept in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ModelMemory {
    /// Flash: kept without power.
    Flash,
    /// Memory that lasts until the power is switched off: the emulator, which ignores stores to flash.
    #[default]
    Volatile,
}

/// What a slot holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum SlotState {
    /// Nothing.
    #[default]
    Blank,
    /// A package that was begun and not finished.
    Unfinished,
    /// A whole one that passed every check.
    Sound {
        /// Its version.
        version: u32,
    },
    /// A whole one that was refused when the controller looked for its models.
    Refused,
}

/// How an update stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct UpdateStatus {
    /// The networks in use.
    pub running: ModelSource,
    /// What the slots are made of.
    pub memory: ModelMemory,
    /// Longest package that fits, bytes behind the manifest.
    pub capacity: u32,
    /// The update begun, if one is.
    pub receiving: Option<Receiving>,
    /// Packages refused since the controller started, at start-up or over the link.
    pub refused: u16,
    /// Times that the networks in use were found altered since the controller started.
    pub altered: u16,
    /// Whether the firmware trusts the published development key: good for trying, for nothing else.
    pub development_key: bool,
    /// The slots.
    pub slots: [SlotState; 2],
    /// The package refused last.
    pub last_refusal: Option<RefusedPackage>,
}

/// An update that has begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Receiving {
    /// The package's version.
    pub version: u32,
    /// Where the next chunk belongs, bytes.
    pub next_offset: u32,
    /// Bytes of the package behind the manifest.
    pub length: u32,
}

/// A package that was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RefusedPackage {
    /// Counts refusals since the controller started, from 0.
    pub number: u16,
    /// The slot that it lay in; none if its manifest was already refused.
    pub slot: Option<u8>,
    /// Version that it claims; 0 if it has no manifest.
    pub version: u32,
    /// Why.
    pub reason: UpdateRefusal,
}

/// Which of a flash memory's operations failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FlashOperation {
    /// Setting a sector to ones.
    Erase,
    /// Clearing bits.
    Program,
    /// Reading.
    Read,
    /// What was read is not what was programmed.
    ReadBack,
}

/// Why a package, or a request, was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum UpdateRefusal {
    /// The manifest does not begin like one.
    Magic,
    /// The manifest's format is another one.
    Format {
        /// Found.
        found: u16,
        /// Expected.
        expected: u16,
    },
    /// Made for another board.
    Board {
        /// The board it was made for.
        found: u16,
        /// This one.
        expected: u16,
    },
    /// Not newer than what runs, and not signed to be taken all the same.
    Version {
        /// The package's.
        found: u32,
        /// The least that would be taken.
        least: u32,
    },
    /// Not signed with the key whose other half this firmware holds.
    Signature,
    /// Longer than a slot.
    TooLong {
        /// Bytes behind the manifest.
        found: u32,
        /// Bytes that fit.
        most: u32,
    },
    /// The lengths of its parts are not those of a package, or there is no image in it.
    Lengths,
    /// There is no update to go on with.
    NotBegun,
    /// Parts are missing.
    Unfinished {
        /// Where the next one belongs.
        next_offset: u32,
    },
    /// The bytes are not those that were signed.
    Hash,
    /// An image is not one that this firmware runs.
    Image {
        /// Bearing code of the image.
        bearing: u8,
        /// Position of the cause in the inference crate's list of image errors; 100 is an image of another bearing.
        cause: u8,
    },
    /// The networks do not give what the package says that they give.
    SelfTest {
        /// Bearing code of the image.
        bearing: u8,
        /// First sample with another result.
        sample: u16,
    },
    /// The slot was begun but never marked as whole.
    NotMarked,
    /// The flash did not do what it was told.
    Flash(FlashOperation),
    /// This board's core stands still while its flash is written: the run has to be stopped before.
    Estimating,
    /// The controller has nowhere to keep a model.
    NoMemory,
}

impl core::fmt::Display for UpdateRefusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Magic => f.write_str("the manifest is not that of a model package"),
            Self::Format { found, expected } => write!(f, "package format {found}, expected {expected}"),
            Self::Board { found, expected } => write!(f, "made for board {found:#06x}, this is board {expected:#06x}"),
            Self::Version { found, least } => {
                write!(f, "version {found}, expected at least {least}: older packages are taken only when signed as such")
            }
            Self::Signature => f.write_str("not signed with the key that this firmware trusts"),
            Self::TooLong { found, most } => write!(f, "{found} bytes, expected at most {most}"),
            Self::Lengths => f.write_str("the lengths of its parts are not those of a package"),
            Self::NotBegun => f.write_str("no update was begun"),
            Self::Unfinished { next_offset } => write!(f, "bytes are missing from offset {next_offset}"),
            Self::Hash => f.write_str("the bytes are not those that were signed"),
            Self::Image { bearing, cause: 100 } => write!(f, "the image for bearing {bearing} is for another one"),
            Self::Image { bearing, cause } => write!(f, "the image for bearing {bearing} is refused, cause {cause}"),
            Self::SelfTest { bearing, sample } => {
                write!(f, "the networks for bearing {bearing} fail their self-test at sample {sample}")
            }
            Self::NotMarked => f.write_str("begun but never finished"),
            Self::Flash(operation) => write!(f, "the flash failed to {}", match operation {
                FlashOperation::Erase => "erase",
                FlashOperation::Program => "program",
                FlashOperation::Read => "read",
                FlashOperation::ReadBack => "keep what was programmed",
            }),
            Self::Estimating => f.write_str("a run is going on, and this board's core stands still while its flash is written; stop the run first"),
            Self::NoMemory => f.write_str("the controller has nowhere to keep a model"),
        }
    }
}

impl core::error::Error for UpdateRefusal {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MAX_FRAME, encode};

    #[test]
    fn the_longest_request_fits_into_a_frame_with_a_variant_before_it() {
        let begin =
            UpdateRequest::Begin(SignedManifest { manifest: [[0; 32]; 3], signature: [[255; 32]; 2] });
        let chunk = UpdateRequest::Chunk(UpdateChunk { offset: u32::MAX, bytes: [[0; 32]; 4] });
        for request in [begin, chunk] {
            assert!(encode(&(0_u8, request), &mut [0; MAX_FRAME]).is_ok());
        }
    }
}
