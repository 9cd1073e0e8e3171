//! Layout of a slot and its validity.
//!
//! | bytes | content | written |
//! |---|---|---|
//! | 0..96 | manifest | when the update begins |
//! | 96..160 | signature | when the update begins |
//! | 160..164 | number of the installation, counting up | third to last |
//! | 164..168 | its complement | second to last |
//! | 168..172 | the mark | last |
//! | 256.. | payload | chunk by chunk, in order |
//!
//! The payload contains the images by bearing code, then the self-tests by bearing code. A flash
//! word that is not full is padded with ones.
//!
//! A slot is valid if the mark follows a number and its complement. The flash words are programmed
//! in order, so after a loss of power the mark is either complete or invalid. With words of 32
//! bytes, all three are in one word. The newest slot has the largest number, not the largest
//! version: a package may be signed to replace a newer one.

use link::update::{
    CHUNK_LENGTH, FlashOperation, MANIFEST_LENGTH, ModelSource, SIGNATURE_LENGTH, SignedManifest,
    UpdateRefusal,
};

use model_package::{Manifest, check};

use super::memory::SlotMemory;
use super::models::Models;

/// Offset of the payload.
pub const PAYLOAD: u32 = 256;
const SIGNED: usize = MANIFEST_LENGTH + SIGNATURE_LENGTH;
const CHUNK: u32 = CHUNK_LENGTH as u32;
/// Value of an erased byte.
const BLANK: u8 = 0xFF;
const MARK: u32 = 0x5A17_C0DE;
/// Bytes of number, complement and mark.
const MARK_LENGTH: usize = 12;
/// Longest flash word, bytes. Manifest, signature and chunks are multiples of it.
const MAX_WORD: usize = 32;
const _: () = assert!(SIGNED.is_multiple_of(MAX_WORD) && CHUNK_LENGTH.is_multiple_of(MAX_WORD));

/// A slot in a slot memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Slot {
    pub(super) index: u8,
    start: u32,
    length: u32,
}

/// A slot with a valid mark.
#[derive(Clone, Copy, Debug)]
pub(super) struct Marked {
    pub(super) slot: Slot,
    pub(super) number: u32,
}

impl Slot {
    pub(super) fn both(memory: &impl SlotMemory) -> [Self; 2] {
        let length = u32::try_from(memory.capacity() / 2).unwrap_or(0);
        [Self { index: 0, start: 0, length }, Self { index: 1, start: length, length }]
    }

    /// Longest payload, bytes.
    pub(super) const fn capacity(self) -> u32 {
        self.length.saturating_sub(PAYLOAD)
    }

    fn read<const N: usize>(self, memory: &mut impl SlotMemory, offset: u32) -> Option<[u8; N]> {
        let end = offset.saturating_add(u32::try_from(N).unwrap_or(u32::MAX));
        let mut bytes = [0; N];
        let read = end <= self.length && memory.read(self.start.saturating_add(offset), &mut bytes).is_ok();
        read.then_some(bytes)
    }

    /// Returns manifest and signature as programmed.
    pub(super) fn signed(self, memory: &mut impl SlotMemory) -> Option<SignedManifest> {
        let bytes: [u8; SIGNED] = self.read(memory, 0)?;
        let &[a, b, c, d, e] = bytes.as_chunks::<32>().0 else { return None };
        Some(SignedManifest { manifest: [a, b, c], signature: [d, e] })
    }

    /// Decides whether manifest and mark are erased.
    pub(super) fn is_blank(self, memory: &mut impl SlotMemory) -> bool {
        self.read::<{ PAYLOAD as usize }>(memory, 0).is_some_and(|bytes| bytes.iter().all(|&b| b == BLANK))
    }

    pub(super) fn marked(self, memory: &mut impl SlotMemory) -> Option<Marked> {
        let bytes: [u8; 12] = self.read(memory, SIGNED as u32)?;
        let &[number, complement, mark] = bytes.as_chunks::<4>().0 else { return None };
        let number = u32::from_le_bytes(number);
        let is_complete = number == !u32::from_le_bytes(complement) && u32::from_le_bytes(mark) == MARK;
        is_complete.then_some(Marked { slot: self, number })
    }

    pub(super) fn erase(self, memory: &mut impl SlotMemory) -> Result<(), UpdateRefusal> {
        let end = self.start.saturating_add(self.length);
        memory.erase(self.start, end).map_err(|_| UpdateRefusal::Flash(FlashOperation::Erase))
    }

