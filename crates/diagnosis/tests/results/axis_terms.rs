//! Springs, friction along the stroke, constant efforts and areas of a driven axis are found by
//! name and size.

use super::{axis, diagnosed, effect, logged, with};
use bench::effects::Effect;
use bench::{Bench, MeasuredLog};
use diagnosis::{Diagnosis, Options, Verdict, diagnose};

/// The axis with a sweep from 2 s to 0.8 s or a constant period, and with a load that the axis
/// carries.
fn moving(last_period_s: f64) -> Bench {
    let mut bench = axis(8);
    if let Some(rig) = bench.axis_mut() {
        rig.axis.last_period_s = last_period_s;
    }
    bench
}

fn declare(bench: &mut Bench, number: &str, deviation: f64) {
    if let Some(rig) = bench.axis_mut() {
        rig.common.uncertain.insert(number.into(), deviation);
    }
}

/// The diagnosis with the whole catalogue.
fn all_effects(bench: &Bench, logs: &[MeasuredLog]) -> Diagnosis {
    diagnose(bench, logs, &[], &Options::default()).unwrap()
}

fn only_cause(d: &Diagnosis) -> (&str, f64) {
    assert_eq!((d.verdict, d.causes.len()), (Verdict::Named, 1), "{:?} {:?}", d.ranking, d.rejection);
    (&d.causes[0].effect, d.causes[0].parameters[0].value)
}

fn found(bench: &Bench, truth: Effect) -> Diagnosis {
    all_effects(bench, &[logged(&with(bench, truth), 5)])
}

#[test]
fn a_spring_is_named_where_the_frequency_changes() {
    let d = found(&moving(0.8), effect("spring-effort", None, "stiffness", 300.0));
    let (name, value) = only_cause(&d);
    assert!(name == "spring-effort" && (value / 300.0 - 1.0).abs() < 0.02, "{name} {value}");
}

#[test]
fn a_spring_on_one_sine_is_never_an_impossible_mass_and_another_period_separates_it() {
    let bench = moving(0.0);
    // As much force as 60 kg at this period, on an axis of 40 kg.
    let truth = effect("spring-effort", None, "stiffness", 600.0);
    let mut logs = vec![logged(&with(&bench, truth.clone()), 5)];
    let library = ["spring-effort", "inertia-mismatch", "viscous-friction", "coulomb-level"];
    let first = diagnosed(&bench, &logs, &library);
    assert_eq!(first.causes[0].effect, "spring-effort", "{:?}", first.ranking);
    let mut faster = bench.clone();
    if let Some(rig) = faster.axis_mut() {
        rig.axis.period_s = 1.3;
    }
    logs.push(logged(&with(&faster, truth), 6));
    let second = diagnosed(&bench, &logs, &library);
    let (name, value) = only_cause(&second);
    assert!(name == "spring-effort" && (value / 600.0 - 1.0).abs() < 0.02, "{name} {value}");
}

#[test]
fn friction_that_grows_along_the_stroke_is_named() {
    let d = found(&moving(0.0), effect("position-friction", None, "friction_slope", 80.0));
    let (name, value) = only_cause(&d);
    assert!(name == "position-friction" && (value / 80.0 - 1.0).abs() < 0.05, "{name} {value}");
}

#[test]
fn a_constant_effort_that_is_declared_uncertain_is_calibrated() {
    let mut bench = moving(0.0);
    declare(&mut bench, "axis.constant_effort", 50.0);
    let mut truth = bench.clone();
    *truth.parameter_mut("axis.constant_effort").unwrap() = 98.1;
    let d = all_effects(&bench, &[logged(&truth, 5)]);
    assert_eq!((d.verdict, d.causes.len()), (Verdict::None, 0), "{:?}", d.ranking);
    let number = d.calibrated.iter().find(|n| n.name == "axis.constant_effort").unwrap();
    assert!((number.value / 98.1 - 1.0).abs() < 0.01, "{number:?}");
}

#[test]
fn an_area_beyond_its_declared_tolerance_is_a_load_gain() {
    // The bore is 6.5 % too large: 13.4 % more area, declared within 1 %.
    let mut bench = moving(0.0);
    declare(&mut bench, "axis.load_gain", 0.01);
    let loads = [200.0, 500.0, 900.0].map(|force_n| {
        let mut bench = with(&bench, effect("load-gain", None, "gain_change", 0.134));
        if let Some(rig) = bench.axis_mut() {
            rig.load.force_n = force_n;
        }
        logged(&bench, 5)
    });
    let d = all_effects(&bench, &loads);
    let (name, value) = only_cause(&d);
    assert!(name == "load-gain" && (value / 0.134 - 1.0).abs() < 0.02, "{name} {value}");
}
