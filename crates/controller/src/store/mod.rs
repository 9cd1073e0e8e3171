//! Models beside the firmware: two slots, the update over the link, the choice at a start.
//!
//! A package ([`model_package`]) holds the images of one or both bearings and a self-test for each,
//! under one ed25519 signature. [`Store::start`] takes the newest slot that is complete, signed for
//! this board and passes its self-test; else the other slot; else the built-in images. An update is
//! written in chunks to the slot that is not in use. It becomes valid when everything in it has
//! been checked and its mark is programmed as the last word. So after a loss of power at any moment
//! there is a model that runs. Refused packages are recorded with the reason.
//!
//! Nothing here waits or runs in a tick: the link service handles the requests and passes new
//! networks to the session between two samples. On the STM32F405 the core stalls while its flash is
//! written, and on the STM32H743 the interrupts wait; there an update requires that the run is
//! stopped ([`UpdateRefusal::Estimating`]).
//!
//! A package must be newer than every one that was ever installed, unless it is signed with
//! permission to be older, and its key must not have been revoked ([`Trust`]). A package with this
//! permission can be installed repeatedly; the link does not authenticate its user.

pub mod controller;
pub mod keeper;
pub mod key;
mod memory;
mod models;
mod receive;
mod reception;
mod refusals;
mod scrub;
mod slot;
mod trust;

use link::update::{
    FlashOperation, ModelSource, SignedManifest, SlotState, UpdateAnswer, UpdateRefusal, UpdateRequest,
    UpdateStatus,
};

pub use keeper::Keeper;
pub use memory::SlotMemory;
pub use models::{Loaded, Models};
use refusals::Refusals;
pub(crate) use scrub::Scrubber;
pub use slot::PAYLOAD;
pub use trust::Trust;

use model_package::signature::KEY_LENGTH;
use model_package::{Manifest, authenticate};
use reception::{Reception, claimed_version};
use slot::{Marked, Slot};

/// The slots and the update in progress.
#[derive(Debug)]
pub struct Store<M> {
    memory: M,
    board: u16,
    keys: &'static [[u8; KEY_LENGTH]],
    running: Running,
    reception: Option<Reception>,
    trust: Trust,
    refusals: Refusals,
    corruptions: u16,
    /// Content of the slots.
    slots: [SlotState; 2],
}

/// Running package and its slot.
#[derive(Clone, Copy, Debug)]
struct Running {
    source: ModelSource,
    marked: Option<Marked>,
}

/// Reply to a request, with new networks if there are any.
#[derive(Debug)]
pub struct Served {
    /// Reply to the host.
    pub answer: UpdateAnswer,
    /// Networks that the session must use from its next sample on, before the next request.
    pub models: Option<Models>,
}

impl From<UpdateAnswer> for Served {
    fn from(answer: UpdateAnswer) -> Self {
        Self { answer, models: None }
    }
}

impl<M: SlotMemory> Store<M> {
    /// Examines the slots and chooses the networks to start with. `keys` are those of the firmware,
    /// the older first; `trust` is what was kept of [`Store::trust`].
    pub fn start(memory: M, board: u16, keys: &'static [[u8; KEY_LENGTH]], trust: Trust) -> (Self, Models) {
        let running = Running { source: ModelSource::BuiltIn, marked: None };
        let refusals = Refusals::new();
        let slots = [SlotState::Blank; 2];
        let mut store =
            Self { memory, board, keys, running, reception: None, trust, refusals, corruptions: 0, slots };
        for slot in Slot::both(&store.memory) {
            if !slot.is_blank(&mut store.memory) && slot.marked(&mut store.memory).is_none() {
                store.refuse_slot(slot, UpdateRefusal::NotMarked);
                store.note(slot, SlotState::Unfinished);
            }
        }
        let models = store.choose();
        (store, models)
    }

    /// Returns intact networks after those in use were found corrupted, from the newest slot first.
    /// Those in use are tried again as well: the corruption may have been in the core's caches.
    pub fn replace_corrupted(&mut self) -> Models {
        self.corruptions = self.corruptions.saturating_add(1);
        self.reception = None;
        self.choose()
    }

