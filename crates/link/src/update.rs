//! Messages that update the models over the link, with their units and limits.
//!
//! A package is a [`SignedManifest`] followed by the bytes that it describes
//! (`controller::store::package` defines their layout). The host sends requests, and the controller
//! answers each once. Every request may be repeated, and a repeated one changes nothing:
//!
//! * [`UpdateRequest::Status`] changes nothing. The answer is [`UpdateAnswer::Status`], as for the
//!   next four, which may also be refused.
//! * [`UpdateRequest::Begin`] checks manifest and signature. It erases the slot not in use, or
//!   resumes the same package. The status states the next offset.
//! * [`UpdateRequest::Chunk`] writes the bytes if they are the next. The status states the next
//!   offset, whether they were written or not.
//! * [`UpdateRequest::Finish`] checks everything, marks the slot and switches the networks. The
//!   status names the new model.
//! * [`UpdateRequest::Abort`] forgets the update. Written bytes stay, and the update can be
//!   resumed.
//! * [`UpdateRequest::Refusals`] changes nothing. The answer is [`UpdateAnswer::Record`].
//!
//! After a lost link or a reset the host begins again with the same manifest and resumes at the
//! offset in the answer. Beginning erases flash and takes up to four seconds on a board. The checks
//! take up to a tenth of a second, a chunk less than ten milliseconds.

use serde::{Deserialize, Serialize};

/// Length of a chunk in bytes. The last chunk of a package is padded with any bytes.
pub const CHUNK_LENGTH: usize = 128;
/// Length of a manifest in bytes.
pub const MANIFEST_LENGTH: usize = 96;
/// Length of a signature in bytes.
pub const SIGNATURE_LENGTH: usize = 64;
/// Number of refused packages on record: the last ones since the start.
pub const REFUSALS: usize = 8;

/// Manifest of a package with its ed25519 signature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SignedManifest {
    /// Manifest: version, board, lengths, and the hash of the bytes that follow it.
    pub manifest: [[u8; 32]; MANIFEST_LENGTH / 32],
    /// Signature over the manifest.
    pub signature: [[u8; 32]; SIGNATURE_LENGTH / 32],
}

/// Part of a package's bytes after the manifest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct UpdateChunk {
    /// Offset of the bytes: a multiple of [`CHUNK_LENGTH`], counted from the end of the signature.
    pub offset: u32,
    /// Bytes. In the last chunk those past the package's end are ignored.
    pub bytes: [[u8; 32]; CHUNK_LENGTH / 32],
}

/// Requests of the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum UpdateRequest {
    /// Returns the state of the update.
    Status,
    /// Announces a package.
    Begin(SignedManifest),
    /// Carries a part of the package.
    Chunk(UpdateChunk),
    /// Ends the package: check everything and switch.
    Finish,
    /// Gives up the update.
    Abort,
    /// Returns the record of a refused package.
    Refusals {
        /// Index of the record; 0 is the newest.
        index: u8,
    },
}

/// Answers of the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum UpdateAnswer {
    /// The request was served now or earlier.
    Status(UpdateStatus),
    /// The request was refused.
    Refused(UpdateRefusal),
    /// Requested record; `None` if there are fewer.
    Record(Option<RefusedPackage>),
}

/// Origin of the networks in use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ModelSource {
    /// Built into the firmware.
    #[default]
    BuiltIn,
    /// Model package of a slot.
    Slot {
        /// Number of the slot, 0 or 1.
        slot: u8,
        /// Version of the package.
        version: u32,
        /// First four bytes of the package's hash. They distinguish packages of one version.
        hash: [u8; 4],
    },
}

/// Kind of memory that holds the packages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ModelMemory {
    /// Flash: keeps its content without power.
    Flash,
    /// Memory that lasts until power-off: the emulator ignores writes to flash.
    #[default]
    Volatile,
}

/// Content of a slot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum SlotState {
    /// No package.
    #[default]
    Blank,
    /// Package that was begun and not finished.
    Unfinished,
    /// Complete package that passed every check.
    #[serde(rename = "Sound")]
    Valid {
        /// Version of the package.
        version: u32,
    },
    /// Complete package that was refused when the controller selected its models.
    Refused,
}

/// State of models and updates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct UpdateStatus {
    /// The networks in use.
    pub running: ModelSource,
    /// Memory of the slots.
    pub memory: ModelMemory,
    /// Maximum length of a package after the manifest, in bytes.
    pub capacity: u32,
    /// Update in progress, if any.
    pub receiving: Option<Receiving>,
    /// Number of packages refused since the start, at start-up or over the link.
    pub refused: u16,
    /// Number of times that the networks in use were found corrupted since the start.
    #[serde(rename = "altered")]
    pub corrupted: u16,
    /// `true` if the firmware trusts the published development key, which is for trials only.
    pub development_key: bool,
    /// Content of the slots.
    pub slots: [SlotState; 2],
    /// Last package refused.
    pub last_refusal: Option<RefusedPackage>,
    /// Minimum version of a package that is not signed to be older.
    pub min_version: u32,
    /// Number of keys that this controller trusts.
    pub trusted_keys: u8,
    /// Number of keys of this firmware that a package has revoked.
    pub revoked_keys: u8,
}

