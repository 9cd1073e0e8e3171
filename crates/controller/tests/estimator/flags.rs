//! Every flag is raised with its cause and cleared after it. A clean orbit raises none.

use crate::orbit::{Orbit, PERIOD_US};
use controller::estimator::{STUCK_SAMPLES, WINDOW, flags_of};
use controller::flags::{
    IMPLAUSIBLE_POSITION, JUMP, ONSET_NOT_SEEN, SENSOR_FAULT, SEQUENCE_GAP, STUCK, TIME_FAULT, WINDOW_FILLING,
};
use inference::{BearingMaterial, Flags};
use link::SensorFrame;

/// First sample of a stimulus, long after the start.
const BEGIN: u32 = 400;
/// Samples after which the networks no longer depend on earlier ones.
const NETWORK_WINDOW: u32 = inference::WINDOW as u32;

/// Starts without contact, then has one contact in every period of 30 Hz, so that every onset is
/// seen. No flag once the networks are warm.
fn clean(bearing: BearingMaterial) -> Orbit {
    Orbit {
        mean_deformation_m: 5e-6,
        deformation_swing_m: 15e-6,
        deformation_phase_rad: -1.9,
        ..Orbit::swinging(bearing)
    }
}

/// Flags of every sample of an orbit whose frames a disturbance changes.
fn flags(orbit: &Orbit, count: u32, disturb: impl Fn(u32, &mut SensorFrame)) -> Vec<Flags> {
    let mut estimator = orbit.estimator();
    (0..count)
        .map(|index| {
            let mut frame = orbit.frame(index);
            disturb(index, &mut frame);
            flags_of(&estimator.step(&frame))
        })
        .collect()
}

/// The samples at which a flag is raised.
fn raised(flags: &[Flags], flag: Flags) -> Vec<u32> {
    flags.iter().zip(0..).filter(|(f, _)| f.contains(flag)).map(|(_, index)| index).collect()
}

#[test]
fn a_clean_orbit_warms_up_and_then_carries_no_flag() {
    for bearing in BearingMaterial::ALL {
        let flags = flags(&clean(bearing), 2000, |_, _| {});
        let filling = raised(&flags, WINDOW_FILLING);
        assert_eq!(filling, (0..WINDOW as u32 - 1).collect::<Vec<_>>());
        let warming = raised(&flags, Flags::WARMING_UP);
        assert_eq!(warming, (0..NETWORK_WINDOW - 1).collect::<Vec<_>>());
        for (flag, index) in flags.iter().zip(0_u32..).skip(WINDOW - 1) {
            assert_eq!(*flag, Flags::NONE, "{bearing:?}, sample {index}");
        }
    }
}

#[test]
fn a_position_outside_the_bearing_is_implausible() {
    // The journal is smoothly too far out: no other check fails.
    let orbit =
        Orbit { mean_deformation_m: 510e-6, deformation_swing_m: 20e-6, ..clean(BearingMaterial::Babbitt) };
    let flags = flags(&orbit, 1000, |_, _| {});
    for (index, flag) in (0..).zip(&flags) {
        let outside = orbit.truth(index).deformation_m > 500e-6;
        assert_eq!(flag.contains(IMPLAUSIBLE_POSITION), outside, "sample {index}");
        assert!(!flag.intersects(JUMP | STUCK | SEQUENCE_GAP | TIME_FAULT), "sample {index}");
    }
    let count = raised(&flags, IMPLAUSIBLE_POSITION).len();
    assert!((1..1000).contains(&count), "{count} samples");
}

#[test]
fn a_jump_of_any_sensor_restarts_the_window() {
    let orbit = clean(BearingMaterial::Babbitt);
    let jumps: [fn(&mut SensorFrame); 3] = [
        |frame| frame.journal_y_nm += 80_000,
        |frame| frame.journal_z_nm += 80_000,
        |frame| frame.shaft_angle_nrad += 20_000_000,
    ];
    for (jump, sensor) in jumps.into_iter().zip(["y", "z", "angle"]) {
        let flags = flags(&orbit, 1000, |index, frame| {
            if index == BEGIN {
                jump(frame)
            }
        });
        assert_eq!(raised(&flags, JUMP), [BEGIN, BEGIN + 1], "{sensor}: there and back");
        restarted_once(&flags, BEGIN + 1, sensor);
    }
}

#[test]
fn a_missing_sample_is_a_gap_in_sequence_and_time() {
    let orbit = clean(BearingMaterial::Plastic);
    let mut estimator = orbit.estimator();
    let kept = (0..1000).filter(|index| *index != BEGIN);
    let flags: Vec<_> = kept.map(|index| flags_of(&estimator.step(&orbit.frame(index)))).collect();
    assert_eq!(raised(&flags, SEQUENCE_GAP), [BEGIN]);
    assert_eq!(raised(&flags, TIME_FAULT), [BEGIN]);
    assert!(raised(&flags, JUMP).is_empty());
    restarted_once(&flags, BEGIN, "missing");
}

#[test]
fn a_wrong_sequence_number_alone_is_a_gap() {
    let later = |index: u32, frame: &mut SensorFrame| frame.sequence += u32::from(index >= BEGIN);
    let flags = flags(&clean(BearingMaterial::Babbitt), 1000, later);
    assert_eq!(raised(&flags, SEQUENCE_GAP), [BEGIN]);
    assert!(raised(&flags, TIME_FAULT).is_empty());
    restarted_once(&flags, BEGIN, "sequence");
}

