//! Attacks on the chain of updates: a return to an old version, a key that is known to others, a
//! version that shuts out all later ones.

use crate::flash::{Flash, HALF};
use crate::package::{BOARD, Package};
use controller::store::{Store, Trust, key::DEVELOPMENT_KEY};
use ed25519_dalek::SigningKey;
use inference::BearingMaterial::Babbitt;
use link::update::{ModelSource, SlotState, UpdateAnswer, UpdateRefusal, UpdateRequest};
use model_package::MAX_VERSION_STEP;

type Slots = Flash<{ 2 * HALF }>;

/// A controller that is switched off and on: memory, trusted keys, and what it keeps.
struct Controller {
    store: Store<Slots>,
    keys: &'static [[u8; 32]],
}

impl Controller {
    fn new(keys: &'static [[u8; 32]]) -> Self {
        Self { store: Store::start(Flash::new(), BOARD, keys, Trust::default()).0, keys }
    }

    fn restarted(self) -> Self {
        let trust = self.store.trust();
        self.restarted_with(trust)
    }

    fn restarted_with(self, trust: Trust) -> Self {
        let flash = self.store.into_memory().restart(None, 1);
        Self { store: Store::start(flash, BOARD, self.keys, trust).0, keys: self.keys }
    }

    /// Installs a package with one attempt; returns the reason of a refusal.
    fn install(&mut self, package: &Package) -> Option<UpdateRefusal> {
        let mut request = package.begin();
        loop {
            let receiving = match self.store.serve(&request, false).answer {
                UpdateAnswer::Refused(reason) => return Some(reason),
                UpdateAnswer::Status(status) => status.receiving?,
                UpdateAnswer::Record(_) => panic!("no record was requested"),
            };
            request = if receiving.next_offset < receiving.length {
                package.chunk(receiving.next_offset)
            } else {
                UpdateRequest::Finish
            };
        }
    }

    fn running(&self) -> u32 {
        match self.store.status().running {
            ModelSource::BuiltIn => 0,
            ModelSource::Slot { version, .. } => version,
        }
    }
}

fn package(version: u32) -> Package {
    Package::new(Babbitt, version)
}

fn that_may_be_older(version: u32) -> Package {
    package(version).signed_anew(|manifest| manifest.may_be_older = true)
}

#[test]
fn a_package_that_is_still_in_its_slot_is_installed_again_at_the_first_attempt() {
    let mut controller = Controller::new(&[DEVELOPMENT_KEY]);
    let older = that_may_be_older(4);
    for package in [&older, &package(5), &older] {
        assert_eq!(controller.install(package), None);
        assert_eq!(controller.running(), package.manifest.version);
    }
    assert_eq!(controller.restarted().running(), 4);
}

#[test]
fn the_minimum_version_survives_the_erasure_of_the_slot_that_held_it() {
    let mut controller = Controller::new(&[DEVELOPMENT_KEY]);
    assert_eq!(controller.install(&package(9)), None);
    assert_eq!(controller.install(&that_may_be_older(2)), None);
    // It erases the slot of version 9, and the update is never finished.
    controller.store.serve(&package(10).begin(), false);
    let mut controller = controller.restarted();
    let refusal = UpdateRefusal::Version { found: 3, least: 10 };
    assert_eq!(controller.install(&package(3)), Some(refusal));
    assert_eq!(controller.store.status().min_version, 10);
    assert_eq!(controller.install(&package(10)), None);
}

#[test]
fn a_version_far_above_the_last_one_is_refused_because_it_would_shut_out_later_ones() {
    let mut controller = Controller::new(&[DEVELOPMENT_KEY]);
    let mut least = 1;
    for _ in 0..3 {
        let highest = least + MAX_VERSION_STEP;
        for version in [highest + 1, u32::MAX] {
            let refusal = UpdateRefusal::VersionTooHigh { found: version, most: highest };
            assert_eq!(controller.install(&package(version)), Some(refusal));
        }
        assert_eq!(controller.install(&package(highest)), None);
        least = highest + 1;
        assert_eq!(controller.install(&package(least)), None);
        least += 1;
    }
}

