//! Power failure at every step of an update: the old or the new model runs afterwards, and the
//! update continues.

use crate::flash::{Failure, Flash, HALF};
use crate::package::{BOARD, Package};
use controller::store::{Models, Store, Trust, key::DEVELOPMENT_KEY};
use inference::BearingMaterial;
use link::update::{ModelSource, UpdateAnswer, UpdateRequest};

type Slots<const WORD: usize = 4> = Flash<{ 2 * HALF }, WORD>;

fn start<const WORD: usize>(flash: Slots<WORD>) -> (Store<Slots<WORD>>, Models) {
    Store::start(flash, BOARD, &[DEVELOPMENT_KEY], Trust::default())
}

/// Runs an update without repeated requests: begins, sends the missing chunks, finishes. Returns
/// the new networks if the update completed.
fn update<const WORD: usize>(store: &mut Store<Slots<WORD>>, package: &Package) -> Option<Models> {
    let mut answer = store.serve(&package.begin(), false).answer;
    loop {
        let UpdateAnswer::Status(status) = answer else { return None };
        let receiving = status.receiving?;
        if receiving.next_offset == receiving.length {
            return store.serve(&UpdateRequest::Finish, false).models;
        }
        answer = store.serve(&package.chunk(receiving.next_offset), false).answer;
    }
}

fn version(source: ModelSource) -> u32 {
    match source {
        ModelSource::BuiltIn => 0,
        ModelSource::Slot { version, .. } => version,
    }
}

/// Checksum of the model itself, independent of the store's status.
fn checksum(models: &Models) -> u32 {
    models.of(BearingMaterial::Babbitt).unwrap().model.checksum()
}

fn installed<const WORD: usize>(flash: Slots<WORD>, package: &Package) -> Slots<WORD> {
    let (mut store, _) = start(flash);
    assert!(update(&mut store, package).is_some());
    store.into_memory()
}

/// Tries every cut of the update from `old` to `new` on a memory that contains `old`; `None` are
/// the built-in models.
fn every_cut<const WORD: usize>(flash: &Slots<WORD>, old: Option<&Package>, new: &Package) {
    let expected_old = old.map_or(0, |package| package.manifest.version);
    let (mut whole, before) = start(flash.clone().restart(None, 1));
    assert_eq!(version(whole.status().running), expected_old);
    let after = update(&mut whole, new).unwrap();
    let steps = whole.into_memory().steps;
    // More steps than words of the package: no step is missing.
    assert!(steps > new.payload.len() / WORD, "{steps}");
    let mut switched_at = None;
    for cut in 0..steps {
        let (mut store, _) = start(flash.clone().restart(Some(cut), cut as u64 + 1));
        assert!(update(&mut store, new).is_none(), "the power fails at step {cut}");
        assert!(store.status().refused > 0);
        // The run continues with the old model; then the power returns.
        assert_eq!(version(store.status().running), expected_old, "step {cut}");
        let (mut store, models) = start(store.into_memory().restart(None, 1));
        let is_new = version(models.source()) == new.manifest.version;
        assert_eq!(checksum(&models), checksum(if is_new { &after } else { &before }), "step {cut}");
        assert!(is_new || version(models.source()) == expected_old, "step {cut}: {:?}", models.source());
        if is_new {
            // Only if all but the last bits of the mark had been written.
            switched_at.get_or_insert(cut);
            assert_eq!(cut, steps - 1);
            continue;
        }
        let models = update(&mut store, new).or_else(|| update(&mut store, new)).unwrap();
        assert_eq!(checksum(&models), checksum(&after), "step {cut}");
        let (_, models) = start(store.into_memory().restart(None, 1));
        assert_eq!(version(models.source()), new.manifest.version, "step {cut}");
    }
}

#[test]
fn power_lost_at_any_step_of_the_first_update_leaves_a_model_that_runs() {
    every_cut::<4>(&Flash::new(), None, &Package::new(BearingMaterial::Babbitt, 3));
    every_cut::<32>(&Flash::new(), None, &Package::new(BearingMaterial::Babbitt, 3));
}

#[test]
fn power_lost_at_any_step_of_a_later_update_leaves_the_old_model_or_the_new_one() {
    let [first, second, third] = [3, 4, 9].map(|version| Package::new(BearingMaterial::Babbitt, version));
    // Both slots are used: the update has to erase one first.
    let flash = installed::<4>(installed(Flash::new(), &first), &second);
    every_cut(&flash, Some(&second), &third);
    let flash = installed::<32>(installed(Flash::new(), &first), &second);
    every_cut(&flash, Some(&second), &third);
}

#[test]
fn repeated_loss_of_power_only_prolongs_the_update() {
    let package = Package::new(BearingMaterial::Babbitt, 3);
    let mut flash = installed::<4>(Flash::new(), &Package::new(BearingMaterial::Babbitt, 2));
    for attempt in 0..200 {
        let (mut store, models) = start(flash.restart(Some(60 + attempt % 7), attempt as u64));
        if version(models.source()) == 3 {
            return;
        }
        assert_eq!(version(models.source()), 2);
        let _ = update(&mut store, &package);
        flash = store.into_memory();
    }
    panic!("an update of 2300 words in runs of 60 words each did not come to its end");
}

#[test]
fn a_worn_out_slot_keeps_the_running_model() {
    let flash = installed::<4>(Flash::new(), &Package::new(BearingMaterial::Babbitt, 2));
    let mut flash = installed(flash, &Package::new(BearingMaterial::Babbitt, 3)).restart(None, 1);
    flash.worn = true;
    let (mut store, _) = start(flash);
    assert!(update(&mut store, &Package::new(BearingMaterial::Babbitt, 4)).is_none());
    assert_eq!(version(store.status().running), 3);
    assert!(store.into_memory().restart(None, 1).worn);
    assert_ne!(Failure::Worn, Failure::Power);
}

#[test]
fn a_model_that_can_no_longer_be_read_gives_way_to_the_other_slot_or_the_built_in_one() {
    let flash = installed::<32>(Flash::new(), &Package::new(BearingMaterial::Babbitt, 2));
    let mut flash = installed(flash, &Package::new(BearingMaterial::Babbitt, 3)).restart(None, 1);
    for (unreadable, running) in [(HALF + 4_000, 2), (100, 0)] {
        flash.lose(unreadable);
        let (store, models) = start(flash);
        assert_eq!(version(models.source()), running);
        flash = store.into_memory();
    }
    // An update still succeeds, because it erases its slot first.
    let (mut store, _) = start(flash);
    assert!(update(&mut store, &Package::new(BearingMaterial::Babbitt, 4)).is_some());
}
