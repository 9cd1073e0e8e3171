//! The Kalman filter of the contact force from outside, in any configuration and on any samples.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod reference;

use controller::filter::{Filter, FilterConfiguration, FilterEstimate, Measurement, Skew};
use on_target::filter::{Orbit, default_bench};
use proptest::prelude::*;
use reference::Reference;
use worlds::{Bearing, Row, Sensors, World};

/// Samples of a case.
const SAMPLES: usize = 300;

fn configurations() -> impl Strategy<Value = FilterConfiguration> {
    let times = (5e-5..1e-3_f32, 0.2..5.0_f32);
    let shaft = (1.0..1e3_f32, 0.1..1e3_f32, 0.05..1.0_f32);
    let bearing = (2e-5..2e-3_f32, 1e9..2e11_f32, 0.0..3.0_f32);
    let unknown = (1e-7..1e-4_f32, 1e-3..0.3_f32);
    (times, shaft, bearing, unknown).prop_map(|(times, shaft, bearing, unknown)| {
        let mut config = default_bench();
        (config.sample_period_s, config.period_s) = times;
        (config.mass_kg, config.inertia_kg_m2, config.drive_lever_m) = shaft;
        config.stroke_m = config.stroke_m.min(1.5 * config.drive_lever_m);
        (config.radial_clearance_m, config.effective_modulus_pa, config.dissipation_factor) = bearing;
        (config.uncertainty.clearance_m, config.uncertainty.stiffness_share) = unknown;
        config
    })
}

fn is_sane(estimate: &FilterEstimate) -> bool {
    let values = [
        estimate.normal_force_n,
        estimate.friction_force_n,
        estimate.force_y_n,
        estimate.force_z_n,
        estimate.friction_torque_nm,
        estimate.deformation_m,
        estimate.clearance_m,
        estimate.stiffness_factor,
        estimate.friction_factor,
    ];
    let deviations = [estimate.force_sd_n, estimate.friction_torque_sd_nm, estimate.clearance_sd_m];
    values.iter().all(|value| value.is_finite()) && deviations.iter().all(|deviation| *deviation > 0.0)
}

proptest! {
    #[test]
    fn any_samples_give_finite_estimates_with_a_deviation_above_0(
        config in configurations(),
        seeds in prop::collection::vec((-1.5..1.5_f32, -1.5..1.5_f32, -1.0..1.0_f32, -2e4..2e4_f32), SAMPLES),
    ) {
        let mut filter = Filter::new(&config).unwrap();
        for (index, (y, z, angle, load)) in seeds.into_iter().enumerate() {
            // Steady for a while, then jumps from sample to sample.
            let (y, z) = if index < SAMPLES / 2 { (0.0, -1.01) } else { (y, z) };
            let estimate = filter.step(&Measurement {
                journal_y_m: y * config.radial_clearance_m,
                journal_z_m: z * config.radial_clearance_m,
                shaft_angle_rad: angle,
                load_force_n: load,
                drive_force_n: (index % 3 == 0).then_some(load),
            });
            prop_assert!(is_sane(&estimate), "sample {index}: {estimate:?}");
        }
    }
}

#[test]
fn every_value_out_of_range_is_refused_by_name() {
    let refused = |change: fn(&mut FilterConfiguration)| {
        let mut config = default_bench();
        change(&mut config);
        Filter::new(&config).unwrap_err().to_string()
    };
    assert_eq!(refused(|c| c.mass_kg = 0.0), "mass_kg: found 0, expected 0.01 to 100000");
    assert!(refused(|c| c.sample_period_s = f32::NAN).starts_with("sample_period_s: found NaN"));
    assert!(refused(|c| c.friction.regularisation_m_s = 0.0).starts_with("friction.regularisation_m_s"));
    assert!(refused(|c| c.stroke_m = 0.7).ends_with("expected 0.001 to 0.6"));
}

#[test]
fn a_missing_sample_is_predicted_and_widens_the_deviation() {
    let mut orbit = Orbit::new(false).unwrap();
    let missing = Measurement { journal_y_m: f32::NAN, ..Measurement::default() };
    assert_eq!(orbit.filter.step(&missing).force_sd_n, f32::INFINITY);
    let mut last = FilterEstimate::default();
    for _ in 0..2000 {
        let measured = orbit.measure();
        last = orbit.filter.step(&measured);
    }
    let first_gap = orbit.filter.step(&missing);
    let mut filter = orbit.filter.clone();
    let later = (0..20).fold(first_gap, |_, _| filter.step(&missing));
    assert!(is_sane(&first_gap) && is_sane(&later));
    assert!(later.clearance_sd_m >= last.clearance_sd_m);
}

#[test]
fn after_a_drop_out_the_bearing_is_as_well_known_as_before() {
    let (_, readings) = run(5.1e-4);
    let config = default_bench();
    let mut filter = Filter::new(&config).unwrap();
    let mut before = FilterEstimate::default();
    for reading in &readings[..4_000] {
        before = filter.step(reading);
    }
    let missing = Measurement { journal_y_m: f32::NAN, ..Measurement::default() };
    for _ in 0..60 {
        filter.step(&missing);
    }
    let after = filter.step(&readings[4_060]);
    assert!(after.clearance_sd_m < 1.5 * before.clearance_sd_m + 1e-7, "{before:?} {after:?}");
    assert!(after.stiffness_sd < 1.5 * before.stiffness_sd, "{before:?} {after:?}");
}

