//! The virtual sensor compared with benches of known clearance and friction.

use crate::run::{RATE_HZ, Truth, follow, monitor};
use controller::estimator::flags_of;
use controller::flags::MODEL_MISFIT;
use inference::BearingMaterial;
use link::SensorFrame;
use link::track::{FrictionState, Wear};

/// Benches per bearing whose uncertain parameters are drawn, each with another clearance and
/// friction level.
const SEEDS: u64 = 32;

/// Error over deviation of clearance and friction level, and their errors in nm and thousandths,
/// after one cycle of every bench.
fn scores(bearing: BearingMaterial) -> Vec<[f64; 4]> {
    (0..SEEDS)
        .map(|seed| {
            // Three declared deviations either way.
            let clearance_m = 0.5e-3 + 1.9e-6 * (seed as f64 - 15.5);
            let friction_level = 0.91 + 0.0058 * seed as f64;
            let truth = Truth { clearance_m, friction_level, ..Truth::drawn(bearing, seed) };
            let mut monitor = monitor(bearing, |_| {});
            follow(&mut monitor, &truth.frames(seed, 0).0);
            let report = monitor.report();
            let clearance = f64::from(report.radial_clearance_nm) - clearance_m * 1e9;
            let friction = f64::from(report.friction_level_per_mille) - friction_level * 1e3;
            [
                clearance / f64::from(report.radial_clearance_deviation_nm),
                friction / f64::from(report.friction_level_deviation_per_mille),
                clearance,
                friction,
            ]
        })
        .collect()
}

#[test]
fn the_stated_deviations_cover_the_errors() {
    for (bearing, clearance_nm, friction) in
        [(BearingMaterial::Babbitt, 600.0, 10.0), (BearingMaterial::Plastic, 1_000.0, 15.0)]
    {
        let scores = scores(bearing);
        let rms = |column: usize| {
            (scores.iter().map(|row| row[column] * row[column]).sum::<f64>() / SEEDS as f64).sqrt()
        };
        let within = |column: usize, deviations: f64| {
            scores.iter().filter(|row| row[column].abs() <= deviations).count() as f64 / SEEDS as f64
        };
        println!(
            "{bearing:?}: clearance {:.0} nm rms, {:.2} deviations; \
             friction {:.0} thousandths rms, {:.2} deviations",
            rms(2),
            rms(0),
            rms(3),
            rms(1)
        );
        for (quantity, column) in [("clearance", 0), ("friction", 1)] {
            // Of a normal distribution 68 and 95 % are within; 32 draws scatter by 8 and 4 %.
            assert!(within(column, 1.0) > 0.55, "{bearing:?} {quantity}: {}", within(column, 1.0));
            assert!(within(column, 2.0) > 0.89, "{bearing:?} {quantity}: {}", within(column, 2.0));
            // The deviation is not so large that it is useless.
            assert!(rms(column) > 0.4, "{bearing:?} {quantity}: {}", rms(column));
        }
        assert!(rms(2) < clearance_nm, "{bearing:?}: {} nm", rms(2));
        assert!(rms(3) < friction, "{bearing:?}: {}", rms(3));
    }
}

#[test]
fn a_clearance_that_grows_is_followed_and_alarmed_when_it_is_above_the_limit() {
    for (bearing, limit_m, step_m) in
        [(BearingMaterial::Babbitt, 0.52e-3, 1e-6), (BearingMaterial::Plastic, 0.52e-3, 1e-6)]
    {
        let mut monitor = monitor(bearing, |configuration| {
            configuration.wear_limit_nm = (limit_m * 1e9) as u32;
            configuration.wear_hysteresis_nm = 15_000;
        });
        let mut raised_at = None;
        for cycle in 0..32_u32 {
            let clearance_m = 0.5e-3 + step_m * f64::from(cycle);
            let truth = Truth { clearance_m, ..Truth::drawn(bearing, 3) };
            follow(&mut monitor, &truth.frames(u64::from(cycle), cycle * 10_000).0);
            let report = monitor.report();
            let deviation_m = f64::from(report.radial_clearance_deviation_nm) * 1e-9;
            let error_m = f64::from(report.radial_clearance_nm) * 1e-9 - clearance_m;
            assert!(error_m.abs() < 3.0 * deviation_m, "{bearing:?} {cycle}: {error_m} of {deviation_m} m");
            if report.wear == Wear::Alarm && raised_at.is_none() {
                raised_at = Some(clearance_m);
                // The confidence of 1.6 deviations, an error of up to 2, and the wear of one cycle.
                assert!(clearance_m > limit_m - 0.5 * deviation_m, "{bearing:?}: early, {clearance_m} m");
                assert!(
                    clearance_m < limit_m + 3.7 * deviation_m + step_m,
                    "{bearing:?}: late, {clearance_m} m"
                );
            }
        }
        assert!(raised_at.is_some(), "{bearing:?}: never");
        assert_eq!((monitor.report().wear, monitor.report().wear_alarms), (Wear::Alarm, 1), "{bearing:?}");
    }
}

#[test]
fn without_wear_there_is_no_alarm() {
    for bearing in BearingMaterial::ALL {
        let mut worn = monitor(bearing, |_| {});
        follow(&mut worn, &Truth::drawn(bearing, 99).frames(99, 0).0);
        // Two deviations below the limit: a bearing that is worn almost to the limit.
        let below_m = 2e-9 * f64::from(worn.report().radial_clearance_deviation_nm);
        let is_alarmed = |seed: &u64| {
            let mut monitor = monitor(bearing, |configuration| configuration.wear_limit_nm = 500_000);
            let truth = Truth { clearance_m: 0.5e-3 - below_m, ..Truth::drawn(bearing, *seed) };
            follow(&mut monitor, &truth.frames(*seed, 0).0);
            monitor.report().wear != Wear::Below
        };
        // The confidence of an alarm is 95 %.
        let alarms: Vec<u64> = (100..140).filter(is_alarmed).collect();
        assert!(alarms.len() <= 2, "{bearing:?}: {alarms:?}");
    }
}