/// Update in progress.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Receiving {
    /// Version of the package.
    pub version: u32,
    /// Offset of the next chunk, in bytes.
    pub next_offset: u32,
    /// Length of the package after the manifest, in bytes.
    pub length: u32,
}

/// Record of a refused package.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RefusedPackage {
    /// Number of the refusal since the start, from 0.
    pub number: u16,
    /// Slot of the package; `None` if its manifest was refused.
    pub slot: Option<u8>,
    /// Version that the package claims; 0 without a manifest.
    pub version: u32,
    /// Reason of the refusal.
    pub reason: UpdateRefusal,
}

/// Flash operation that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FlashOperation {
    /// Set a sector to ones.
    Erase,
    /// Clear bits.
    Program,
    /// Read.
    Read,
    /// Read back what was programmed.
    ReadBack,
}

/// Reason why a package or a request was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum UpdateRefusal {
    /// The manifest has a wrong magic number.
    Magic,
    /// The manifest has another format.
    Format {
        /// Format found.
        found: u16,
        /// Format expected.
        expected: u16,
    },
    /// The package was made for another board.
    Board {
        /// Board that the package was made for.
        found: u16,
        /// Board of this controller.
        expected: u16,
    },
    /// The package is not newer than what runs, and not signed to be accepted anyway.
    Version {
        /// Version of the package.
        found: u32,
        /// Lowest accepted version.
        least: u32,
    },
    /// The signature does not match a public key of this firmware.
    Signature,
    /// The package is longer than a slot.
    TooLong {
        /// Length after the manifest, in bytes.
        found: u32,
        /// Maximum length, in bytes.
        most: u32,
    },
    /// The lengths of the parts are not those of a package, or it has no image.
    Lengths,
    /// There is no update to continue.
    NotBegun,
    /// Parts are missing.
    Unfinished {
        /// Offset of the next part.
        next_offset: u32,
    },
    /// The bytes do not match the signed hash.
    Hash,
    /// The firmware cannot run an image of the package.
    Image {
        /// Bearing code of the image.
        bearing: u8,
        /// Index of the cause in the inference crate's list of image errors; 100 means an image of
        /// another bearing.
        cause: u8,
    },
    /// The networks do not give the results that the package states.
    SelfTest {
        /// Bearing code of the image.
        bearing: u8,
        /// First sample with a different result.
        sample: u16,
    },
    /// The slot was begun but never marked as complete.
    NotMarked,
    /// A flash operation failed.
    Flash(FlashOperation),
    /// The core of this board halts while flash is written, so the run must be stopped first.
    Estimating,
    /// The controller has no memory for models.
    NoMemory,
    /// The package is signed with a key that has been revoked.
    Revoked,
    /// The version is far above the lowest accepted one, and would leave few for later packages.
    VersionTooHigh {
        /// Version of the package.
        found: u32,
        /// Maximum version.
        most: u32,
    },
    /// The controller has a key for its link, and no command has permitted this package.
    NotPermitted,
}

impl core::fmt::Display for UpdateRefusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Magic => f.write_str("the manifest is not that of a model package"),
            Self::Format { found, expected } => write!(f, "package format {found}, expected {expected}"),
            Self::Board { found, expected } => {
                write!(f, "made for board {found:#06x}, this is board {expected:#06x}")
            }
            Self::Version { found, least } => {
                write!(
                    f,
                    "version {found}; expected at least {least}: older packages are accepted only if \
                     signed as such"
                )
            }
            Self::Signature => f.write_str("not signed with a key that this firmware trusts"),
            Self::TooLong { found, most } => write!(f, "{found} bytes, expected at most {most}"),
            Self::Lengths => f.write_str("the lengths of its parts are not those of a package"),
            Self::NotBegun => f.write_str("no update was begun"),
            Self::Unfinished { next_offset } => write!(f, "bytes are missing from offset {next_offset}"),
            Self::Hash => f.write_str("the bytes are not those that were signed"),
            Self::Image { bearing, cause: 100 } => {
                write!(f, "the image for bearing {bearing} is for another one")
            }
            Self::Image { bearing, cause } => {
                write!(f, "the image for bearing {bearing} is refused, cause {cause}")
            }
            Self::SelfTest { bearing, sample } => {
                write!(f, "the networks for bearing {bearing} fail their self-test at sample {sample}")
            }
            Self::NotMarked => f.write_str("begun but never finished"),
            Self::Flash(operation) => write!(
                f,
                "the flash failed to {}",
                match operation {
                    FlashOperation::Erase => "erase",
                    FlashOperation::Program => "program",
                    FlashOperation::Read => "read",
                    FlashOperation::ReadBack => "keep what was programmed",
                }
            ),
            Self::Estimating => f.write_str(
                "a run is in progress, and the core of this board halts while flash is written; \
                 stop the run first",
            ),
            Self::NoMemory => f.write_str("the controller has no memory for models"),
            Self::Revoked => f.write_str("signed with a key that has been revoked"),
            Self::VersionTooHigh { found, most } => write!(f, "version {found}; expected at most {most}"),
            Self::NotPermitted => f.write_str("not permitted: the controller requires the key of its link"),
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
