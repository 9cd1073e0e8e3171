//! Pairs of causes neither of which explains enough alone, because each hides the other. A pair
//! that imitates a third cause must not be named in its place.

use super::{axis, diagnosed, effect, logged, with};
use diagnosis::{Diagnosis, Verdict};

fn names(diagnosis: &Diagnosis) -> Vec<&str> {
    let mut names: Vec<&str> = diagnosis.causes.iter().map(|c| c.effect.as_str()).collect();
    names.sort_unstable();
    names
}

#[test]
fn a_step_and_a_ripple_of_equal_size_are_both_named() {
    let mut ripple = effect("load-ripple", None, "cos_force_n", 2.0);
    ripple.parameters.insert("frequency_hz".into(), 20.97);
    let mut step = effect("friction-step", None, "coulomb_effort", 2.0);
    step.parameters.insert("time_s".into(), 3.0);
    let hidden = with(&with(&axis(6), ripple), step);
    // With this library the first cause alone is not accepted: its residual is correlated over half
    // of the log.
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
fn two_causes_that_imitate_a_third_one_are_not_named() {
    let mut bench = axis(6);
    // Calibration has no parameter that it could move instead.
    if let Some(rig) = bench.axis_mut() {
        rig.common.uncertain.clear();
    }
    let viscous = effect("viscous-friction", None, "viscous_effort", 25.0);
    let log = [logged(&with(&bench, viscous), 5)];
    let d = diagnosed(&bench, &log, &["coulomb-level", "stribeck-friction"]);
    // Dry friction certainly lowers the error, but an unknown cause is at least as probable.
    assert_eq!((d.verdict, names(&d)), (Verdict::Partial, vec!["coulomb-level"]), "{:?}", d.explained_share);
    assert!(d.causes[0].probability <= 0.5 && d.probability_unknown >= 0.5, "{:?}", d.causes);
    let d = diagnosed(&bench, &log, &["coulomb-level", "stribeck-friction", "viscous-friction"]);
    assert_eq!((d.verdict, names(&d)), (Verdict::Named, vec!["viscous-friction"]));
}

#[test]
fn a_refinement_beyond_a_declared_number_enters_without_its_main_effect() {
    // The load coefficient, declared to .001, is wrong by .015: dry friction explains most of the
    // excess and would leave it at its bound.
    let mut bench = axis(6);
    if let Some(rig) = bench.axis_mut() {
        rig.common.uncertain = [("axis.coulomb_effort", 1.0), ("axis.load_coefficient", 1e-3)]
            .map(|(n, d)| (n.into(), d))
            .into();
    }
    let truth = with(&bench, effect("load-dependent-friction", None, "load_coefficient", 0.015));
    let truth = with(&truth, effect("coulomb-asymmetry", None, "asymmetry_effort", 10.0));
    let at = |load_n: f64, seed: u64| {
        let mut truth = truth.clone();
        if let Some(rig) = truth.axis_mut() {
            rig.load.force_n = load_n;
        }
        logged(&truth, seed)
    };
    let d = diagnosed(&bench, &[at(450.0, 450), at(600.0, 600)], &[]);
    assert_eq!(
        (d.verdict, names(&d)),
        (Verdict::Named, vec!["coulomb-asymmetry", "load-dependent-friction"]),
        "{:?}",
        d.rejection
    );
}
