//! Everything that lasts without power: packages, configuration, requirements on packages,
//! number of the last start.

use link::update::{UpdateAnswer, UpdateRequest};
use link::{CONFIGURATION_VERSION, ControllerConfiguration};
use model_package::signature::KEY_LENGTH;

use crate::store::keeper::{KeepError, Kind};
use crate::store::{Keeper, Models, Served, SlotMemory, Store, Trust};

/// Version of the layout of [`Trust`]. A firmware with a later one must read this one, too, or the
/// requirements are lost.
const TRUST_LAYOUT: u8 = 1;
/// Version of the layout of a start's number; as for [`TRUST_LAYOUT`], a later firmware must read
/// this one.
const START_LAYOUT: u8 = 1;

/// Packages and kept values.
#[derive(Debug)]
pub struct Stores<M> {
    pub(super) packages: Store<M>,
    values: Keeper<M>,
    /// Requirements on packages as they are kept.
    kept_trust: Trust,
}

impl<M: SlotMemory> Stores<M> {
    /// Opens both memories and chooses the networks to start with. `keys` are those that the
    /// firmware trusts, the older first.
    pub fn start(slots: M, values: M, board: u16, keys: &'static [[u8; KEY_LENGTH]]) -> (Self, Models) {
        let mut values = Keeper::start(values);
        let kept_trust = values.value(Kind::Trust, TRUST_LAYOUT).unwrap_or_default();
        let (packages, models) = Store::start(slots, board, keys, kept_trust);
        (Self { packages, values, kept_trust }, models)
    }

    /// Returns the kept configuration.
    pub(super) fn configuration(&mut self) -> Option<ControllerConfiguration> {
        self.values.value(Kind::Configuration, CONFIGURATION_VERSION)
    }

    /// Keeps a configuration.
    pub(super) fn keep(&mut self, configuration: &ControllerConfiguration) -> Result<(), KeepError> {
        self.values.keep(Kind::Configuration, CONFIGURATION_VERSION, configuration)
    }

    /// Keeps a number for this start that no start before it can have had, and returns it; `None`
    /// if it cannot be kept.
    pub(super) fn next_start(&mut self) -> Option<u32> {
        let number = self.values.count_bound(Kind::Start, START_LAYOUT).checked_add(1)?;
        self.values.keep(Kind::Start, START_LAYOUT, &number).ok().map(|()| number)
    }

    /// Handles a request about models. `is_estimating` is true during a run.
    ///
    /// An update erases a slot, whose package may be the one with the highest version or with a
    /// revocation. So it begins only if these are kept elsewhere; until then they are in the slots.
    pub(super) fn serve(&mut self, request: &UpdateRequest, is_estimating: bool) -> Served {
        let is_blocked = is_estimating && self.packages.stalls_the_core();
        if let UpdateRequest::Begin(signed) = request
            && !is_blocked
            && !self.keep_trust()
        {
            return UpdateAnswer::Refused(self.packages.refuse_unkept(signed)).into();
        }
        self.packages.serve(request, is_estimating)
    }

    /// Keeps the requirements on packages if they have changed. Returns whether they are kept.
    pub(super) fn keep_trust(&mut self) -> bool {
        let trust = self.packages.trust();
        if trust != self.kept_trust && self.values.keep(Kind::Trust, TRUST_LAYOUT, &trust).is_ok() {
            self.kept_trust = trust;
        }
        trust == self.kept_trust
    }

    /// Returns the memory of the values, for tests of what is written.
    #[cfg(test)]
    pub(super) fn values_mut(&mut self) -> &mut M {
        self.values.memory_mut()
    }

    /// Returns the memories of packages and values, for tests of a reset.
    #[cfg(test)]
    pub(super) fn into_memories(self) -> [M; 2] {
        [self.packages.into_memory(), self.values.into_memory()]
    }
}
