//! Refused packages, the recorded reasons, and the slot that is selected at the start.

use crate::flash::{Flash, HALF};
use crate::package::{BOARD, Package, image, records};
use controller::store::{Models, PAYLOAD, Store, Trust, key::DEVELOPMENT_KEY};
use inference::{BearingMaterial, shipped};
use link::update::{ModelSource, RefusedPackage, SignedManifest, UpdateAnswer, UpdateRefusal, UpdateRequest};

type Slots = Flash<{ 2 * HALF }>;

fn start(flash: Slots) -> (Store<Slots>, Models) {
    Store::start(flash, BOARD, &[DEVELOPMENT_KEY], Trust::default())
}

fn update(store: &mut Store<Slots>, package: &Package) -> UpdateAnswer {
    match store.serve(&package.begin(), false).answer {
        UpdateAnswer::Status(_) => {}
        refused => return refused,
    }
    for offset in package.offsets() {
        assert!(matches!(store.serve(&package.chunk(offset), false).answer, UpdateAnswer::Status(_)));
    }
    store.serve(&UpdateRequest::Finish, false).answer
}

fn newest_record(store: &mut Store<Slots>) -> Option<RefusedPackage> {
    match store.serve(&UpdateRequest::Refusals { index: 0 }, false).answer {
        UpdateAnswer::Record(record) => record,
        other => panic!("{other:?}"),
    }
}

fn running_version(store: &Store<Slots>) -> u32 {
    match store.status().running {
        ModelSource::BuiltIn => 0,
        ModelSource::Slot { version, .. } => version,
    }
}

fn with_version(version: u32) -> Store<Slots> {
    let mut store = start(Flash::new()).0;
    assert!(matches!(
        update(&mut store, &Package::new(BearingMaterial::Babbitt, version)),
        UpdateAnswer::Status(_)
    ));
    store
}

/// Checks that a package is refused before anything is written, and that the refusal is recorded.
fn refused_at_once(package: &Package, reason: UpdateRefusal) {
    let mut store = with_version(5);
    let before = store.status();
    assert_eq!(store.serve(&package.begin(), false).answer, UpdateAnswer::Refused(reason));
    assert_eq!(store.status().running, before.running);
    assert_eq!(store.status().refused, before.refused + 1);
    let record = newest_record(&mut store).unwrap();
    assert_eq!((record.reason, record.slot, record.version), (reason, None, package.manifest.version));
    let flash = store.into_memory();
    assert_eq!(&flash.bytes[HALF..], &[0xFF; HALF], "the other slot is as it was");
}

/// Checks that a complete package is refused and recorded, and that the running model continues.
fn refused_at_the_end(package: &Package, reason: UpdateRefusal) {
    let mut store = with_version(5);
    assert_eq!(update(&mut store, package), UpdateAnswer::Refused(reason));
    assert_eq!(running_version(&store), 5);
    assert_eq!(newest_record(&mut store).unwrap().reason, reason);
    let (store, models) = start(store.into_memory().restart(None, 1));
    assert_eq!((running_version(&store), store.status().refused), (5, 0), "nothing of it is left");
    assert!(models.of(BearingMaterial::Babbitt).is_some());
}

#[test]
fn unsigned_foreign_older_and_oversized_packages_are_refused_before_anything_is_written() {
    let good = || Package::new(BearingMaterial::Babbitt, 6);
    let mut unsigned = good();
    unsigned.signed.signature = [[0; 32]; 2];
    refused_at_once(&unsigned, UpdateRefusal::Signature);
    let mut corrupted = good();
    corrupted.signed.manifest[2][0] ^= 1;
    refused_at_once(&corrupted, UpdateRefusal::Signature);
    let wrong_board = good().signed_anew(|manifest| manifest.board = 0x2350);
    refused_at_once(&wrong_board, UpdateRefusal::Board { found: 0x2350, expected: BOARD });
    let older = good().signed_anew(|manifest| manifest.version = 4);
    refused_at_once(&older, UpdateRefusal::Version { found: 4, least: 6 });
    let same = good().signed_anew(|manifest| manifest.version = 5);
    refused_at_once(&same, UpdateRefusal::Version { found: 5, least: 6 });
    let long = good().signed_anew(|manifest| manifest.images[1] = 0);
    let long = long.signed_anew(|manifest| manifest.samples[0] = 1000);
    let most = HALF as u32 - PAYLOAD;
    let length = shipped(BearingMaterial::Babbitt).len() as u32;
    refused_at_once(&long, UpdateRefusal::TooLong { found: length + 32_000, most });
}

#[test]
fn another_key_excludes_the_development_key() {
    let (mut store, _) = Store::start(Flash::<{ 2 * HALF }>::new(), BOARD, &[[7; 32]], Trust::default());
    assert!(!store.status().development_key);
    let answer = store.serve(&Package::new(BearingMaterial::Babbitt, 1).begin(), false).answer;
    assert_eq!(answer, UpdateAnswer::Refused(UpdateRefusal::Signature));
}

