//! Logs with an error that no effect of the catalogue explains: what certainly helps is named
//! beside it, in any units, and nothing impossible is named.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use bench::effects::Effect;
use bench::simulate::record;
use bench::{Bench, Channel, MeasuredLog};
use diagnosis::{Cause, Diagnosis, Options, Verdict, diagnose};

/// A cylinder of 12 kg that swings by 50 mm against a load, with friction of 20 N.
fn cylinder() -> Bench {
    let text = "plant = \"friction-rig\"
[axis]
kind = \"linear\"
inertia = 12.0
friction_radius_m = 1.0
load_gain = 1.0
coulomb_effort = 20.0
viscous_effort = 50.0
load_coefficient = 0.0
regularisation_m_s = 2e-3
period_s = 2.0
amplitude = 0.05
cycles = 20
[load]
force_n = 100.0
ramp_s = 11.0
[logging]
sample_rate_hz = 200.0
[sensors]
drive_force_n = { noise = 0.5 }
";
    Bench::parse("cylinder.toml", text).unwrap()
}

/// A log of a bench with effects, with an additional effort given by time, position and speed.
fn log(bench: &Bench, effects: &[(&str, &str, f64)], more: impl Fn(f64, f64, f64) -> f64) -> MeasuredLog {
    let mut truth = bench.clone();
    for (name, parameter, value) in effects {
        let parameters = [((*parameter).to_owned(), *value)].into();
        truth.effects_mut().push(Effect { name: (*name).into(), channel: None, of: None, parameters });
    }
    let mut log = record(&truth, 7).unwrap();
    let (position, speed) =
        (log.channels[&Channel::Position].clone(), log.channels[&Channel::Velocity].clone());
    let (times, effort) = (log.time_s.clone(), log.channels.get_mut(&Channel::DriveForce).unwrap());
    for (i, value) in effort.iter_mut().enumerate() {
        *value += more(times[i], position[i], speed[i]);
    }
    log
}

fn diagnosed(bench: &Bench, log: MeasuredLog) -> Diagnosis {
    diagnose(bench, &[log], &[], &Options::default()).unwrap()
}

fn cause<'a>(d: &'a Diagnosis, effect: &str) -> &'a Cause {
    let found = d.causes.iter().find(|c| c.effect == effect);
    found.unwrap_or_else(|| panic!("no {effect}: {:?} {:?} {:?}", d.verdict, d.causes, d.ranking))
}

/// An effort that no effect of the catalogue has: it grows with the third power of the position.
fn cubic(amplitude_n: f64) -> impl Fn(f64, f64, f64) -> f64 {
    move |_, position, _| amplitude_n * (position / 0.05 - 1.0).powi(3)
}

#[test]
fn causes_beside_an_unknown_error_are_named_with_their_own_gain() {
    let effects =
        [("coulomb-level", "coulomb_effort", 15.0), ("viscous-asymmetry", "asymmetry_effort", 60.0)];
    let bench = cylinder();
    let d = diagnosed(&bench, log(&bench, &effects, cubic(10.0)));
    assert!(d.signature.is_some());
    let sum =
        d.probability_none + d.probability_unknown + d.hypotheses.iter().map(|h| h.probability).sum::<f64>();
    assert!((sum - 1.0).abs() < 1e-9 && d.hypotheses.iter().all(|h| !h.causes.is_empty()), "{sum}");
    for (name, _, value) in effects {
        let cause = cause(&d, name);
        let found = &cause.parameters[0];
        assert!((found.value / value - 1.0).abs() < 0.05, "{name}: {}", found.value);
        assert!(found.ci95[0] < value && value < found.ci95[1], "{name}: {:?}", found.ci95);
        let gain = &cause.gain[0];
        assert!(gain.baseline_rms > 1.1 * gain.extended_rms, "{name}: {gain:?}");
    }
}

#[test]
fn a_level_and_a_pre_sliding_distance_that_hide_each_other_are_both_named() {
    let mut bench = cylinder();
    bench.axis_mut().unwrap().axis.coulomb_effort = 0.0;
    let effects = [("coulomb-level", "coulomb_effort", 80.0), ("presliding-hysteresis", "distance_m", 8e-3)];
    let d = diagnosed(&bench, log(&bench, &effects, cubic(8.0)));
    for (name, _, value) in effects {
        let found = cause(&d, name).parameters[0].value;
        assert!((found / value - 1.0).abs() < 0.15, "{name}: {found}");
    }
}

