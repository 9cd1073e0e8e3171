//! Requests that are lost, repeated or out of order: the update still completes with the same
//! result.

use crate::flash::{Flash, HALF};
use crate::package::{BOARD, Package};
use controller::store::{Store, Trust, key::DEVELOPMENT_KEY};
use inference::BearingMaterial;
use link::update::{ModelSource, UpdateAnswer, UpdateRefusal, UpdateRequest, UpdateStatus};
use proptest::prelude::*;

type Slots = Flash<{ 2 * HALF }>;

fn store() -> Store<Slots> {
    Store::start(Flash::new(), BOARD, &[DEVELOPMENT_KEY], Trust::default()).0
}

/// Effect of the line on a request.
#[derive(Clone, Copy, Debug)]
enum Fate {
    Arrives,
    IsLost,
    ArrivesTwice,
    AnswerIsLost,
    /// An older request arrives after it once more.
    OlderOneFollows(u8),
    /// The controller is reset after it.
    Reset,
}

fn fate() -> impl Strategy<Value = Fate> {
    prop_oneof![
        6 => Just(Fate::Arrives),
        1 => Just(Fate::IsLost),
        1 => Just(Fate::ArrivesTwice),
        1 => Just(Fate::AnswerIsLost),
        1 => any::<u8>().prop_map(Fate::OlderOneFollows),
        1 => Just(Fate::Reset),
    ]
}

/// Sends a request over the line; the host repeats it until it is answered.
fn ask(
    store: &mut Store<Slots>,
    sent: &mut Vec<UpdateRequest>,
    request: UpdateRequest,
    fate: Fate,
) -> Option<UpdateAnswer> {
    sent.push(request);
    match fate {
        Fate::Arrives => Some(store.serve(&request, true).answer),
        Fate::IsLost => None,
        Fate::AnswerIsLost => {
            store.serve(&request, true);
            None
        }
        Fate::ArrivesTwice => {
            store.serve(&request, true);
            Some(store.serve(&request, true).answer)
        }
        Fate::OlderOneFollows(back) => {
            let answer = store.serve(&request, true).answer;
            let older = sent[sent.len() - 1 - usize::from(back) % sent.len()];
            store.serve(&older, true);
            Some(answer)
        }
        Fate::Reset => {
            let flash = std::mem::replace(store, self::store()).into_memory();
            *store = Store::start(flash.restart(None, 1), BOARD, &[DEVELOPMENT_KEY], Trust::default()).0;
            None
        }
    }
}

fn runs(status: &UpdateStatus, package: &Package) -> bool {
    matches!(status.running, ModelSource::Slot { version, .. } if version == package.manifest.version)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn the_update_completes(fates in prop::collection::vec(fate(), 64)) {
        let package = Package::new(BearingMaterial::Plastic, 5);
        let mut store = store();
        let mut sent = Vec::new();
        let mut fates = fates.into_iter().cycle();
        let mut request = UpdateRequest::Status;
        for _ in 0..3000 {
            // The host's next request depends only on the answers.
            request = match ask(&mut store, &mut sent, request, fates.next().unwrap()) {
                None => UpdateRequest::Status,
                Some(UpdateAnswer::Status(status)) if runs(&status, &package) => {
                    prop_assert!(runs(&store.status(), &package));
                    prop_assert_eq!(store.status().refused, store.status().refused);
                    return Ok(());
                }
                Some(UpdateAnswer::Status(UpdateStatus { receiving: Some(receiving), .. })) => {
                    if receiving.next_offset < receiving.length {
                        package.chunk(receiving.next_offset)
                    } else {
                        UpdateRequest::Finish
                    }
                }
                Some(_) => package.begin(),
            };
        }
        prop_assert!(false, "3000 requests were not enough for {} chunks", package.payload.len() / 128);
    }
}

#[test]
fn chunks_in_any_other_order_change_nothing() {
    let package = Package::new(BearingMaterial::Babbitt, 2);
    let mut store = store();
    assert_eq!(store.serve(&package.chunk(0), false).answer, UpdateAnswer::Refused(UpdateRefusal::NotBegun));
    store.serve(&package.begin(), false);
    let steps = |store: Store<Slots>| store.into_memory().steps;
    for offset in package.offsets().rev().take(20) {
        let UpdateAnswer::Status(status) = store.serve(&package.chunk(offset), false).answer else {
            panic!("a chunk out of order is no refusal");
        };
        assert_eq!(status.receiving.unwrap().next_offset, 0);
    }
    let unfinished = UpdateAnswer::Refused(UpdateRefusal::Unfinished { next_offset: 0 });
    assert_eq!(store.serve(&UpdateRequest::Finish, false).answer, unfinished);
    // The manifest and the signature, 40 words, and the erasure before: nothing else was written.
    assert_eq!(steps(store), 48);
}

#[test]
fn after_a_reset_the_update_continues_where_it_was() {
    let package = Package::new(BearingMaterial::Babbitt, 2);
    let mut store = store();
    store.serve(&package.begin(), false);
    for offset in package.offsets().take(30) {
        store.serve(&package.chunk(offset), false);
    }
    let flash = store.into_memory().restart(None, 1);
    let (mut store, _) = Store::start(flash, BOARD, &[DEVELOPMENT_KEY], Trust::default());
    assert_eq!(store.status().receiving, None);
    let UpdateAnswer::Status(status) = store.serve(&package.begin(), false).answer else { panic!("refused") };
    // The last chunk may have been interrupted, so it is requested again.
    assert_eq!(status.receiving.unwrap().next_offset, 29 * 128);
}