/// Runs an orbit and returns the number of estimates that are not sane.
fn soak(samples: u32, measures_drive_force: bool) -> u32 {
    let mut orbit = Orbit::new(measures_drive_force).unwrap();
    let mut is_wrong = |_: &u32| {
        let measured = orbit.measure();
        let estimate = orbit.filter.step(&measured);
        !is_sane(&estimate) || estimate.force_sd_n.is_infinite()
    };
    (0..samples).filter(|sample| is_wrong(sample)).count() as u32
}

#[test]
fn the_covariance_stays_positive_for_a_minute() {
    assert_eq!([false, true].map(|force| soak(300_000, force)), [0, 0]);
}

#[test]
#[ignore = "a minute; part of `cargo xtask test --long`"]
fn the_covariance_stays_positive_for_ten_million_samples() {
    assert_eq!(soak(5_000_000, false) + soak(5_000_000, true), 0);
}

/// Bench B over .6 s with a clearance other than described, and its readings.
fn run(clearance_m: f64) -> (Vec<Row>, Vec<Measurement>) {
    let (rows, readings) = run_world(&World::bench_b(Bearing::Babbitt, clearance_m, 10e3));
    let without = |reading: &Measurement| Measurement { drive_force_n: None, ..*reading };
    let readings = readings.iter().map(without).collect();
    (rows, readings)
}

/// Runs a world; the readings contain the force of the drive.
fn run_world(world: &World) -> (Vec<Row>, Vec<Measurement>) {
    let rows = world.run(0.6, 10e3);
    let readings = Sensors::BENCH_B.read(&rows, 1);
    let measurement = |reading: &worlds::Reading| Measurement {
        journal_y_m: reading.journal_y_m as f32,
        journal_z_m: reading.journal_z_m as f32,
        shaft_angle_rad: reading.shaft_angle_rad as f32,
        load_force_n: reading.load_force_n as f32,
        drive_force_n: Some(reading.drive_force_n as f32),
    };
    let readings = readings.iter().map(measurement).collect();
    (rows, readings)
}

/// Rms error of the force after the start, as a share of the largest force.
fn force_share(rows: &[Row], estimates: &[FilterEstimate]) -> f64 {
    let settled = || rows.iter().zip(estimates).skip(500);
    let error = |(row, found): (&Row, &FilterEstimate)| {
        let y = f64::from(found.force_y_n) - row.force_y_n;
        y.hypot(f64::from(found.force_z_n) - row.force_z_n)
    };
    let squares: f64 = settled().map(|pair| error(pair).powi(2)).sum();
    let full_scale = rows.iter().map(|row| row.force_y_n.hypot(row.force_z_n)).fold(0.0, f64::max);
    (squares / settled().count() as f64).sqrt() / full_scale
}

#[test]
fn a_measured_drive_force_shows_a_wrong_mass_even_if_it_comes_late() {
    let exact = World::bench_b(Bearing::Babbitt, 500e-6, 10e3);
    let (rows, readings) = run_world(&World { mass_kg: 1.05 * exact.mass_kg, ..exact });
    let share = |first: usize| {
        let mut filter = Filter::new(&default_bench()).unwrap();
        let estimate = |(index, reading): (usize, &Measurement)| {
            let drive_force_n = reading.drive_force_n.filter(|_| index >= first);
            filter.step(&Measurement { drive_force_n, ..*reading })
        };
        force_share(&rows, &readings.iter().enumerate().map(estimate).collect::<Vec<_>>())
    };
    let (always, late, never) = (share(0), share(100), share(usize::MAX));
    assert!(never > 5e-3, "{never}");
    assert!(always < 3e-3 && late < 3e-3, "{always} {late}");
}