#[test]
fn friction_that_grows_is_alarmed_when_it_is_above_the_limit_and_the_alarm_ends_when_it_falls() {
    const LIMIT: f64 = 1.4;
    for bearing in BearingMaterial::ALL {
        let mut monitor = monitor(bearing, |_| {});
        monitor.limit_friction((LIMIT * 1e3) as u16);
        let mut raised_at = None;
        for cycle in 0..24_u32 {
            // Rises to 2.15, then returns to 1.
            let friction_level = if cycle < 20 { 1.0 + 0.06 * f64::from(cycle) } else { 1.0 };
            let truth = Truth { friction_level, ..Truth::drawn(bearing, 5) };
            follow(&mut monitor, &truth.frames(u64::from(cycle), cycle * 10_000).0);
            let report = monitor.report();
            let deviation = f64::from(report.friction_level_deviation_per_mille) * 1e-3;
            println!("{bearing:?} {friction_level:.2}: {report:?}");
            if report.friction == FrictionState::Alarm && raised_at.is_none() {
                raised_at = Some(friction_level);
                assert!(friction_level > LIMIT - deviation, "{bearing:?}: early, {friction_level}");
            }
            if friction_level > LIMIT + 4.0 * deviation + 0.12 {
                assert_eq!(report.friction, FrictionState::Alarm, "{bearing:?}: late, {friction_level}");
            }
        }
        assert!(raised_at.is_some(), "{bearing:?}: never");
        assert_eq!(monitor.report().friction_alarms, 1, "{bearing:?}");
    }
}

#[test]
fn friction_as_trained_raises_no_alarm() {
    for bearing in BearingMaterial::ALL {
        for seed in 200..210 {
            let mut monitor = monitor(bearing, |_| {});
            monitor.limit_friction(1_200);
            let truth = Truth::drawn(bearing, seed);
            follow(&mut monitor, &truth.frames(seed, 0).0);
            assert_eq!(monitor.report().friction, FrictionState::Below, "{bearing:?}, {seed}");
        }
    }
}

#[test]
fn load_either_way_and_other_clearances_are_followed() {
    for bearing in BearingMaterial::ALL {
        for (clearance_m, load_n) in
            [(0.49e-3, -10e3), (0.5e-3, 1e3), (0.51e-3, 5e3), (0.48e-3, -5e3), (0.53e-3, 10e3)]
        {
            let truth = Truth { clearance_m, load_n, ..Truth::nominal(bearing) };
            let mut monitor = monitor(bearing, |_| {});
            follow(&mut monitor, &truth.frames(9, 0).0);
            let report = monitor.report();
            let deviation_m = f64::from(report.radial_clearance_deviation_nm) * 1e-9;
            let error_m = f64::from(report.radial_clearance_nm) * 1e-9 - clearance_m;
            println!(
                "{bearing:?} {clearance_m} m {load_n} N: {error_m:.2e} of {deviation_m:.2e} m, \
                 friction {} of {}",
                report.friction_level_per_mille, report.friction_level_deviation_per_mille
            );
            assert!(
                error_m.abs() < 2.0 * deviation_m,
                "{bearing:?} {clearance_m} m, {load_n} N: {error_m} of {deviation_m} m"
            );
        }
    }
}

/// First sample after the start whose estimate has the flag `model-misfit`.
fn contradicted(bearing: BearingMaterial, frames: &[SensorFrame]) -> Option<usize> {
    let estimates = follow(&mut monitor(bearing, |_| {}), frames);
    let settled = estimates.iter().enumerate().skip(1_400);
    settled.filter(|(_, estimate)| flags_of(estimate).contains(MODEL_MISFIT)).map(|(index, _)| index).next()
}

#[test]
fn a_bench_within_its_uncertainty_contradicts_no_load() {
    for bearing in BearingMaterial::ALL {
        for seed in 0..2 * SEEDS {
            // Three declared deviations either way.
            let clearance_m = 0.5e-3 + 0.9e-6 * (seed as f64 - 32.0);
            let friction_level = 0.91 + 0.0028 * seed as f64;
            let load_n = 10e3 * (1.0 - 0.03 * seed as f64);
            let truth = Truth { clearance_m, friction_level, load_n, ..Truth::drawn(bearing, seed) };
            assert_eq!(contradicted(bearing, &truth.frames(seed, 0).0), None, "{bearing:?}, {seed}");
        }
    }
}

#[test]
fn a_probe_that_drifts_contradicts_the_load() {
    const BEGIN: usize = 1_500;
    for bearing in BearingMaterial::ALL {
        for (seed, drift_nm_s) in [(0, 1e5), (1, -1e5), (2, 3e5), (3, -1e6)] {
            for along_y in [true, false] {
                let mut frames = Truth::drawn(bearing, seed).frames(seed, 0).0;
                for (since, frame) in frames.iter_mut().skip(BEGIN).enumerate() {
                    let off_nm = (drift_nm_s * since as f64 / RATE_HZ) as i32;
                    *(if along_y { &mut frame.journal_y_nm } else { &mut frame.journal_z_nm }) += off_nm;
                }
                let found = contradicted(bearing, &frames);
                println!("{bearing:?} {drift_nm_s:e} nm/s, along y {along_y}: {found:?}");
                assert!(
                    found.is_some_and(|index| index > BEGIN),
                    "{bearing:?} {drift_nm_s} {along_y}: {found:?}"
                );
            }
        }
    }
}
