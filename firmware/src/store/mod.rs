//! The models kept beside the firmware: two slots, the update over the link, the choice at start.
//!
//! A package ([`model_package`]) holds the images of one or both bearings and a self-test for each, under one ed25519 signature. At start
//! [`Store::start`] takes the newest slot that is whole, signed for this board and passes its self-test, else the other, else the
//! images built into the firmware. An update is written to the slot that is not in use, in chunks, and counts only once everything in it
//! has been checked and its mark is programmed, as the last word of all: power lost at any moment leaves a model that runs. Whatever is
//! refused is recorded with the reason.
//!
//! Nothing here waits or runs in a tick: `idle` serves the requests, and hands new networks to the session between two samples. On the STM32F405
//! the core stands still while its flash is written; there an update needs the run to be stopped ([`UpdateRefusal::Estimating`]).
//!
//! A package must be newer than what runs and than what the other slot holds, unless it is signed with the remark that it may be older. Such a
//! package can be installed again by whoever has it; the link itself authenticates nobody.

pub mod controller;
pub mod keeper;
pub mod key;
mod memory;
mod models;
mod receive;
mod refusals;
pub mod scrub;
mod slot;

use link::update::{ModelSource, SlotState, UpdateAnswer, UpdateRefusal, UpdateRequest, UpdateStatus};

pub use keeper::Keeper;
pub use memory::SlotMemory;
pub use models::{Loaded, Models};
pub use refusals::Refusals;
pub use scrub::Scrubber;
pub use slot::PAYLOAD;

use model_package::signature::KEY_LENGTH;
use receive::{Reception, claimed_version};
use slot::{Marked, Slot};

/// The slots and the update that is going on.
#[derive(Debug)]
pub struct Store<M> {
    memory: M,
    board: u16,
    key: [u8; KEY_LENGTH],
    running: Running,
    reception: Option<Reception>,
    /// Least version that an update must have.
    least_version: u32,
    refusals: Refusals,
    altered: u16,
    /// What the slots hold.
    slots: [SlotState; 2],
}

/// What runs, and in which slot it lies.
#[derive(Clone, Copy, Debug)]
struct Running {
    source: ModelSource,
    marked: Option<Marked>,
}

/// An answer, and new networks if there are some.
#[derive(Debug)]
pub struct Served {
    /// What the host is told.
    pub answer: UpdateAnswer,
    /// What the session must run from its next sample on, before the store is asked for anything else.
    pub models: Option<Models>,
}

impl From<UpdateAnswer> for Served {
    fn from(answer: UpdateAnswer) -> Self {
        Self { answer, models: None }
    }
}

impl<M: SlotMemory> Store<M> {
    /// Looks through the slots and chooses the networks to start with.
    pub fn start(memory: M, board: u16, key: [u8; KEY_LENGTH]) -> (Self, Models) {
        let running = Running { source: ModelSource::BuiltIn, marked: None };
        let refusals = Refusals::new();
        let slots = [SlotState::Blank; 2];
        let mut store = Self {
            memory,
            board,
            key,
            running,
            reception: None,
            least_version: 1,
            refusals,
            altered: 0,
            slots,
        };
        for slot in Slot::both(&store.memory) {
            if !slot.is_blank(&mut store.memory) && slot.marked(&mut store.memory).is_none() {
                store.refuse_slot(slot, UpdateRefusal::NotMarked);
                store.note(slot, SlotState::Unfinished);
            }
        }
        let models = store.choose();
        (store, models)
    }

    /// The networks in use were found altered: gives others that are sound, the newest slot's first. Those in use are tried again, too:
    /// what was altered may have been their copy in the core's caches.
    pub fn replace_altered(&mut self) -> Models {
        self.altered = self.altered.saturating_add(1);
        self.reception = None;
        self.choose()
    }

    /// Takes the newest slot that passes every check; fills in what an update must be newer than.
    fn choose(&mut self) -> Models {
        let [a, b] = Slot::both(&self.memory).map(|slot| slot.marked(&mut self.memory));
        let newest_first = match (a, b) {
            (Some(first), Some(second)) if first.number < second.number => [b, a],
            _ => [a, b],
        };
        self.running = Running { source: ModelSource::BuiltIn, marked: None };
        self.least_version = 1;
        let mut chosen = None;
        for marked in newest_first.into_iter().flatten() {
            match marked.slot.verify(&mut self.memory, self.board, &self.key) {
                Ok((manifest, models)) => {
                    self.note(marked.slot, SlotState::Sound { version: manifest.version });
                    self.least_version = self.least_version.max(manifest.version.saturating_add(1));
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

    /// Remembers what a slot holds now.
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

    /// Serves one request. `estimating` says whether a run is going on.
    pub fn serve(&mut self, request: &UpdateRequest, estimating: bool) -> Served {
        let held = estimating && self.memory.stalls_the_core();
        let served = match request {
            UpdateRequest::Status => Ok(None),
            UpdateRequest::Refusals { index } => {
                return UpdateAnswer::Record(self.refusals.get(*index)).into();
            }
            UpdateRequest::Abort => {
                self.reception = None;
                Ok(None)
            }
            UpdateRequest::Begin(signed) => self.begin(signed, held).map(|()| None),
            UpdateRequest::Chunk(_) | UpdateRequest::Finish if held => Err(UpdateRefusal::Estimating),
            UpdateRequest::Chunk(chunk) => self.chunk(chunk).map(|()| None),
            UpdateRequest::Finish => self.finish(),
        };
        match served {
            Ok(models) => Served { answer: UpdateAnswer::Status(self.status()), models },
            Err(reason) => UpdateAnswer::Refused(reason).into(),
        }
    }

    /// How things stand.
    #[must_use]
    pub fn status(&self) -> UpdateStatus {
        let [slot, _] = Slot::both(&self.memory);
        UpdateStatus {
            running: self.running.source,
            memory: self.memory.kind(),
            capacity: slot.capacity(),
            receiving: self.reception.as_ref().map(Reception::report),
            refused: self.refusals.count(),
            altered: self.altered,
            development_key: self.key == key::DEVELOPMENT_KEY,
            slots: self.slots,
            last_refusal: self.refusals.get(0),
        }
    }

    /// The memory, given back: a simulated one goes through a reset with it.
    pub fn into_memory(self) -> M {
        self.memory
    }
}
