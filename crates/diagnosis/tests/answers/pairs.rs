//! Two causes, neither of which explains enough alone: what the other one leaves must not pass for noise, nor two that trade off for a third.

use super::{axis, diagnosed, effect, logged, with};
use bench::Bench;
use diagnosis::{Diagnosis, Verdict};

fn names(diagnosis: &Diagnosis) -> Vec<&str> {
    let mut names: Vec<&str> = diagnosis.causes.iter().map(|c| c.effect.as_str()).collect();
    names.sort_unstable();
    names
}

#[test]
fn a_step_beside_a_ripple_leaves_the_ripple_its_evidence() {
    let mut ripple = effect("load-ripple", None, "cos_force_n", 2.0);
    ripple.parameters.insert("frequency_hz".into(), 20.97);
    let mut step = effect("friction-step", None, "coulomb_effort", 2.0);
    step.parameters.insert("time_s".into(), 3.0);
    let hidden = with(&with(&axis(6), ripple), step);
    // With these the first cause alone is not accepted: what it leaves is correlated over half of the log.
    let library = [
        "coulomb-asymmetry",
        "friction-step",
        "inertia-mismatch",
        "load-ripple",
        "sensor-drift",
        "sensor-gain",
        "sensor-offset",
        "sensor-saturation",
    ];
    let d = diagnosed(&axis(6), &[logged(&hidden, 5)], &library);
    assert_eq!(d.verdict, Verdict::Named, "{:?}", d.ranking);
    assert_eq!(names(&d), ["friction-step", "load-ripple"]);
}

#[test]
fn two_causes_that_trade_off_are_no_third_one() {
    let mut bench = axis(6);
    // Nothing that calibration could move instead.
    if let Bench::FrictionRig(rig) = &mut bench {
        rig.uncertain.clear();
    }
    let viscous = effect("viscous-friction", None, "viscous_effort", 25.0);
    let log = [logged(&with(&bench, viscous), 5)];
    let d = diagnosed(&bench, &log, &["coulomb-level", "stribeck-friction"]);
    assert_eq!(d.verdict, Verdict::Unknown, "{:?} {:?}", d.causes, d.explained_share);
    let d = diagnosed(&bench, &log, &["coulomb-level", "stribeck-friction", "viscous-friction"]);
    assert_eq!((d.verdict, names(&d)), (Verdict::Named, vec!["viscous-friction"]));
}

#[test]
fn a_refinement_that_a_declared_number_cannot_reach_enters_without_its_main_effect() {
    // The load coefficient, declared to .001, is .015 off: dry friction takes most of what lies beyond and would leave it at its bound.
    let mut bench = axis(6);
    if let Bench::FrictionRig(rig) = &mut bench {
        rig.uncertain = [("axis.coulomb_effort", 1.0), ("axis.load_coefficient", 1e-3)]
            .map(|(n, d)| (n.into(), d))
            .into();
    }
    let truth = with(&bench, effect("load-dependent-friction", None, "load_coefficient", 0.015));
    let truth = with(&truth, effect("coulomb-asymmetry", None, "asymmetry_effort", 10.0));
    let at = |load_n: f64, seed: u64| {
        let mut truth = truth.clone();
        if let Bench::FrictionRig(rig) = &mut truth {
            rig.load.force_n = load_n;
        }
        logged(&truth, seed)
    };
    let d = diagnosed(&bench, &[at(450.0, 450), at(600.0, 600)], &[]);
    assert_eq!(
        (d.verdict, names(&d)),
        (Verdict::Named, vec!["coulomb-asymmetry", "load-dependent-friction"]),
        "{:?}",
        d.refused
    );
}
