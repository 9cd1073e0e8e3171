//! Noise floors from repeated cycles and from the declaration.

use super::{axis, diagnosed, effect, logged, with};
use bench::effects::Effect;
use bench::{Bench, Channel};

/// The axis with declared noise of its sensor in N; 0 for no declaration.
fn declared(noise: f64) -> Bench {
    let mut bench = axis(6);
    if let Some(rig) = bench.axis_mut() {
        match rig.common.sensors.get_mut(&Channel::DriveForce) {
            Some(sensor) if noise > 0.0 => sensor.noise = noise,
            _ => rig.common.sensors.clear(),
        }
    }
    bench
}

#[test]
fn undeclared_noise_comes_from_repeats_without_model_error() {
    let truth = with(&axis(6), effect("coulomb-level", None, "coulomb_effort", 20.0));
    let d = diagnosed(&declared(0.0), &[logged(&truth, 5)], &["coulomb-level"]);
    let noise = &d.noise[0];
    assert_eq!((noise.source, noise.declared, noise.declared_floor), ("repeats", false, None));
    assert!((noise.floor - 1.0).abs() < 0.1, "{noise:?}");
    // 20 N of friction repeat, over 1 N of noise.
    assert!(noise.repeats >= 5 && noise.repeatable_share.is_some_and(|s| s > 0.98), "{noise:?}");
    assert_eq!(d.causes[0].effect, "coulomb-level");
}

#[test]
fn a_noise_declaration_far_from_the_log_is_reported() {
    let log = logged(&axis(6), 5);
    for (noise, source, found) in [(1.0, "declared", false), (0.3, "repeats", true), (3.0, "declared", true)]
    {
        let d = diagnosed(&declared(noise), std::slice::from_ref(&log), &["coulomb-level"]);
        let n = &d.noise[0];
        assert_eq!((n.source, n.finding.is_some()), (source, found), "{noise}: {n:?}");
        assert!((n.measured_floor - 1.0).abs() < 0.1 && n.declared_floor == Some(noise), "{n:?}");
    }
}

#[test]
fn with_two_cycles_noise_comes_from_differences() {
    let d = diagnosed(&declared(0.0), &[logged(&axis(2), 5)], &["coulomb-level"]);
    let noise = &d.noise[0];
    assert_eq!((noise.source, noise.repeats, noise.repeatable_share), ("differences", 0, None));
    assert!((noise.floor - 1.0).abs() < 0.2, "{noise:?}");
}

#[test]
fn only_an_offset_beyond_the_resolution_is_found() {
    let mut bench = axis(6);
    if let Some(rig) = bench.axis_mut()
        && let Some(sensor) = rig.common.sensors.get_mut(&Channel::DriveForce)
    {
        (sensor.noise, sensor.resolution) = (0.9, 1.0);
    }
    let library = ["sensor-offset", "coulomb-asymmetry"];
    for (offset, found) in [(0.5, false), (-0.8, false), (6.0, true)] {
        let truth = with(&bench, effect("sensor-offset", Some(Channel::DriveForce), "offset", offset));
        let d = diagnosed(&bench, &[logged(&truth, 5)], &library);
        assert_eq!(!d.causes.is_empty(), found, "{offset}: {:?} {:?}", d.verdict, d.ranking);
        let calibrated = d.calibrated.iter().find(|c| c.name == "sensors.drive_force_n.offset").unwrap();
        assert!(found || (calibrated.value - offset).abs() < 0.15, "{calibrated:?}");
    }
}

#[test]
fn a_ripple_is_found_on_a_clock_that_began_long_before_the_log() {
    let bench = axis(6);
    let ripple = Effect {
        name: "load-ripple".into(),
        channel: None,
        of: None,
        parameters: [("cos_force_n", 2.0), ("sin_force_n", 1.0), ("frequency_hz", 5.03)]
            .map(|(name, value)| (name.to_owned(), value))
            .into(),
    };
    let mut log = logged(&with(&bench, ripple), 5);
    log.time_s.iter_mut().for_each(|t| *t += 537.0);
    let d = diagnosed(&bench, &[log], &["load-ripple", "coulomb-level"]);
    assert_eq!(
        d.causes.first().map(|c| c.effect.as_str()),
        Some("load-ripple"),
        "{:?} {:?}",
        d.verdict,
        d.ranking
    );
    let frequency = &d.causes[0].parameters[2];
    assert!((frequency.value - 5.03).abs() < 0.02, "{frequency:?}");
}