    /// Programs bytes and reads them back.
    fn program(self, memory: &mut impl SlotMemory, offset: u32, bytes: &[u8]) -> Result<(), UpdateRefusal> {
        let failed = |operation| Err(UpdateRefusal::Flash(operation));
        let end = u32::try_from(bytes.len()).unwrap_or(u32::MAX).saturating_add(offset);
        if end > self.length || memory.write(self.start.saturating_add(offset), bytes).is_err() {
            return failed(FlashOperation::Program);
        }
        for (offset, word) in (offset..end).step_by(4).zip(bytes.as_chunks::<4>().0) {
            if self.read(memory, offset) != Some(*word) {
                return failed(FlashOperation::ReadBack);
            }
        }
        Ok(())
    }

    pub(super) fn write_signed(
        self,
        memory: &mut impl SlotMemory,
        signed: &SignedManifest,
    ) -> Result<(), UpdateRefusal> {
        self.program(memory, 0, signed.manifest.as_flattened())?;
        self.program(memory, MANIFEST_LENGTH as u32, signed.signature.as_flattened())
    }

    /// Programs complete flash words of the payload. The last one is padded.
    pub(super) fn write_payload<M: SlotMemory>(
        self,
        memory: &mut M,
        offset: u32,
        bytes: &[u8],
    ) -> Result<(), UpdateRefusal> {
        let offset = PAYLOAD.saturating_add(offset);
        let rest = bytes.len() % M::WRITE_SIZE;
        let (complete, rest) = bytes.split_at_checked(bytes.len().saturating_sub(rest)).unwrap_or_default();
        if !complete.is_empty() {
            self.program(memory, offset, complete)?;
        }
        if rest.is_empty() {
            return Ok(());
        }
        let mut word = [BLANK; MAX_WORD];
        for (to, from) in word.iter_mut().zip(rest) {
            *to = *from;
        }
        let offset = offset.saturating_add(u32::try_from(complete.len()).unwrap_or(u32::MAX));
        self.program(memory, offset, word.get(..M::WRITE_SIZE).unwrap_or_default())
    }

    /// Makes the slot valid, flash word by flash word.
    pub(super) fn mark<M: SlotMemory>(self, memory: &mut M, number: u32) -> Result<(), UpdateRefusal> {
        let mut bytes = [BLANK; MAX_WORD];
        for (to, from) in bytes.iter_mut().zip([number, !number, MARK].map(u32::to_le_bytes).as_flattened()) {
            *to = *from;
        }
        let length = MARK_LENGTH.div_ceil(M::WRITE_SIZE).saturating_mul(M::WRITE_SIZE);
        let words = bytes.get(..length).unwrap_or_default().chunks(M::WRITE_SIZE);
        for (offset, word) in (SIGNED as u32..PAYLOAD).step_by(M::WRITE_SIZE).zip(words) {
            self.program(memory, offset, word)?;
        }
        Ok(())
    }

    /// Returns the length of the payload that is certainly programmed. Chunks are programmed in
    /// order, so this is everything before the last one that is not blank. That one may have been
    /// interrupted; programming it again completes it.
    pub(super) fn written(self, memory: &mut impl SlotMemory, length: u32) -> u32 {
        let used = |offset: &u32| {
            self.read::<4>(memory, PAYLOAD.saturating_add(*offset)).is_some_and(|word| word != [BLANK; 4])
        };
        let last = (0..length).step_by(4).rev().find(used).unwrap_or(0);
        last.checked_div(CHUNK).unwrap_or(0).saturating_mul(CHUNK)
    }

    /// Checks the payload against its manifest, whose signature has been checked: hash, images,
    /// self-tests.
    pub(super) fn load(self, memory: &impl SlotMemory, manifest: &Manifest) -> Result<Models, UpdateRefusal> {
        let length = manifest.length();
        if length > self.capacity() {
            return Err(UpdateRefusal::TooLong { found: length, most: self.capacity() });
        }
        let payload = memory.in_place(self.start.saturating_add(PAYLOAD), length);
        let package = check(manifest, payload)?;
        let [a, b, c, d, ..] = manifest.hash;
        let source = ModelSource::Slot { slot: self.index, version: manifest.version, hash: [a, b, c, d] };
        Ok(Models::of_package(package, source))
    }
}
