//! Steps of an update into the slot that is not in use.

use link::update::{CHUNK_LENGTH, FlashOperation, SignedManifest, SlotState, UpdateChunk, UpdateRefusal};
use model_package::MAX_VERSION_STEP;

use super::memory::SlotMemory;
use super::models::Models;
use super::reception::{Reception, claimed_version};
use super::slot::{Marked, Slot};
use super::{Running, Store};

const CHUNK: u32 = CHUNK_LENGTH as u32;

impl<M: SlotMemory> Store<M> {
    /// Begins an update or resumes one after a lost link or a reset. `is_blocked` is true while the
    /// flash must not be written.
    pub(super) fn begin(&mut self, signed: &SignedManifest, is_blocked: bool) -> Result<(), UpdateRefusal> {
        if self.reception.is_some_and(|reception| reception.signed == *signed) || self.runs(signed) {
            return Ok(());
        }
        let (manifest, signer) =
            self.authenticate(signed).map_err(|reason| self.refuse(None, claimed_version(signed), reason))?;
        let slot = self.spare(signed);
        let [found, most] = [manifest.length(), slot.capacity()];
        let (version, least) = (manifest.version, self.trust.min_version());
        let highest = least.saturating_add(MAX_VERSION_STEP);
        let reason = if version > highest {
            Some(UpdateRefusal::VersionTooHigh { found: version, most: highest })
        } else if version < least && !manifest.may_be_older {
            Some(UpdateRefusal::Version { found: version, least })
        } else if most == 0 {
            Some(UpdateRefusal::NoMemory)
        } else if found > most {
            Some(UpdateRefusal::TooLong { found, most })
        } else {
            None
        };
        if let Some(reason) = reason {
            return Err(self.refuse(None, version, reason));
        }
        if is_blocked {
            return Err(UpdateRefusal::Estimating);
        }
        self.reception = None;
        self.note(slot, SlotState::Unfinished);
        // A complete package cannot be resumed: its mark cannot be programmed twice. Nor can any if
        // no word can: the last one may have been interrupted.
        let is_begun = !M::IS_WRITE_ONCE && slot.marked(&mut self.memory).is_none();
        let next_offset = if is_begun && slot.signed(&mut self.memory) == Some(*signed) {
            slot.written(&mut self.memory, found)
        } else {
            self.clear(slot, signed).map_err(|reason| self.refuse(Some(slot), version, reason))?;
            0
        };
        self.reception = Some(Reception { slot, signed: *signed, manifest, signer, next_offset });
        Ok(())
    }

    /// Writes a chunk if it is the next one. Any other changes nothing; the reply contains the
    /// expected offset.
    pub(super) fn chunk(&mut self, chunk: &UpdateChunk) -> Result<(), UpdateRefusal> {
        let Some(mut reception) = self.reception else { return Err(UpdateRefusal::NotBegun) };
        let left = reception.manifest.length().saturating_sub(chunk.offset);
        if chunk.offset != reception.next_offset || left == 0 {
            return Ok(());
        }
        let taken = left.min(CHUNK);
        let bytes = chunk.bytes.as_flattened().get(..taken as usize).unwrap_or_default();
        match reception.slot.write_payload(&mut self.memory, chunk.offset, bytes) {
            Ok(()) => {
                reception.next_offset = chunk.offset.saturating_add(taken);
                self.reception = Some(reception);
                Ok(())
            }
            Err(reason) => Err(self.give_up(&reception, reason)),
        }
    }

    /// Checks everything, marks the slot and returns the networks to use.
    pub(super) fn finish(&mut self) -> Result<Option<Models>, UpdateRefusal> {
        let Some(reception) = self.reception else {
            // Repeated request: the reply was lost.
            return if self.running.marked.is_some() { Ok(None) } else { Err(UpdateRefusal::NotBegun) };
        };
        if reception.next_offset < reception.manifest.length() {
            return Err(UpdateRefusal::Unfinished { next_offset: reception.next_offset });
        }
        let number = self.next_number();
        let models = reception
            .slot
            .load(&self.memory, &reception.manifest)
            .and_then(|models| reception.slot.mark(&mut self.memory, number).map(|()| models))
            .map_err(|reason| self.give_up(&reception, reason))?;
        self.reception = None;
        self.note(reception.slot, SlotState::Valid { version: reception.manifest.version });
        let marked = Marked { slot: reception.slot, number };
        self.running = Running { source: models.source(), marked: Some(marked) };
        if self.trust.accept(&reception.manifest, reception.signer, self.keys) {
            self.note_revoked(reception.slot);
        }
        Ok(Some(models))
    }

    /// Notes that the package in the other slot is signed with a revoked key, if it is.
    fn note_revoked(&mut self, installed: Slot) {
        for slot in Slot::both(&self.memory).into_iter().filter(|slot| *slot != installed) {
            let signed = slot.marked(&mut self.memory).and_then(|_| slot.signed(&mut self.memory));
            if signed.is_some_and(|signed| self.authenticate(&signed) == Err(UpdateRefusal::Revoked)) {
                self.note(slot, SlotState::Refused);
            }
        }
    }

    /// Refuses a package because the requirements of the installed ones cannot be kept.
    pub(crate) fn refuse_unkept(&mut self, signed: &SignedManifest) -> UpdateRefusal {
        self.refuse(None, claimed_version(signed), UpdateRefusal::Flash(FlashOperation::Program))
    }

    /// Ends an update that cannot be finished. The slot is erased, so that the next attempt does
    /// not resume corrupted content.
    fn give_up(&mut self, reception: &Reception, reason: UpdateRefusal) -> UpdateRefusal {
        self.reception = None;
        // If even that fails, the next attempt meets the same failure.
        if reception.slot.erase(&mut self.memory).is_ok() {
            self.note(reception.slot, SlotState::Blank);
        }
        self.refuse(Some(reception.slot), reception.manifest.version, reason)
    }

    fn clear(&mut self, slot: Slot, signed: &SignedManifest) -> Result<(), UpdateRefusal> {
        slot.erase(&mut self.memory)?;
        slot.write_signed(&mut self.memory, signed)
    }

    /// Returns a number above that of every valid slot.
    fn next_number(&mut self) -> u32 {
        let marked = Slot::both(&self.memory).map(|slot| slot.marked(&mut self.memory));
        marked.iter().flatten().map(|marked| marked.number).max().unwrap_or(0).saturating_add(1)
    }

    /// Decides whether this package is the running one.
    fn runs(&mut self, signed: &SignedManifest) -> bool {
        self.running.marked.is_some_and(|marked| marked.slot.signed(&mut self.memory) == Some(*signed))
    }

    /// Returns the slot to write: the one not in use; if neither is, the one in which this package
    /// was begun.
    fn spare(&mut self, signed: &SignedManifest) -> Slot {
        let [first, second] = Slot::both(&self.memory);
        match self.running.marked {
            Some(marked) if marked.slot == first => second,
            Some(_) => first,
            None if second.signed(&mut self.memory) == Some(*signed) => second,
            None => first,
        }
    }
}
