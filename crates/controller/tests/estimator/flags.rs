//! Every flag is raised with its cause and cleared after it. A clean run raises none.

use crate::run::{Errors, Point, START};
use controller::estimator::{STUCK_SAMPLES, flags_of};
use controller::flags::{
    CONVERGING, IMPLAUSIBLE_POSITION, JUMP, MODEL_MISFIT, NETWORK_OUTSIDE_LAW, NOT_STARTED, SENSOR_FAULT,
    SEQUENCE_GAP, STUCK, TIME_FAULT,
};
use inference::Flags;
use link::{ContactSource, SensorFrame};
use worlds::World;

/// First sample of a stimulus, long after the start.
const BEGIN: u32 = 2_500;
/// Samples of a run.
const COUNT: u32 = 4_000;
/// Samples after which the networks no longer depend on earlier ones.
const NETWORK_WINDOW: u32 = inference::WINDOW as u32;

fn frames(point: &Point, world: &World) -> Vec<SensorFrame> {
    point.read(world, 7, f64::from(COUNT) * 1e-4).1
}

/// Flags of every sample of a run whose frames a disturbance changes.
fn flags(disturb: impl Fn(u32, &mut SensorFrame)) -> Vec<Flags> {
    let point = Point::DEFAULT;
    let mut estimator = point.estimator();
    let mut disturbed = |(index, mut frame): (u32, SensorFrame)| {
        disturb(index, &mut frame);
        flags_of(&estimator.step(&frame))
    };
    (0..).zip(frames(&point, &point.world())).map(&mut disturbed).collect()
}

/// The samples at which a flag is raised.
fn raised(flags: &[Flags], flag: Flags) -> Vec<u32> {
    flags.iter().zip(0..).filter(|(f, _)| f.contains(flag)).map(|(_, index)| index).collect()
}

#[test]
fn a_clean_run_converges_and_then_carries_no_flag() {
    for point in Point::all() {
        let mut estimator = point.estimator();
        let flags: Vec<Flags> =
            frames(&point, &point.world()).iter().map(|frame| flags_of(&estimator.step(frame))).collect();
        assert_eq!(raised(&flags, Flags::WARMING_UP), (0..NETWORK_WINDOW - 1).collect::<Vec<_>>());
        assert!(flags[0].contains(CONVERGING) && raised(&flags, NOT_STARTED).is_empty(), "{point:?}");
        for (flag, index) in flags.iter().zip(0_usize..).skip(START) {
            let without = flag.bits() & !CONVERGING.bits();
            assert_eq!(without, 0, "{point:?}, sample {index}: {without:x}");
        }
        let late = raised(&flags[4 * START..], CONVERGING);
        assert!(late.is_empty(), "{point:?}: {late:?}");
    }
}

#[test]
fn before_a_complete_sample_the_estimate_is_unknown() {
    let mut estimator = Point::DEFAULT.estimator();
    for (sequence, frame) in (0..).zip(frames(&Point::DEFAULT, &Point::DEFAULT.world())) {
        let journal_z_nm = if sequence < 20 { i32::MIN } else { frame.journal_z_nm };
        let estimate = estimator.step(&SensorFrame { journal_z_nm, ..frame });
        assert_eq!(
            flags_of(&estimate).contains(NOT_STARTED),
            estimate.force_sd_n.is_infinite(),
            "{sequence}"
        );
        assert!(sequence < 23 || estimate.force_sd_n.is_finite(), "{sequence}");
    }
}

#[test]
fn a_position_outside_the_bearing_is_implausible() {
    // The journal is smoothly too far out: no other check fails.
    let flags = flags(|index, frame| {
        let since = index.saturating_sub(BEGIN).min(900);
        frame.journal_z_nm -= 800 * since.cast_signed();
    });
    let found = raised(&flags, IMPLAUSIBLE_POSITION);
    assert!(found.first().is_some_and(|first| (BEGIN + 500..BEGIN + 900).contains(first)), "{found:?}");
    assert!(flags.iter().all(|flag| !flag.intersects(JUMP | STUCK | SEQUENCE_GAP | TIME_FAULT)));
}

#[test]
fn a_jump_of_any_sensor_there_and_back_is_flagged_and_predicted() {
    let jumps: [fn(&mut SensorFrame); 3] = [
        |frame| frame.journal_y_nm += 80_000,
        |frame| frame.journal_z_nm += 80_000,
        |frame| frame.shaft_angle_nrad += 20_000_000,
    ];
    for (jump, sensor) in jumps.into_iter().zip(["y", "z", "angle"]) {
        let flags = flags(|index, frame| {
            if index == BEGIN {
                jump(frame);
            }
        });
        assert_eq!(raised(&flags, JUMP), [BEGIN, BEGIN + 1], "{sensor}: there and back");
        assert!(raised(&flags, MODEL_MISFIT).is_empty(), "{sensor}");
        assert_eq!(flags.last(), Some(&Flags::NONE), "{sensor}");
    }
}

