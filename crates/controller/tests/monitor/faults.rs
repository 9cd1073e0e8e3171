//! Reaction of the monitor to sensors and networks that fail in the middle of a run.

use crate::run::{Truth, configuration, follow, monitor};
use controller::Monitor;
use controller::estimator::flags_of;
use controller::flags::{
    DISTRUSTED, HELD, IMPLAUSIBLE_SWING, JUMP, NETWORK_OUTSIDE_LAW, NOISY, SENSOR_MISSING, SENSOR_SATURATED,
    STUCK,
};
use inference::image::CRC_LENGTH;
use inference::image::write::seal;
use inference::{BearingMaterial, Flags, shipped};
use link::track::{SafeState, SensorChannel, SensorStatus, TrackReport};
use link::{ContactSource, EstimateFrame, SensorFrame};

/// First sample of a fault: the journal swings under load.
const BEGIN: usize = 3_000;
const SAMPLES: usize = 6_000;

fn frames() -> Vec<SensorFrame> {
    let mut frames = Truth::nominal(BearingMaterial::Babbitt).frames(5, 0).0;
    frames.truncate(SAMPLES);
    frames
}

/// Estimates of a run whose samples and status a fault changes, and the monitor after it.
fn with(fault: impl Fn(usize, &mut SensorFrame) -> SensorStatus) -> (Vec<EstimateFrame>, Monitor) {
    let mut monitor = monitor(BearingMaterial::Babbitt, |_| {});
    let estimates = frames()
        .into_iter()
        .enumerate()
        .map(|(index, mut frame)| {
            let status = fault(index, &mut frame);
            monitor.step(&frame, status)
        })
        .collect();
    (estimates, monitor)
}

fn raised(estimates: &[EstimateFrame], flag: Flags) -> Vec<usize> {
    let hits = estimates.iter().enumerate().filter(|(_, estimate)| flags_of(estimate).intersects(flag));
    hits.map(|(index, _)| index).collect()
}

fn forces(estimate: &EstimateFrame) -> [f32; 4] {
    [estimate.normal_force_n, estimate.force_y_n, estimate.force_z_n, estimate.friction_torque_nm]
}

#[test]
fn a_sound_run_is_live_from_the_first_trusted_sample_and_holds_nothing() {
    for bearing in BearingMaterial::ALL {
        for (seed, load_n) in [(0, 10e3), (1, 1e3), (2, -10e3), (3, 5e3)] {
            let truth = Truth { load_n, ..Truth::drawn(bearing, seed) };
            let mut monitor = monitor(bearing, |_| {});
            let estimates = follow(&mut monitor, &truth.frames(seed, 0).0);
            let found: Vec<_> =
                raised(&estimates, DISTRUSTED | HELD).into_iter().filter(|i| *i > 100).collect();
            assert_eq!(found, [0_usize; 0], "{bearing:?}, {load_n} N");
            let health = monitor.health();
            assert_eq!((health.held, health.holds, health.outside_law), (0, 0, 0), "{bearing:?}, {load_n} N");
            assert_eq!(monitor.report().safe_state, SafeState::Live);
        }
    }
}

#[test]
fn a_missing_sample_holds_the_last_trusted_estimate_until_all_windows_have_passed() {
    let missing = SensorStatus::GOOD.missing(SensorChannel::JournalZ);
    let (estimates, monitor) =
        with(|index, _| if (BEGIN..BEGIN + 10).contains(&index) { missing } else { SensorStatus::GOOD });
    assert_eq!(raised(&estimates, SENSOR_MISSING), (BEGIN..BEGIN + 10).collect::<Vec<_>>());
    let held = raised(&estimates, HELD);
    // Ten samples, and one fewer than the recovery time: its last one is live.
    let recovery = configuration(BearingMaterial::Babbitt).1.recovery_samples as usize;
    assert_eq!(held, (BEGIN..BEGIN + 10 + recovery - 1).collect::<Vec<_>>());
    for index in held {
        assert_eq!(forces(&estimates[index]), forces(&estimates[BEGIN - 1]), "{index}");
        assert_eq!(estimates[index].sequence, index as u32);
    }
    let health = monitor.health();
    assert_eq!((health.channels[1].missing, health.channels[0].missing), (10, 0));
    assert_eq!((health.holds, health.held as usize), (1, 9 + recovery));
    assert_eq!(monitor.report().safe_state, SafeState::Live);
}

#[test]
fn a_stuck_probe_is_held_after_its_time_and_counted() {
    let held_y = frames()[BEGIN].journal_y_nm;
    let (estimates, monitor) = with(|index, frame| {
        if index >= BEGIN {
            frame.journal_y_nm = held_y;
        }
        SensorStatus::GOOD
    });
    assert_eq!(raised(&estimates, STUCK).first(), Some(&(BEGIN + 99)));
    assert_eq!(monitor.health().channels[0].stuck as usize, SAMPLES - BEGIN - 99);
    assert_eq!(monitor.report().safe_state, SafeState::Held);
}