#[test]
fn corrupted_bytes_wrong_images_and_failing_self_tests_are_refused_at_the_end() {
    let mut corrupted = Package::new(BearingMaterial::Babbitt, 6);
    corrupted.payload[5000] ^= 4;
    refused_at_the_end(&corrupted, UpdateRefusal::Hash);

    let mut damaged = image(BearingMaterial::Babbitt, 6);
    let records = records(&damaged);
    damaged[5000] ^= 4;
    let cause = 4;
    let damaged = Package::of(BearingMaterial::Babbitt, 6, &damaged, &records);
    refused_at_the_end(&damaged, UpdateRefusal::Image { bearing: 0, cause });

    let swapped = Package::of(BearingMaterial::Plastic, 6, &image(BearingMaterial::Babbitt, 6), &records);
    refused_at_the_end(&swapped, UpdateRefusal::Image { bearing: 1, cause: 100 });

    let mut other_results = records.clone();
    other_results[10 * 32 + 20] ^= 1;
    let failing =
        Package::of(BearingMaterial::Babbitt, 6, &image(BearingMaterial::Babbitt, 6), &other_results);
    refused_at_the_end(&failing, UpdateRefusal::SelfTest { bearing: 0, sample: 10 });
}

#[test]
fn an_older_package_is_accepted_if_it_is_signed_as_such() {
    let mut store = with_version(5);
    let older =
        Package::new(BearingMaterial::Babbitt, 2).signed_anew(|manifest| manifest.may_be_older = true);
    assert!(matches!(update(&mut store, &older), UpdateAnswer::Status(_)));
    assert_eq!(running_version(&store), 2);
    // It stays the newest one after a reset, and the version limit for the next package remains.
    let (mut store, _) = start(store.into_memory().restart(None, 1));
    assert_eq!(running_version(&store), 2);
    let answer = store.serve(&Package::new(BearingMaterial::Babbitt, 4).begin(), false).answer;
    assert_eq!(answer, UpdateAnswer::Refused(UpdateRefusal::Version { found: 4, least: 6 }));
}

#[test]
fn a_board_that_halts_while_writing_must_be_stopped_first() {
    let mut flash: Slots = Flash::new();
    flash.stalls = true;
    let (mut store, _) = start(flash);
    let package = Package::new(BearingMaterial::Babbitt, 1);
    let refused = UpdateAnswer::Refused(UpdateRefusal::Estimating);
    assert_eq!(store.serve(&package.begin(), true).answer, refused);
    store.serve(&package.begin(), false);
    assert_eq!(store.serve(&package.chunk(0), true).answer, refused);
    assert_eq!(store.serve(&UpdateRequest::Finish, true).answer, refused);
    assert_eq!(store.status().refused, 0, "the package itself was not refused");
    assert!(matches!(update(&mut store, &package), UpdateAnswer::Status(_)));
}

#[test]
fn a_corrupted_slot_is_replaced_by_the_other_and_that_by_the_built_in_models() {
    let mut store = with_version(5);
    update(&mut store, &Package::new(BearingMaterial::Babbitt, 6));
    let mut flash = store.into_memory().restart(None, 1);
    for (slot, left) in [(1, 5), (0, 0)] {
        flash.bytes[slot * HALF + PAYLOAD as usize + 4000] ^= 0x10;
        let (mut store, models) = start(flash);
        assert_eq!(running_version(&store), left);
        assert_eq!(models.source() == ModelSource::BuiltIn, left == 0);
        let record = newest_record(&mut store).unwrap();
        assert_eq!((record.reason, record.slot), (UpdateRefusal::Hash, Some(slot as u8)));
        flash = store.into_memory();
    }
}

#[test]
fn networks_corrupted_during_a_run_are_replaced() {
    let mut store = with_version(5);
    update(&mut store, &Package::new(BearingMaterial::Babbitt, 6));
    let mut flash = store.into_memory().restart(None, 1);
    let (mut store, models) = start(flash.clone());
    assert_eq!(running_version(&store), 6);
    // The memory becomes corrupted while the store is running.
    flash.bytes[HALF + PAYLOAD as usize + 4000] ^= 0x10;
    store = Store::start(flash, BOARD, &[DEVELOPMENT_KEY], Trust::default()).0;
    let replaced = store.replace_corrupted();
    assert_eq!((running_version(&store), store.status().corrupted), (5, 1));
    assert_ne!(replaced.ids(), models.ids());
}

#[test]
fn a_bearing_that_is_not_in_the_package_keeps_its_built_in_networks() {
    let store = with_version(5);
    let (_, models) = start(store.into_memory().restart(None, 1));
    let built_in = Models::built_in().ids();
    assert_ne!(models.ids()[0], built_in[0]);
    assert_eq!(models.ids()[1], built_in[1]);
}

#[test]
fn arbitrary_memory_contains_no_model() {
    for seed in 0..40_u32 {
        let mut flash: Slots = Flash::new();
        let mut state = seed.wrapping_mul(2_654_435_761) | 1;
        for byte in &mut flash.bytes {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *byte = (state >> 24) as u8;
        }
        let (store, models) = start(flash);
        assert_eq!(models.source(), ModelSource::BuiltIn);
        assert_eq!(store.status().refused, 2);
    }
    let nothing = SignedManifest { manifest: [[0; 32]; 3], signature: [[0; 32]; 2] };
    let answer = start(Flash::new()).0.serve(&UpdateRequest::Begin(nothing), false).answer;
    assert_eq!(answer, UpdateAnswer::Refused(UpdateRefusal::Magic));
}
