//! Each finding of a channel alone: when it is raised, when it is not, and how long it lasts.

use super::*;

impl Findings {
    /// Returns the channels with an event, one bit each. Kinds: 0 missing, 1 saturated, 2 stuck, 3
    /// noisy, 4 jumped.
    fn channels(&self, kind: u32) -> u8 {
        (self.events >> (4 * (kind % 8)) & 0xf) as u8
    }
}

const CLEARANCE_NM: u32 = 500_000;

/// A lively but possible sample.
fn frame(sequence: u32) -> SensorFrame {
    let wobble = i32::try_from(sequence % 7).unwrap() * 300;
    SensorFrame {
        sequence,
        time_us: sequence.wrapping_mul(100),
        journal_y_nm: 100_000 + wobble,
        journal_z_nm: -490_000 - wobble,
        shaft_angle_nrad: 5_000 * wobble,
        load_force_mn: 10_000_000,
    }
}

fn after_ten() -> Plausibility {
    let mut watch = Plausibility::new(CLEARANCE_NM, 100);
    for sequence in 0..10 {
        assert_eq!(watch.check(&frame(sequence)), Flags::NONE);
    }
    watch
}

#[test]
fn sequence_and_time_may_wrap() {
    let mut watch = Plausibility::new(CLEARANCE_NM, 100);
    for sequence in (u32::MAX - 5..=u32::MAX).chain(0..5) {
        assert_eq!(watch.check(&frame(sequence)), Flags::NONE, "{sequence}");
    }
}

#[test]
fn lost_and_repeated_samples_are_detected() {
    assert!(after_ten().check(&frame(11)).contains(SEQUENCE_GAP | TIME_FAULT));
    assert!(after_ten().check(&frame(9)).contains(SEQUENCE_GAP | TIME_FAULT));
}

#[test]
fn time_must_advance_by_the_period() {
    for (time_us, fault) in
        [(1000, false), (1049, false), (951, false), (1051, true), (900, true), (899, true)]
    {
        let flags = after_ten().check(&SensorFrame { time_us, ..frame(10) });
        assert_eq!(flags, TIME_FAULT.when(fault), "{time_us}");
    }
}

#[test]
fn impossible_steps_are_detected() {
    let next = frame(10);
    for (jumped, channel) in [
        (SensorFrame { journal_y_nm: next.journal_y_nm + 60_000, ..next }, 0),
        (SensorFrame { journal_z_nm: next.journal_z_nm + 60_000, ..next }, 1),
        (SensorFrame { shaft_angle_nrad: next.shaft_angle_nrad - 20_000_000, ..next }, 2),
    ] {
        let mut watch = after_ten();
        assert_eq!(watch.check(&jumped), JUMP);
        assert_eq!(watch.findings().channels(4), 1 << channel);
    }
}

#[test]
fn a_journal_outside_the_bearing_is_detected() {
    let mut watch = Plausibility::new(CLEARANCE_NM, 100);
    let at = |y, z| SensorFrame { journal_y_nm: y, journal_z_nm: z, ..SensorFrame::default() };
    assert_eq!(watch.check(&at(600_000, -799_000)), Flags::NONE);
    let mut watch = Plausibility::new(CLEARANCE_NM, 100);
    assert_eq!(watch.check(&at(600_000, -801_000)), IMPLAUSIBLE_POSITION);
    assert!(watch.check(&at(i32::MIN, i32::MIN)).contains(IMPLAUSIBLE_POSITION | JUMP));
}

#[test]
fn one_stuck_sensor_is_detected_while_the_others_move() {
    let mut watch = Plausibility::new(CLEARANCE_NM, 100);
    for sequence in 0..200 {
        let stuck = SensorFrame { journal_z_nm: -490_123, ..frame(sequence) };
        assert_eq!(watch.check(&stuck), STUCK.when(sequence >= u32::from(STUCK_SAMPLES) - 1), "{sequence}");
    }
    assert_eq!(watch.check(&frame(200)), Flags::NONE);
}

fn limited() -> Plausibility {
    let mut watch = Plausibility::new(CLEARANCE_NM, 100);
    watch.set_limits(&Limits {
        stuck_samples: [100, 100, 100, 50],
        noise: [2_000, 2_000, 5_000_000, 50_000],
        rail: [1_000_000, 1_000_000, u32::MAX, 20_000_000],
        swing: SwingLimit::NONE,
    });
    watch
}

/// White noise of one standard deviation, the sum of four uniform draws.
fn noise(seed: u32) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        let mut draw = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24) - 0.5
        };
        (draw() + draw() + draw() + draw()) * 3.0_f64.sqrt()
    }
}

#[test]
fn a_noisy_channel_is_detected_above_its_limit_and_not_below() {
    for (sigma_nm, noisy) in [(200.0, false), (1_600.0, false), (2_600.0, true), (9_000.0, true)] {
        let (mut watch, mut draw) = (limited(), noise(7));
        let mut found = 0;
        for sequence in 0..2_000 {
            let z = -490_000 + (sigma_nm * draw()) as i32;
            watch.check(&SensorFrame { journal_z_nm: z, load_force_mn: sequence as i32, ..frame(sequence) });
            assert_eq!(watch.findings().channels(3) & !0b10, 0, "only z");
            found += u32::from(sequence >= 1_000 && watch.findings().channels(3) == 0b10);
        }
        if noisy { assert!(found > 900, "{sigma_nm}: {found}") } else { assert_eq!(found, 0, "{sigma_nm}") }
    }
}