#[test]
fn noise_above_its_limit_is_flagged_and_below_it_is_not() {
    // The limit is 2 um; interference alternates by as much, either way.
    for (amplitude_nm, noisy) in [(1_000, false), (4_000, true)] {
        let (estimates, monitor) = with(|index, frame| {
            if index >= BEGIN {
                // Without a period that the second difference would amplify or cancel.
                frame.journal_z_nm += amplitude_nm * [1, -1, -1, 1, 0, 1, -1][index % 7];
            }
            SensorStatus::GOOD
        });
        let found = raised(&estimates, NOISY);
        assert_eq!(!found.is_empty(), noisy, "{amplitude_nm} nm");
        assert_eq!(monitor.health().channels[1].noisy as usize, found.len());
        if let Some(first) = found.first() {
            assert!((BEGIN..BEGIN + 500).contains(first), "{first}");
        }
    }
}

#[test]
fn a_probe_at_its_rail_is_flagged_by_status_and_by_value() {
    let at_rail = SensorStatus::GOOD.at_rail(SensorChannel::JournalY);
    let (estimates, monitor) = with(|index, frame| {
        if index == BEGIN {
            return at_rail;
        }
        if index == BEGIN + 50 {
            frame.load_force_mn = -60_000_000;
        }
        SensorStatus::GOOD
    });
    assert_eq!(raised(&estimates, SENSOR_SATURATED), [BEGIN, BEGIN + 50]);
    assert!(!raised(&estimates, HELD).contains(&(BEGIN + 200)), "nothing is held for the load");
    let health = monitor.health();
    assert_eq!((health.channels[0].saturated, health.channels[3].saturated), (1, 1));
}

#[test]
fn a_journal_that_circles_faster_than_anything_drives_it_is_implausible() {
    // 0.45 m/s along the clearance: below the jump's limit, above what load and weight give.
    let (estimates, monitor) = with(|index, frame| {
        if index >= BEGIN {
            let angle = 45_000.0 / 520_000.0 * (index - BEGIN) as f64;
            frame.journal_y_nm = (-520_000.0 * angle.cos()) as i32;
            frame.journal_z_nm = (-520_000.0 * angle.sin()) as i32;
        }
        SensorStatus::GOOD
    });
    let found = raised(&estimates, IMPLAUSIBLE_SWING);
    // Once a span of 32 samples.
    assert!(found.len() > (SAMPLES - BEGIN) / 32 - 3, "{}", found.len());
    assert!(found.iter().all(|index| *index >= BEGIN));
    assert_eq!(monitor.health().implausible_swings as usize, found.len());
    // Only the step onto the circle is a jump; it leaves the probes suspect for 128 samples.
    assert_eq!(raised(&estimates, JUMP), (BEGIN..BEGIN + 128).collect::<Vec<_>>());
}

#[test]
fn a_load_too_small_for_the_swing_holds_the_estimate_and_a_load_known_as_faulty_does_not() {
    // 0.26 m/s along the clearance: below the limit for 10 kN, above the limit without load.
    let circle = |load_mn: i32, status: SensorStatus| {
        with(|index, frame| {
            if index < BEGIN {
                return SensorStatus::GOOD;
            }
            let angle = 26_000.0 / 520_000.0 * (index - BEGIN) as f64;
            frame.journal_y_nm = (-520_000.0 * angle.cos()) as i32;
            frame.journal_z_nm = (-520_000.0 * angle.sin()) as i32;
            frame.load_force_mn = load_mn + 1_000 * (index % 7) as i32;
            status
        })
    };
    let missing = SensorStatus::GOOD.missing(SensorChannel::LoadForce);
    let cases = [
        (10_000_000, SensorStatus::GOOD, false, Flags::NONE),
        (0, SensorStatus::GOOD, true, IMPLAUSIBLE_SWING),
        (0, missing, false, SENSOR_MISSING),
    ];
    for (load_mn, status, holds, flag) in cases {
        let (estimates, monitor) = circle(load_mn, status);
        // After the jumps of position and load on to the circle, and before a state is lost.
        let settled = &estimates[BEGIN + 500..BEGIN + 1_500];
        assert_eq!(!raised(settled, HELD).is_empty(), holds, "{load_mn} mN, {status:?}");
        assert_eq!(monitor.health().implausible_swings > 0, holds, "{load_mn} mN, {status:?}");
        assert_eq!(raised(settled, flag).is_empty(), flag == Flags::NONE, "{load_mn} mN, {status:?}");
    }
}

