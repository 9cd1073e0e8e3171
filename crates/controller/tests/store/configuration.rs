//! Power failure at every step of saving a configuration: the old or the new one is read, never a
//! mixture.

use crate::flash::{Flash, HALF};
use controller::store::Keeper;
use controller::store::keeper::{KeepError, Kind, MAX_VALUE_LENGTH, RECORD};

/// Two halves of three records each: every third write erases.
type Places = PlacesOf<4>;
/// The same with flash words of this length, bytes.
type PlacesOf<const WORD: usize> = Flash<{ 6 * RECORD }, WORD>;
/// A value whose parts must belong together.
type Value = [u64; 16];

fn value(number: u64) -> Value {
    std::array::from_fn(|part| number.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ part as u64)
}

fn read<const WORD: usize>(flash: PlacesOf<WORD>) -> (Keeper<PlacesOf<WORD>>, Option<Value>) {
    let mut keeper = Keeper::start(flash);
    let value = keeper.value(Kind::Configuration, 1);
    (keeper, value)
}

#[test]
fn a_blank_or_foreign_memory_contains_no_value() {
    assert_eq!(read(Places::new()).1, None);
    let mut foreign = Places::new();
    for (at, byte) in foreign.bytes.iter_mut().enumerate() {
        *byte = (at * 7 % 251) as u8;
    }
    let (mut keeper, found) = read(foreign);
    assert_eq!(found, None);
    keeper.keep(Kind::Configuration, 1, &value(5)).unwrap();
    assert_eq!(read(keeper.into_memory()).1, Some(value(5)));
}

#[test]
fn power_lost_at_any_step_leaves_the_old_value_or_the_new_one() {
    every_cut_of_a_value::<4>();
    every_cut_of_a_value::<32>();
}

fn every_cut_of_a_value<const WORD: usize>() {
    let mut flash: PlacesOf<WORD> = Flash::new();
    for number in 1..12_u64 {
        let (mut keeper, old) = read(flash.clone().restart(None, 1));
        assert_eq!(old, (number > 1).then(|| value(number - 1)));
        keeper.keep(Kind::Configuration, 1, &value(number)).unwrap();
        let whole = keeper.into_memory();
        for cut in 0..whole.steps {
            let (mut keeper, _) = read(flash.clone().restart(Some(cut), number << 32 | cut as u64));
            assert_eq!(keeper.keep(Kind::Configuration, 1, &value(number)), Err(KeepError::Flash));
            let (mut keeper, found) = read(keeper.into_memory().restart(None, 1));
            // The last word is the checksum: without all of its bits the record is invalid.
            let expected = if found == Some(value(number)) { Some(value(number)) } else { old };
            assert_eq!(found, expected, "value {number}, step {cut} of {}", whole.steps);
            keeper.keep(Kind::Configuration, 1, &value(1000 + number)).unwrap();
            assert_eq!(read(keeper.into_memory()).1, Some(value(1000 + number)));
        }
        flash = whole;
    }
}

#[test]
fn a_value_of_another_form_is_not_read_and_one_too_long_is_not_saved() {
    let mut keeper = Keeper::start(Flash::<{ 2 * HALF }>::new());
    keeper.keep(Kind::Configuration, 1, &value(1)).unwrap();
    assert_eq!(keeper.value::<Value>(Kind::Configuration, 2), None);
    assert_eq!(keeper.value::<Value>(Kind::Configuration, 1), Some(value(1)));
    let long = [[1_u8; 31]; MAX_VALUE_LENGTH / 31 + 1];
    let long: [_; 8] = long[..8].try_into().unwrap();
    assert_eq!(keeper.keep(Kind::Configuration, 1, &long), Err(KeepError::TooLong));
    assert_eq!(keeper.value::<Value>(Kind::Configuration, 1), Some(value(1)));
}

#[test]
fn places_are_written_in_turn_and_each_word_once_between_erasures() {
    let (mut keeper, _) = read(PlacesOf::<32>::new());
    for number in 1..40 {
        keeper.keep(Kind::Configuration, 1, &value(number)).unwrap();
        let (again, found) = read(keeper.into_memory());
        assert_eq!(found, Some(value(number)));
        keeper = again;
    }
}

/// Returns the value of each kind.
fn values<const WORD: usize>(
    flash: PlacesOf<WORD>,
) -> (Keeper<PlacesOf<WORD>>, [Option<Value>; Kind::ALL.len()]) {
    let mut keeper = Keeper::start(flash);
    let found = Kind::ALL.map(|kind| keeper.value::<Value>(kind, 1));
    (keeper, found)
}

#[test]
fn power_lost_at_any_step_mixes_no_values_of_different_kinds() {
    every_cut_of_different_kinds::<4>();
    every_cut_of_different_kinds::<32>();
}