/// Rms change of the force that a second probe, in a direction, causes by being sampled 10 us after
/// the first, as a share of the largest force: with a filter that knows it, and with one that does
/// not.
fn effects_of_skew(world: &World, direction: [f64; 2]) -> [f64; 2] {
    const TIME_S: f64 = 10e-6;
    const STEPS: usize = 10;
    let all = world.run(0.6, 1.0 / TIME_S);
    let rows: Vec<Row> = all.iter().step_by(STEPS).copied().collect();
    let readings = Sensors::BENCH_B.read(&rows, 1);
    let [along_y, along_z] = direction;
    let estimates = |is_late: bool, known_s: f64| -> Vec<FilterEstimate> {
        let mut filter = Filter::new(&default_bench()).unwrap();
        filter.set_skew(Skew::new(direction.map(|part| part as f32), known_s as f32));
        let estimate = |(reading, pair): (&worlds::Reading, &[Row])| {
            let moved_y = pair[1].journal_y_m - pair[0].journal_y_m;
            let moved_z = pair[1].journal_z_m - pair[0].journal_z_m;
            let moved = if is_late { along_y * moved_y + along_z * moved_z } else { 0.0 };
            filter.step(&Measurement {
                journal_y_m: (reading.journal_y_m + moved * along_y) as f32,
                journal_z_m: (reading.journal_z_m + moved * along_z) as f32,
                shaft_angle_rad: reading.shaft_angle_rad as f32,
                load_force_n: reading.load_force_n as f32,
                drive_force_n: None,
            })
        };
        readings.iter().zip(all.windows(2).step_by(STEPS)).map(estimate).collect()
    };
    let together = estimates(false, 0.0);
    let full_scale = rows.iter().map(|row| row.force_y_n.hypot(row.force_z_n)).fold(0.0, f64::max);
    [TIME_S, 0.0].map(|known_s| {
        let late = estimates(true, known_s);
        let square = |(a, b): (&FilterEstimate, &FilterEstimate)| {
            f64::from(a.force_y_n - b.force_y_n).powi(2) + f64::from(a.force_z_n - b.force_z_n).powi(2)
        };
        let squares: f64 = late.iter().zip(&together).skip(500).map(square).sum();
        (squares / (rows.len() - 500) as f64).sqrt() / full_scale
    })
}

#[test]
fn a_second_probe_that_is_sampled_later_is_taken_into_account() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    for (load_n, direction) in [(10e3, [0.0, 1.0]), (10e3, [half, half]), (-5e3, [-half, half])] {
        let [known, unknown] = effects_of_skew(&World::bench_b(Bearing::Babbitt, 500e-6, load_n), direction);
        println!("{load_n} N, {direction:?}: known {known:.2e}, unknown {unknown:.2e}");
        assert!(known < 0.1 * unknown, "{known} {unknown}");
    }
}

#[test]
fn a_clearance_far_beyond_its_declared_deviation_is_found() {
    // Described: 500 um with a deviation of 10 um.
    for off_um in [-60.0, -30.0, 30.0, 60.0, 100.0] {
        let clearance_m = 500e-6 + 1e-6 * off_um;
        let (rows, readings) = run(clearance_m);
        let mut filter = Filter::new(&default_bench()).unwrap();
        let estimates: Vec<_> = readings.iter().map(|reading| filter.step(reading)).collect();
        let share = force_share(&rows, &estimates);
        assert!(share < 0.01, "{off_um} um: {share}");
        let last = estimates.last().unwrap();
        let off = (f64::from(last.clearance_m) - clearance_m).abs();
        // The reported interval is too narrow after such a start (docs/estimation.md).
        assert!(off < 5e-6, "{off_um} um: {off} m");
        assert!(last.fits && !last.is_converging, "{off_um} um: {last:?}");
    }
}

#[test]
fn a_filter_that_starts_anew_says_that_it_did_not_fit_and_how_little_it_knows() {
    // Far from a clearance that is declared too narrowly the filter learns a wrong one first.
    let mut config = default_bench();
    config.uncertainty.clearance_m = 2e-6;
    let follow = |off_um: f64| -> Vec<FilterEstimate> {
        let mut filter = Filter::new(&config).unwrap();
        run(500e-6 + 1e-6 * off_um).1.iter().map(|reading| filter.step(reading)).collect()
    };
    let runs = [-60.0, -30.0, -15.0, 15.0, 30.0, 60.0, 100.0].map(follow);
    // A start resets the stiffness and moves the clearance at once.
    let is_restart = |pair: &&[FilterEstimate]| {
        (pair[1].clearance_m - pair[0].clearance_m).abs() > 10e-6 && pair[1].stiffness_factor == 1.0
    };
    let restarts: Vec<_> = runs.iter().flat_map(|run| run.windows(2).filter(is_restart)).collect();
    assert!(!restarts.is_empty());
    for pair in restarts {
        assert!(!pair[1].fits, "{pair:?}");
        let moved = (pair[1].clearance_m - 500e-6).abs();
        assert!(pair[1].clearance_sd_m > 0.45 * moved, "{pair:?}");
    }
}

#[test]
fn single_precision_estimates_what_a_dense_filter_in_double_precision_does() {
    let (_, readings) = run(510e-6);
    let config = default_bench();
    let mut filter = Filter::new(&config).unwrap();
    let mut reference = Reference::new(&config, &readings[0]);
    filter.step(&readings[0]);
    let mut squares = 0.0;
    for (index, reading) in readings.iter().enumerate().skip(1) {
        let (found, expected) = (filter.step(reading), reference.step(reading));
        let y = f64::from(found.force_y_n) - expected.0;
        let z = f64::from(found.force_z_n) - expected.1;
        if index >= 500 {
            squares += y * y + z * z;
        }
    }
    let rms = (squares / (readings.len() - 500) as f64).sqrt();
    // Rounding decides little while the factors are learnt; the filter's own deviations are above
    // 35 N.
    println!("difference {rms:.1} N rms");
    assert!(rms < 20.0, "{rms} N");
}