#[test]
fn a_fault_that_lasts_loses_the_estimate() {
    let lost_samples = 1_000;
    let mut monitor =
        monitor(BearingMaterial::Babbitt, |configuration| configuration.lost_samples = lost_samples);
    let missing = SensorStatus::GOOD.missing(SensorChannel::ShaftAngle);
    for (index, frame) in frames().iter().enumerate() {
        let bad = index >= BEGIN;
        let estimate = monitor.step(frame, if bad { missing } else { SensorStatus::GOOD });
        let since = index.saturating_sub(BEGIN);
        let expected = match (bad, since >= lost_samples as usize) {
            (false, _) => continue,
            (true, false) => SafeState::Held,
            (true, true) => SafeState::Lost,
        };
        assert_eq!(monitor.report().safe_state, expected, "{index}");
        assert!(flags_of(&estimate).contains(HELD | SENSOR_MISSING));
        if expected == SafeState::Lost {
            assert_eq!(forces(&estimate), [0.0; 4]);
        }
    }
}

#[test]
fn a_dissipation_factor_of_0_is_that_of_the_material() {
    for bearing in BearingMaterial::ALL {
        let frames = frames();
        let [given, default] = [bearing.damping_per_mille() as u16, 0].map(|factor| {
            let mut monitor = monitor(bearing, |configuration| configuration.damping_per_mille = factor);
            let estimates = follow(&mut monitor, &frames);
            (estimates, monitor.report())
        });
        assert_eq!(given, default, "{bearing:?}");
    }
}

#[test]
fn networks_that_contradict_the_law_are_flagged_held_and_counted() {
    // The same networks with a law of half the modulus: corrupted weights have the same effect.
    let mut monitor =
        monitor(BearingMaterial::Babbitt, |configuration| configuration.effective_modulus_kpa /= 2);
    let estimates = follow(&mut monitor, &frames());
    let outside = raised(&estimates, NETWORK_OUTSIDE_LAW);
    assert!(outside.len() > 1_000, "{}", outside.len());
    assert_eq!(monitor.health().outside_law as usize, outside.len());
    // After the first trusted estimate, one outside the envelope is held.
    let trusted = estimates.iter().position(|estimate| !flags_of(estimate).intersects(DISTRUSTED)).unwrap();
    let mut after = outside.iter().filter(|index| **index > trusted);
    assert!(after.all(|index| flags_of(&estimates[*index]).contains(HELD)));
}

#[test]
fn with_the_law_as_the_source_networks_outside_it_hold_nothing() {
    let (mut bench, mut monitoring) = configuration(BearingMaterial::Babbitt);
    bench.contact = ContactSource::Law;
    monitoring.effective_modulus_kpa /= 2;
    let image = shipped(BearingMaterial::Babbitt);
    let mut monitor = Monitor::new(image, &bench, &monitoring, 100).unwrap();
    let estimates = follow(&mut monitor, &frames());
    assert!(raised(&estimates, NETWORK_OUTSIDE_LAW).len() > 1_000);
    assert!(raised(&estimates, HELD).is_empty());
}

#[test]
fn a_friction_that_no_bearing_has_is_flagged_and_held() {
    // The friction network's scale precedes the bias of its head and 16 groups of weights. A shift
    // that is smaller by 4 makes the friction 16 times as large.
    let sound = shipped(BearingMaterial::Babbitt);
    let words: &'static mut [u32] = Box::leak(vec![0; sound.len() / 4].into_boxed_slice());
    let image: &'static mut [u8] = bytemuck::cast_slice_mut(words);
    image.copy_from_slice(sound);
    image[sound.len() - CRC_LENGTH - 4 * 18] -= 4;
    seal(image);
    let (configuration, monitoring) = configuration(BearingMaterial::Babbitt);
    let mut monitor = Monitor::new(image, &configuration, &monitoring, 100).unwrap();
    let estimates = follow(&mut monitor, &frames());
    let steep = raised(&estimates, Flags::IMPLAUSIBLE_FRICTION);
    assert!(steep.len() > 1_000, "{}", steep.len());
    let trusted = estimates.iter().position(|estimate| !flags_of(estimate).intersects(DISTRUSTED)).unwrap();
    let mut after = steep.iter().filter(|index| **index > trusted);
    assert!(after.all(|index| flags_of(&estimates[*index]).contains(HELD)));
    let sound = follow(&mut self::monitor(BearingMaterial::Babbitt, |_| {}), &frames());
    assert!(raised(&sound, Flags::IMPLAUSIBLE_FRICTION).is_empty());
}

#[test]
fn faults_stop_the_tracking_and_keep_what_was_learnt() {
    let faulty: TrackReport = {
        let (_, monitor) = with(|index, frame| {
            if index >= BEGIN {
                frame.journal_y_nm = -300_000;
            }
            SensorStatus::GOOD
        });
        monitor.report()
    };
    let error_nm = f64::from(faulty.radial_clearance_nm) - 500_000.0;
    assert!(error_nm.abs() < 2.0 * f64::from(faulty.radial_clearance_deviation_nm), "{error_nm}");
}