fn every_cut_of_different_kinds<const WORD: usize>() {
    let mut flash: PlacesOf<WORD> = Flash::new();
    for number in 1..16_u64 {
        let place = [0, 1, 0, 2][number as usize % 4];
        let kind = Kind::ALL[place];
        let (mut keeper, before) = values(flash.clone().restart(None, 1));
        keeper.keep(kind, 1, &value(number)).unwrap();
        let whole = keeper.into_memory();
        for cut in 0..whole.steps {
            let (mut keeper, _) = values(flash.clone().restart(Some(cut), number << 32 | cut as u64));
            assert_eq!(keeper.keep(kind, 1, &value(number)), Err(KeepError::Flash));
            let (mut keeper, found) = values(keeper.into_memory().restart(None, 1));
            let step = format!("value {number}, step {cut} of {}", whole.steps);
            for (index, (found, before)) in found.iter().zip(before).enumerate() {
                let is_new = index == place && *found == Some(value(number));
                assert!(*found == before || is_new, "{step}");
            }
            // The power fails once more, while a value of any kind is written.
            for (again, second) in Kind::ALL.into_iter().zip([cut / 2, cut, cut / 3]) {
                let flash = keeper.into_memory().restart(Some(second), cut as u64);
                let (mut retried, _) = values(flash);
                let _ = retried.keep(again, 1, &value(2000 + number));
                let (retried, found) = values(retried.into_memory().restart(None, 1));
                for (found, old) in found.into_iter().zip(before) {
                    let new = [value(number), value(2000 + number)].map(Some);
                    assert!(found == old || new.contains(&found), "{step}");
                }
                keeper = retried;
            }
            keeper.keep(kind, 1, &value(1000)).unwrap();
            let (_, found) = values(keeper.into_memory());
            for (index, (found, before)) in found.into_iter().zip(before).enumerate() {
                if index == place {
                    assert_eq!(found, Some(value(1000)), "{step}");
                } else {
                    assert!(found == before || found == Some(value(2000 + number)), "{step}");
                }
            }
        }
        flash = whole;
    }
}

#[test]
fn an_unchanged_value_is_not_written_again() {
    let mut keeper = Keeper::start(Places::new());
    keeper.keep(Kind::Configuration, 1, &value(1)).unwrap();
    let written = keeper.into_memory();
    let mut keeper = Keeper::start(written.clone().restart(None, 1));
    for _ in 0..100 {
        keeper.keep(Kind::Configuration, 1, &value(1)).unwrap();
    }
    assert_eq!(keeper.into_memory().steps, 0);
    // Another layout is another value.
    let mut keeper = Keeper::start(written);
    keeper.keep(Kind::Configuration, 2, &value(1)).unwrap();
    assert_eq!(keeper.value(Kind::Configuration, 2), Some(value(1)));
}

#[test]
fn a_value_whose_write_was_reported_as_failed_does_not_outlive_a_later_one() {
    for number in 1..8 {
        let mut keeper = Keeper::start(Places::new());
        for earlier in 0..number {
            keeper.keep(Kind::Configuration, 1, &value(earlier)).unwrap();
        }
        let mut flash = keeper.into_memory();
        flash.failing_write = Some((0, RECORD / 4));
        let mut keeper = Keeper::start(flash);
        assert_eq!(keeper.keep(Kind::Configuration, 1, &value(100)), Err(KeepError::Flash));
        keeper.keep(Kind::Configuration, 1, &value(200)).unwrap();
        assert_eq!(read(keeper.into_memory()).1, Some(value(200)), "after {number} values");
    }
}

#[test]
fn a_value_that_was_corrupted_is_not_copied_as_if_it_were_intact() {
    let mut keeper = Keeper::start(Places::new());
    keeper.keep(Kind::Trust, 1, &value(1)).unwrap();
    keeper.keep(Kind::Configuration, 1, &value(0)).unwrap();
    keeper.keep(Kind::Configuration, 1, &value(2)).unwrap();
    // The half is full, and a bit of the first record flips.
    keeper.memory_mut().bytes[40] ^= 1;
    assert_eq!(keeper.value::<Value>(Kind::Trust, 1), None);
    assert_eq!(keeper.keep(Kind::Configuration, 1, &value(3)), Err(KeepError::Flash));
    let mut keeper = Keeper::start(keeper.into_memory());
    let found = [Kind::Trust, Kind::Configuration].map(|kind| keeper.value::<Value>(kind, 1));
    assert_eq!(found, [None, Some(value(2))]);
}

#[test]
fn power_lost_after_a_failed_write_loses_no_value() {
    let mut keeper = Keeper::start(Places::new());
    keeper.keep(Kind::Trust, 1, &value(1)).unwrap();
    keeper.keep(Kind::Configuration, 1, &value(0)).unwrap();
    keeper.keep(Kind::Configuration, 1, &value(2)).unwrap();
    let full = keeper.into_memory();
    // In the other half the copy of the first value is written, and the new record fails.
    for (cut, words) in (0..200).flat_map(|cut| [0, 30, RECORD / 4].map(|words| (cut, words))) {
        let mut flash = full.clone().restart(None, 1);
        flash.failing_write = Some((1, words));
        let mut keeper = Keeper::start(flash);
        assert_eq!(keeper.keep(Kind::Configuration, 1, &value(3)), Err(KeepError::Flash));
        let steps = keeper.memory_mut().steps;
        keeper.memory_mut().fails_at = Some(steps + cut);
        let _ = keeper.keep(Kind::Configuration, 1, &value(4));
        let mut keeper = Keeper::start(keeper.into_memory().restart(None, 1));
        assert_eq!(keeper.value(Kind::Trust, 1), Some(value(1)), "step {cut}, {words} words");
        let found: Option<Value> = keeper.value(Kind::Configuration, 1);
        assert!([2, 3, 4].map(|number| Some(value(number))).contains(&found), "step {cut}, {words} words");
    }
}