/// Diagnoses a damper with an unknown error, with lengths and forces in other units; returns the
/// verdict, and level and pre-sliding distance in the first units.
///
/// Only with an unknown error are the data so uncertain that priors matter.
fn in_units(length: f64, force: f64) -> (Verdict, [f64; 2]) {
    let bench = |length: f64, force: f64| {
        let mut bench = cylinder();
        let rig = bench.axis_mut().unwrap();
        rig.axis.inertia = 0.0;
        rig.axis.coulomb_effort = 0.0;
        rig.axis.viscous_effort = 0.0;
        rig.axis.load_gain = 0.0;
        rig.load.force_n *= force;
        rig.axis.amplitude = 0.05 * length;
        rig.axis.regularisation_m_s = 2e-3 * length;
        rig.common.sensors.get_mut(&Channel::DriveForce).unwrap().noise = 20.0 * force;
        bench
    };
    let effects =
        [("coulomb-level", "coulomb_effort", 5000.0), ("presliding-hysteresis", "distance_m", 4e-3)];
    let mut log = log(&bench(1.0, 1.0), &effects, cubic(500.0));
    for (channel, unit) in [
        (Channel::Position, length),
        (Channel::Velocity, length),
        (Channel::DriveForce, force),
        (Channel::LoadForce, force),
    ] {
        log.channels.get_mut(&channel).unwrap().iter_mut().for_each(|v| *v *= unit);
    }
    let d = diagnosed(&bench(length, force), log);
    let value = |effect: &str| cause(&d, effect).parameters[0].value;
    (d.verdict, [value("coulomb-level") / force, value("presliding-hysteresis") / length])
}

#[test]
fn the_same_log_in_other_units_gives_the_same_verdict_and_values() {
    let (verdict, values) = in_units(1.0, 1.0);
    assert!((values[0] / 5000.0 - 1.0).abs() < 0.05 && (values[1] / 4e-3 - 1.0).abs() < 0.2, "{values:?}");
    for (length, force) in [(1.0 / 40.0, 1e-3), (100.0, 1.0), (1.0, 1e3)] {
        let (other, found) = in_units(length, force);
        assert_eq!(other, verdict, "{length}, {force}: {found:?}");
        let is_equal = |i: usize| (found[i] / values[i] - 1.0).abs() < 1e-3;
        assert!(is_equal(0) && is_equal(1), "{length}, {force}: {found:?} for {values:?}");
    }
}

/// On one sine a spring is a negative mass: the described 12 kg and the cause would be -8 kg.
#[test]
fn a_spring_does_not_become_a_negative_mass() {
    let bench = cylinder();
    let rate = 20.0 * (std::f64::consts::TAU / 2.0).powi(2);
    let d = diagnosed(&bench, log(&bench, &[], |_, position, _| rate * position));
    let extended = d.extended.as_ref().unwrap().resolved();
    let mass = extended.axis().unwrap().axis.inertia;
    assert!(mass >= -0.1, "{mass} kg: {:?} {:?}", d.verdict, d.causes);
}

/// The force at the start of a log depends on a past that the log does not contain.
#[test]
fn an_unknown_start_is_no_change_of_friction() {
    let bench = cylinder();
    let effects = [("coulomb-level", "coulomb_effort", 30.0)];
    let start = |time: f64, _: f64, speed: f64| if time < 0.8 { -45.0 * speed.signum() } else { 0.0 };
    let d = diagnosed(&bench, log(&bench, &effects, start));
    assert!(d.causes.iter().all(|c| c.effect != "friction-step"), "{:?} {:?}", d.verdict, d.causes);
    assert!((cause(&d, "coulomb-level").parameters[0].value / 30.0 - 1.0).abs() < 0.1);
}

/// As on a servo axis of a public benchmark: four cycles, described without friction.
#[test]
fn causes_that_hide_each_other_are_found_together() {
    let mut bench = cylinder();
    let Bench::FrictionRig(rig) = &mut bench else { panic!("an axis") };
    (rig.axis.coulomb_effort, rig.axis.viscous_effort) = (0.0, 0.0);
    (rig.axis.period_s, rig.axis.cycles) = (6.0, 4);
    let effects = [
        ("coulomb-level", "coulomb_effort", 20.0),
        ("viscous-friction", "viscous_effort", 200.0),
        ("viscous-asymmetry", "asymmetry_effort", -37.0),
    ];
    let d = diagnosed(&bench, log(&bench, &effects, |_, _, _| 0.0));
    assert_eq!((d.verdict, d.causes.len()), (Verdict::Named, 3), "{:?}", d.causes);
    for (name, _, value) in effects {
        let found = &cause(&d, name).parameters[0];
        assert!((found.value / value - 1.0).abs() < 0.1, "{name}: {}", found.value);
    }
}
