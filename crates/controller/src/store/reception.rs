//! The update in progress: its slot, its manifest and how much of it has been written.

use link::update::{Receiving, SignedManifest};
use model_package::Manifest;

use super::slot::Slot;

/// The update in progress.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reception {
    pub(super) slot: Slot,
    pub(super) signed: SignedManifest,
    pub(super) manifest: Manifest,
    /// Index of the key that signed it.
    pub(super) signer: usize,
    pub(super) next_offset: u32,
}

impl Reception {
    pub(super) const fn report(&self) -> Receiving {
        Receiving {
            version: self.manifest.version,
            next_offset: self.next_offset,
            length: self.manifest.length(),
        }
    }
}

/// Returns the version in an unchecked manifest.
pub(super) fn claimed_version(signed: &SignedManifest) -> u32 {
    signed
        .manifest
        .as_flattened()
        .get(12..16)
        .and_then(<[u8]>::first_chunk)
        .map_or(0, |b| u32::from_le_bytes(*b))
}