#[test]
fn a_revocation_takes_back_a_version_that_was_raised_with_the_revoked_key() {
    let (second, keys) = two_keys();
    let mut controller = Controller::new(keys);
    assert_eq!(controller.install(&package(MAX_VERSION_STEP)), None);
    let revocation = |version| {
        package(version).signed_with(&second, |manifest| {
            (manifest.revokes_older_keys, manifest.may_be_older) = (true, true);
        })
    };
    let before = controller.store.trust();
    assert_eq!(controller.install(&revocation(5)), None);
    // Also if power was lost before that was kept.
    let mut controller = controller.restarted_with(before);
    assert_eq!((controller.running(), controller.store.status().min_version), (5, 6));
    // Once only: a package that revokes nothing more takes nothing back.
    assert_eq!(controller.install(&package(9).signed_with(&second, |_| {})), None);
    // Also if nothing was kept: the packages count in the order of their installation.
    let mut controller = controller.restarted_with(Trust::default());
    assert_eq!(controller.store.status().min_version, 10);
    assert_eq!(controller.install(&revocation(7)), None);
    assert_eq!(controller.store.status().min_version, 10);
}

/// Second key of a firmware and its list of keys.
fn two_keys() -> (SigningKey, &'static [[u8; 32]]) {
    let second = SigningKey::from_bytes(&[42; 32]);
    let keys = Box::leak(Box::new([DEVELOPMENT_KEY, second.verifying_key().to_bytes()]));
    (second, keys)
}

#[test]
fn a_later_key_revokes_the_one_before_it_for_good() {
    let (second, keys) = two_keys();
    let mut controller = Controller::new(keys);
    assert_eq!(controller.install(&package(1)), None);
    assert_eq!(controller.store.status().trusted_keys, 2);
    assert!(controller.store.status().development_key);
    let revocation = package(2).signed_with(&second, |manifest| manifest.revokes_older_keys = true);
    assert_eq!(controller.install(&revocation), None);
    assert_eq!(controller.store.status().slots[0], SlotState::Refused);
    // The first key installs nothing any more: not at the next start, and not if power was lost
    // before the revocation was kept.
    let attack = that_may_be_older(3);
    for is_kept in [true, false] {
        assert_eq!(controller.install(&attack), Some(UpdateRefusal::Revoked));
        let trust = if is_kept { controller.store.trust() } else { Trust::default() };
        controller = controller.restarted_with(trust);
        let status = controller.store.status();
        assert_eq!((controller.running(), status.trusted_keys, status.revoked_keys), (2, 1, 1));
        assert_eq!(status.slots[0], SlotState::Refused, "signed with the revoked key");
        assert!(!status.development_key);
    }
    // The revocation outlasts its package.
    for version in [3, 4] {
        assert_eq!(controller.install(&package(version).signed_with(&second, |_| {})), None);
    }
    assert_eq!(controller.restarted().install(&attack), Some(UpdateRefusal::Revoked));
}

#[test]
fn a_package_of_a_revoked_key_does_not_run_even_if_it_is_newer_than_the_revocation() {
    let (second, keys) = two_keys();
    let mut controller = Controller::new(keys);
    let revocation = package(2).signed_with(&second, |manifest| manifest.revokes_older_keys = true);
    assert_eq!(controller.install(&revocation), None);
    // Another firmware, for which the first key is the later one, installs a package of that key,
    // and what was kept is lost.
    let reversed: &[_] = Box::leak(Box::new([keys[1], keys[0]]));
    let mut other = Controller { keys: reversed, ..controller }.restarted_with(Trust::default());
    assert_eq!(other.install(&package(3)), None);
    let controller = Controller { keys, ..other }.restarted_with(Trust::default());
    let status = controller.store.status();
    assert_eq!((controller.running(), status.revoked_keys), (2, 1));
    assert_eq!(status.slots[1], SlotState::Refused);
}

#[test]
fn the_oldest_key_revokes_nothing() {
    let (second, keys) = two_keys();
    let mut controller = Controller::new(keys);
    let attack = package(1).signed_anew(|manifest| manifest.revokes_older_keys = true);
    assert_eq!(controller.install(&attack), None);
    assert_eq!(controller.store.status().revoked_keys, 0);
    assert_eq!(controller.install(&package(2).signed_with(&second, |_| {})), None);
}
