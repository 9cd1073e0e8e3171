//! Requirements on packages that outlast the slots.
//!
//! Each update erases a slot, and with it the version and the revocations of the package there. So
//! they are kept beside the configuration ([`super::keeper`]). Both follow from the packages in the
//! slots, too. A loss of power after a package was marked and before its requirements were kept
//! therefore loses nothing.
//!
//! The minimum version falls only with a package that revokes a key: with that key it may have been
//! raised beyond measure. Four revoked keys are kept. A fifth one takes the place of a key that the
//! firmware does not list; an older firmware that lists it would trust it again.

use model_package::Manifest;
use model_package::signature::KEY_LENGTH;
use serde::{Deserialize, Serialize};

use super::key::MAX_KEYS;

/// First bytes of a key, which identify it.
type KeyId = [u8; 8];
/// A place without a key.
const FREE: KeyId = [0; 8];
/// Number of revoked keys that are kept.
const PLACES: usize = 4;
const _: () = assert!(PLACES >= MAX_KEYS);

/// Requirements on a package beside its signature.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Trust {
    /// Highest version that was installed; 0 before the first.
    highest_version: u32,
    /// Revoked keys.
    revoked: [KeyId; PLACES],
}

impl Trust {
    /// Returns the minimum version of a package that is not signed to be older.
    #[must_use]
    pub const fn min_version(&self) -> u32 {
        self.highest_version.saturating_add(1)
    }

    /// Decides whether a key has been revoked.
    #[must_use]
    pub fn has_revoked(&self, key: &[u8; KEY_LENGTH]) -> bool {
        self.revoked.contains(&id(key))
    }

    /// Takes over the requirements of an installed package. Packages are to be passed in the order
    /// of their installation. `signer` is the index of its key in the firmware's list. Returns
    /// whether it revokes a key that was trusted.
    pub(super) fn accept(&mut self, manifest: &Manifest, signer: usize, keys: &[[u8; KEY_LENGTH]]) -> bool {
        self.highest_version = self.highest_version.max(manifest.version);
        let before = self.revoked;
        if manifest.revokes_older_keys {
            keys.iter().take(signer).for_each(|key| self.revoke(key, keys));
        }
        let is_revoking = self.revoked != before;
        if is_revoking {
            self.highest_version = manifest.version;
        }
        is_revoking
    }

    /// Revokes a key. It takes a free place, or that of a key which this firmware does not list.
    /// The list has no more keys than there are places, and the signer's key is never revoked.
    fn revoke(&mut self, key: &[u8; KEY_LENGTH], keys: &[[u8; KEY_LENGTH]]) {
        if self.has_revoked(key) {
            return;
        }
        let is_listed = |place: &KeyId| keys.iter().any(|key| id(key) == *place);
        let replaced = if self.revoked.contains(&FREE) {
            Some(FREE)
        } else {
            self.revoked.iter().copied().find(|place| !is_listed(place))
        };
        if let Some(place) = self.revoked.iter_mut().find(|place| Some(**place) == replaced) {
            *place = id(key);
        }
    }
}

fn id(key: &[u8; KEY_LENGTH]) -> KeyId {
    key.first_chunk().copied().unwrap_or(FREE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use inference::BearingMaterial;
    use proptest::prelude::*;

    fn manifest(version: u32, revokes_older_keys: bool) -> Manifest {
        Manifest {
            board: 1,
            version,
            may_be_older: true,
            revokes_older_keys,
            images: [0; BearingMaterial::COUNT],
            samples: [0; BearingMaterial::COUNT],
            hash: [0; 32],
        }
    }

    fn keys(first: u8, count: usize) -> Vec<[u8; KEY_LENGTH]> {
        (first..).take(count).map(|key| [key; KEY_LENGTH]).collect()
    }

    #[test]
    fn firmware_after_firmware_can_revoke_its_older_keys() {
        let mut trust = Trust::default();
        for first in 1..200 {
            let keys = keys(first, MAX_KEYS);
            trust.accept(&manifest(1, true), MAX_KEYS - 1, &keys);
            let revoked: Vec<bool> = keys.iter().map(|key| trust.has_revoked(key)).collect();
            assert_eq!(revoked, [true, false]);
        }
    }

    proptest! {
        #[test]
        fn the_minimum_version_falls_only_with_a_revocation_and_no_listed_key_is_trusted_again(
            installed in prop::collection::vec((1_u32..1000, any::<bool>(), 0..MAX_KEYS), 1..20),
        ) {
            let keys = keys(1, MAX_KEYS);
            let mut trust = Trust::default();
            for (version, revokes, signer) in installed {
                let before = trust;
                trust.accept(&manifest(version, revokes), signer, &keys);
                let is_revoking = trust.revoked != before.revoked;
                let raised = before.min_version().max(version + 1);
                prop_assert_eq!(trust.min_version(), if is_revoking { version + 1 } else { raised });
                for (index, key) in keys.iter().enumerate() {
                    let expected = before.has_revoked(key) || revokes && index < signer;
                    prop_assert_eq!(trust.has_revoked(key), expected);
                }
            }
        }
    }
}