#[test]
fn time_that_does_not_advance_by_the_period_is_a_fault() {
    for late_us in [PERIOD_US / 2 + 1, 5 * PERIOD_US, u32::MAX - 70] {
        let later = |index, frame: &mut SensorFrame| {
            if index >= BEGIN {
                frame.time_us = frame.time_us.wrapping_add(late_us);
            }
        };
        let flags = flags(&clean(BearingMaterial::Babbitt), 1000, later);
        assert_eq!(raised(&flags, TIME_FAULT), [BEGIN], "{late_us} us");
        assert!(raised(&flags, SEQUENCE_GAP).is_empty());
        restarted_once(&flags, BEGIN, "time");
    }
}

/// Checks for one restart at `last`: the window fills again, the networks warm up again, and no
/// flag is left at the end.
fn restarted_once(flags: &[Flags], last: u32, what: &str) {
    let after =
        |flag: Flags| raised(flags, flag).into_iter().filter(|index| *index >= last).collect::<Vec<_>>();
    let filling = after(WINDOW_FILLING);
    assert_eq!(filling, (last..last + WINDOW as u32 - 1).collect::<Vec<_>>(), "{what}");
    assert_eq!(after(Flags::WARMING_UP), (last..last + NETWORK_WINDOW - 1).collect::<Vec<_>>(), "{what}");
    assert_eq!(flags.last(), Some(&Flags::NONE), "{what}");
}

#[test]
fn a_sensor_without_a_change_is_stuck() {
    let orbit = clean(BearingMaterial::Plastic);
    let held = orbit.frame(BEGIN);
    let end = BEGIN + 2 * u32::from(STUCK_SAMPLES);
    let holds: [fn(&mut SensorFrame, &SensorFrame); 2] = [
        |frame, held| frame.shaft_angle_nrad = held.shaft_angle_nrad,
        |frame, held| frame.journal_y_nm = held.journal_y_nm,
    ];
    for (hold, sensor) in holds.into_iter().zip(["angle", "y"]) {
        let stuck = |index, frame: &mut SensorFrame| {
            if (BEGIN..end).contains(&index) {
                hold(frame, &held);
            }
        };
        let flags = flags(&orbit, 1000, stuck);
        let expected: Vec<_> = (BEGIN + u32::from(STUCK_SAMPLES) - 1..end).collect();
        assert_eq!(raised(&flags, STUCK), expected, "{sensor}");
    }
}

#[test]
fn a_contact_that_was_there_before_has_an_unseen_onset_until_it_ends() {
    for bearing in BearingMaterial::ALL {
        // In contact at the start; 20 ms later the first gap, after which every onset is seen.
        let orbit = Orbit { deformation_phase_rad: 0.3, ..clean(bearing) };
        let flags = flags(&orbit, 1000, |_, _| {});
        let first_gap = (0..).find(|index| orbit.truth(*index).deformation_m < 0.0).unwrap();
        let unseen = raised(&flags, ONSET_NOT_SEEN);
        assert_eq!(unseen.first(), Some(&0));
        assert!(unseen.last().unwrap().abs_diff(first_gap) <= 1, "{unseen:?} for {first_gap}");
        assert_eq!(unseen.len() as u32, unseen.last().unwrap() + 1, "in one piece");
    }
}

#[test]
fn a_gap_in_the_samples_during_contact_loses_the_onset() {
    let orbit = clean(BearingMaterial::Babbitt);
    let touching = (BEGIN..).find(|i| orbit.truth(*i).deformation_m > 15e-6).unwrap();
    let later = |index: u32, frame: &mut SensorFrame| frame.sequence += u32::from(index >= touching);
    let flags = flags(&orbit, touching + 600, later);
    let apart = (touching..).find(|i| orbit.truth(*i).deformation_m < 0.0).unwrap();
    let unseen = raised(&flags, ONSET_NOT_SEEN);
    assert_eq!(unseen.first(), Some(&touching));
    assert!(unseen.last().unwrap().abs_diff(apart) <= 1, "{unseen:?} for {apart}");
}

#[test]
fn inputs_outside_the_training_range_are_flagged() {
    let base = clean(BearingMaterial::Babbitt);
    let still = Orbit { mean_deformation_m: 20e-6, deformation_swing_m: 1e-6, swing_rad: 0.3, ..base };
    let cases = [
        (Flags::OUTSIDE_CLEARANCE, Orbit { clearance_m: 2e-3, swing_rad: 0.2, ..base }),
        (Flags::OUTSIDE_CLEARANCE, Orbit { clearance_m: 40e-6, ..base }),
        (Flags::OUTSIDE_DEFORMATION, Orbit { mean_deformation_m: 90e-6, ..still }),
        (Flags::OUTSIDE_FORCE, Orbit { mean_deformation_m: 160e-6, ..still }),
        (Flags::OUTSIDE_SLIDING_SPEED, Orbit { shaft_speed_rad_s: 5.0, ..still }),
        // 15 mm/s over the floor of 1 mm/s.
        (Flags::OUTSIDE_RATE_RATIO, Orbit { deformation_swing_m: 15e-6, deformation_hz: 160.0, ..still }),
    ];
    for (flag, orbit) in cases {
        let orbit = Orbit { unseen_approach_m_s: 1e-3, ..orbit };
        let found = flags(&orbit, 1000, |_, _| {});
        assert!(!raised(&found, flag).is_empty(), "{flag:?}: {orbit:?}");
        assert!(!found.iter().any(|f| f.intersects(SENSOR_FAULT)), "{orbit:?}");
    }
    let inside = flags(&still, 1000, |_, _| {});
    assert!(!inside.iter().any(|flag| flag.intersects(Flags::OUTSIDE_TRAINING)), "the ground they stand on");
}