#[test]
fn a_missing_sample_is_a_gap_in_sequence_and_time() {
    let mut estimator = Point::DEFAULT.estimator();
    let mut frames = frames(&Point::DEFAULT, &Point::DEFAULT.world());
    frames.remove(BEGIN as usize);
    let flags: Vec<_> = frames.iter().map(|frame| flags_of(&estimator.step(frame))).collect();
    assert_eq!(raised(&flags, SEQUENCE_GAP), [BEGIN]);
    assert_eq!(raised(&flags, TIME_FAULT), [BEGIN]);
    assert!(raised(&flags, JUMP).is_empty());
    assert_eq!(flags.last(), Some(&Flags::NONE));
}

#[test]
fn time_that_does_not_advance_by_the_period_is_a_fault() {
    for late_us in [51, 500, u32::MAX - 70] {
        let flags = flags(|index, frame| {
            if index >= BEGIN {
                frame.time_us = frame.time_us.wrapping_add(late_us);
            }
        });
        assert_eq!(raised(&flags, TIME_FAULT), [BEGIN], "{late_us} us");
        assert!(raised(&flags, SEQUENCE_GAP).is_empty());
        assert_eq!(flags.last(), Some(&Flags::NONE));
    }
}

#[test]
fn a_sensor_without_a_change_is_stuck() {
    let held = frames(&Point::DEFAULT, &Point::DEFAULT.world())[BEGIN as usize];
    let end = BEGIN + 2 * u32::from(STUCK_SAMPLES);
    let holds: [fn(&mut SensorFrame, &SensorFrame); 2] = [
        |frame, held| frame.shaft_angle_nrad = held.shaft_angle_nrad,
        |frame, held| frame.journal_y_nm = held.journal_y_nm,
    ];
    for (hold, sensor) in holds.into_iter().zip(["angle", "y"]) {
        let flags = flags(|index, frame| {
            if (BEGIN..end).contains(&index) {
                hold(frame, &held);
            }
        });
        let expected: Vec<_> = (BEGIN + u32::from(STUCK_SAMPLES) - 1..end).collect();
        assert_eq!(raised(&flags, STUCK), expected, "{sensor}");
    }
}

#[test]
fn friction_that_no_law_describes_is_a_misfit_and_widens_the_deviation() {
    let point = Point { source: ContactSource::Law, ..Point::DEFAULT };
    let world = World { stribeck_rise: 0.25, stribeck_rise_speed_m_s: 0.01, ..point.world() };
    let mut estimator = point.estimator();
    let estimates: Vec<_> = point.read(&world, 8, 1.0).1.iter().map(|frame| estimator.step(frame)).collect();
    let misfits: Vec<_> =
        estimates.iter().filter(|estimate| flags_of(estimate).contains(MODEL_MISFIT)).collect();
    assert!(misfits.len() > 20, "{}", misfits.len());
    let fitting = estimates.iter().skip(START).filter(|e| !flags_of(e).contains(MODEL_MISFIT));
    let mean = |sum: f32, count: usize| sum / count.max(1) as f32;
    let wide = mean(misfits.iter().map(|e| e.friction_torque_sd_nm).sum(), misfits.len());
    let narrow = mean(fitting.clone().map(|e| e.friction_torque_sd_nm).sum(), fitting.count());
    assert!(wide > 1.3 * narrow, "{wide} {narrow}");
}

#[test]
fn networks_far_from_the_law_are_flagged_and_the_law_is_used() {
    let follow = |source| {
        let point = Point { source, ..Point::DEFAULT };
        let (bench, mut monitor) = point.configuration();
        monitor.effective_modulus_kpa /= 2;
        let mut estimator = point.estimator_for(&bench, &monitor);
        let (rows, frames) = point.read(&point.world(), 7, 1.0);
        let estimates: Vec<_> = frames.iter().map(|frame| estimator.step(frame)).collect();
        (Errors::new(&rows, &estimates), estimates)
    };
    let (network, estimates) = follow(ContactSource::Network);
    let (law, _) = follow(ContactSource::Law);
    let outside = estimates.iter().filter(|one| flags_of(one).contains(NETWORK_OUTSIDE_LAW));
    assert!(outside.count() > 1_000);
    // The stiffness is learnt anew whenever the source changes. Only the law alone stays accurate.
    assert!(law.force_share < 0.01 && law.inside > 0.95, "{law:?}");
    assert!(network.force_share < 0.035 && network.inside > 0.8, "{network:?}");
}

#[test]
fn sensor_faults_do_not_include_the_state_of_the_estimate() {
    assert!(!SENSOR_FAULT.intersects(CONVERGING | MODEL_MISFIT | NOT_STARTED | NETWORK_OUTSIDE_LAW));
}