    /// Takes over the requirements of both packages, then chooses the newest one that passes every
    /// check.
    fn choose(&mut self) -> Models {
        let [a, b] = Slot::both(&self.memory).map(|slot| slot.marked(&mut self.memory));
        let newest_first = match (a, b) {
            (Some(first), Some(second)) if first.number < second.number => [b, a],
            _ => [a, b],
        };
        let authentic = newest_first.map(|marked| {
            let signed = marked?.slot.signed(&mut self.memory);
            let signed = signed.ok_or(UpdateRefusal::Flash(FlashOperation::Read));
            Some(signed.and_then(|signed| authenticate(&signed, self.board, self.keys)))
        });
        // The mark shows that the package was installed, whatever has become of its payload since.
        for (manifest, signer) in authentic.iter().rev().flatten().flatten() {
            if !self.is_revoked(*signer) {
                self.trust.accept(manifest, *signer, self.keys);
            }
        }
        self.running = Running { source: ModelSource::BuiltIn, marked: None };
        let mut chosen = None;
        for (marked, authentic) in newest_first.into_iter().flatten().zip(authentic.into_iter().flatten()) {
            let loaded = authentic.and_then(|(manifest, signer)| {
                if self.is_revoked(signer) {
                    return Err(UpdateRefusal::Revoked);
                }
                Ok((manifest.version, marked.slot.load(&self.memory, &manifest)?))
            });
            match loaded {
                Ok((version, models)) => {
                    self.note(marked.slot, SlotState::Valid { version });
                    if chosen.is_none() {
                        self.running = Running { source: models.source(), marked: Some(marked) };
                        chosen = Some(models);
                    }
                }
                Err(reason) => {
                    self.note(marked.slot, SlotState::Refused);
                    self.refuse_slot(marked.slot, reason);
                }
            }
        }
        chosen.unwrap_or_else(Models::built_in)
    }

    /// Decides whether a key of the firmware's list has been revoked.
    fn is_revoked(&self, signer: usize) -> bool {
        self.keys.get(signer).is_none_or(|key| self.trust.has_revoked(key))
    }

    /// Checks manifest and signature. Returns the manifest with the index of its key, which has not
    /// been revoked.
    fn authenticate(&self, signed: &SignedManifest) -> Result<(Manifest, usize), UpdateRefusal> {
        let (manifest, signer) = authenticate(signed, self.board, self.keys)?;
        if self.is_revoked(signer) { Err(UpdateRefusal::Revoked) } else { Ok((manifest, signer)) }
    }

    /// Returns the requirements that must be kept without power.
    #[must_use]
    pub const fn trust(&self) -> Trust {
        self.trust
    }

    /// Records the content of a slot.
    fn note(&mut self, slot: Slot, state: SlotState) {
        if let Some(kept) = self.slots.get_mut(usize::from(slot.index)) {
            *kept = state;
        }
    }

    fn refuse(&mut self, slot: Option<Slot>, version: u32, reason: UpdateRefusal) -> UpdateRefusal {
        self.refusals.add(slot.map(|slot| slot.index), version, reason)
    }

    fn refuse_slot(&mut self, slot: Slot, reason: UpdateRefusal) {
        let version = slot.signed(&mut self.memory).map_or(0, |signed| claimed_version(&signed));
        self.refuse(Some(slot), version, reason);
    }

    /// Handles one request. `estimating` is true during a run.
    pub fn serve(&mut self, request: &UpdateRequest, estimating: bool) -> Served {
        let is_blocked = estimating && self.memory.stalls_the_core();
        let served = match request {
            UpdateRequest::Status => Ok(None),
            UpdateRequest::Refusals { index } => {
                return UpdateAnswer::Record(self.refusals.get(*index)).into();
            }
            UpdateRequest::Abort => {
                self.reception = None;
                Ok(None)
            }
            UpdateRequest::Begin(signed) => self.begin(signed, is_blocked).map(|()| None),
            UpdateRequest::Chunk(_) | UpdateRequest::Finish if is_blocked => Err(UpdateRefusal::Estimating),
            UpdateRequest::Chunk(chunk) => self.chunk(chunk).map(|()| None),
            UpdateRequest::Finish => self.finish(),
        };
        match served {
            Ok(models) => Served { answer: UpdateAnswer::Status(self.status()), models },
            Err(reason) => UpdateAnswer::Refused(reason).into(),
        }
    }

    /// Returns the status.
    #[must_use]
    pub fn status(&self) -> UpdateStatus {
        let [slot, _] = Slot::both(&self.memory);
        let trusted = || self.keys.iter().filter(|key| !self.trust.has_revoked(key));
        let trusted_keys = trusted().fold(0_u8, |count, _| count.saturating_add(1));
        let listed = u8::try_from(self.keys.len()).unwrap_or(u8::MAX);
        UpdateStatus {
            running: self.running.source,
            memory: self.memory.kind(),
            capacity: slot.capacity(),
            receiving: self.reception.as_ref().map(Reception::report),
            refused: self.refusals.count(),
            corrupted: self.corruptions,
            development_key: trusted().any(|key| *key == key::DEVELOPMENT_KEY),
            slots: self.slots,
            last_refusal: self.refusals.get(0),
            min_version: self.trust.min_version(),
            trusted_keys,
            revoked_keys: listed.saturating_sub(trusted_keys),
        }
    }

    /// Decides whether the core stalls while a package is written.
    pub(crate) fn stalls_the_core(&self) -> bool {
        self.memory.stalls_the_core()
    }

    /// Returns the memory, for tests of a reset.
    pub fn into_memory(self) -> M {
        self.memory
    }
}