#[test]
fn one_outlier_is_a_jump_and_no_noise() {
    let mut watch = limited();
    for sequence in 0..500 {
        let out = if sequence == 300 { 400_000 } else { 0 };
        let frame = frame(sequence);
        let sample = SensorFrame {
            journal_y_nm: frame.journal_y_nm / 8 + out,
            load_force_mn: sequence as i32,
            ..frame
        };
        watch.check(&sample);
        assert_eq!(watch.findings().channels(4), u8::from((300..302).contains(&sequence)));
        assert_eq!(watch.findings().channels(3), 0, "{sequence}");
    }
}

#[test]
fn rails_and_the_status_of_the_drivers_are_detected() {
    let mut watch = limited();
    let at = |sequence, y| SensorFrame {
        journal_y_nm: y,
        journal_z_nm: 0,
        load_force_mn: -20_000_000,
        ..frame(sequence)
    };
    let flags = watch.check(&at(0, -999_999));
    assert_eq!(
        (flags, watch.findings().channels(1)),
        (Flags::NONE, 0b1000),
        "the load does not concern the motion"
    );
    assert_eq!(watch.findings().flags, SENSOR_SATURATED);
    assert!(watch.check(&at(1, -1_000_000)).contains(SENSOR_SATURATED));
    assert_eq!(watch.findings().channels(1), 0b1001);

    let mut watch = limited();
    let channel = link::track::SensorChannel::JournalZ;
    watch.set_status(SensorStatus::GOOD.missing(channel));
    assert_eq!(watch.check(&frame(0)), SENSOR_MISSING);
    assert_eq!(watch.check(&frame(1)), Flags::NONE, "a status is for one sample");
    watch.set_status(SensorStatus::GOOD.at_rail(channel));
    assert_eq!(watch.check(&frame(2)), SENSOR_SATURATED);
    let none = SensorFrame { load_force_mn: i32::MIN, ..frame(3) };
    assert_eq!((watch.check(&none), watch.findings().channels(0)), (Flags::NONE, 0b1000));
}

#[test]
fn a_load_that_jumps_or_is_stuck_does_not_restart_the_motion() {
    let mut watch = limited();
    for sequence in 0..200 {
        let load_force_mn = if sequence == 10 { 8_000_000 } else { 10_000_000 };
        let flags = watch.check(&SensorFrame { load_force_mn, ..frame(sequence) });
        assert_eq!(flags, Flags::NONE);
        assert_eq!(watch.findings().channels(4), u8::from((10..12).contains(&sequence)) << 3);
        assert_eq!(watch.findings().channels(2), u8::from(sequence >= 11 + 49) << 3, "{sequence}");
    }
}

#[test]
fn beyond_a_limit_is_farther_from_zero_either_way() {
    for limit in [0, 1, 1_000_000, LARGEST] {
        for value in
            [0, 1, -1, 2, -2, 1_000_000, -1_000_000, 1_000_001, -1_000_001, i32::MAX, -i32::MAX, i32::MIN]
        {
            assert_eq!(is_beyond(value, limit), value.unsigned_abs() > limit, "{value}, {limit}");
        }
    }
}

#[test]
fn a_step_that_the_journal_cannot_bend_into_is_a_jump_once() {
    for (step_nm, expected) in [(13_000, JUMP), (-13_000, JUMP), (11_000, Flags::NONE)] {
        let mut watch = Plausibility::new(500_000, 100);
        watch.set_limits(&Limits { noise: [2_000, 2_000, u32::MAX, u32::MAX], ..Limits::NONE });
        // A swing of 0.1 m/s from the first sample on.
        let at = |index: u32, off_nm: i32| SensorFrame {
            sequence: index,
            time_us: 100 * index,
            journal_y_nm: 10_000 * index as i32 - 300_000 + off_nm,
            journal_z_nm: -400_000 - index as i32,
            shaft_angle_nrad: index as i32,
            load_force_mn: 0,
        };
        for index in 0..20 {
            assert_eq!(watch.check(&at(index, 0)), Flags::NONE, "{index}");
        }
        assert_eq!(watch.check(&at(20, step_nm)), expected);
        for index in 21..40 {
            assert_eq!(watch.check(&at(index, step_nm)), Flags::NONE, "{index}: it stays");
        }
        // After lost samples the step of the swing is no bend.
        assert!(watch.check(&at(41, step_nm)).contains(SEQUENCE_GAP));
        assert_eq!(watch.check(&at(42, step_nm)), Flags::NONE);
    }
}

#[test]
fn a_long_period_leaves_the_journal_more_to_bend() {
    let mut watch = Plausibility::new(500_000, 1_000);
    watch.set_limits(&Limits { noise: [2_000, 2_000, u32::MAX, u32::MAX], ..Limits::NONE });
    // 150 m/s2 for 40 samples of 1 ms, there and back: 0.15 mm a sample squared.
    for index in 0..40_u32 {
        let frame = SensorFrame {
            sequence: index,
            time_us: 1_000 * index,
            journal_y_nm: 75_000 * (index % 2) as i32,
            journal_z_nm: -400_000 - index as i32,
            shaft_angle_nrad: index as i32,
            load_force_mn: 0,
        };
        assert!(!watch.check(&frame).contains(JUMP), "{index}");
    }
}
