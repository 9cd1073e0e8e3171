//! Parameters that the logs do not determine.

use super::{axis, diagnosed, effect, logged, with};

fn kinds<'a>(d: &'a diagnosis::Diagnosis, kind: &str) -> Vec<&'a [String]> {
    d.identifiability.iter().filter(|i| i.kind == kind).map(|i| i.parameters.as_slice()).collect()
}

#[test]
fn a_determined_parameter_is_not_listed() {
    let bench = axis(4);
    let truth = with(&bench, effect("coulomb-level", None, "coulomb_effort", 20.0));
    let d = diagnosed(&bench, &[logged(&truth, 5)], &["coulomb-level"]);
    assert_eq!(d.causes[0].effect, "coulomb-level");
    assert!(d.identifiability.is_empty(), "{:?}", d.identifiability);
}

#[test]
fn a_level_and_a_load_coefficient_at_one_load_are_correlated() {
    let mut bench = axis(4);
    if let Some(rig) = bench.axis_mut() {
        rig.common.uncertain =
            [("axis.coulomb_effort", 10.0), ("axis.load_coefficient", 0.02), ("load.force_n", 5.0)]
                .map(|(name, deviation)| (name.to_owned(), deviation))
                .into();
    }
    let d = diagnosed(&bench, &[logged(&bench, 5)], &["viscous-friction"]);
    let pair = ["axis.coulomb_effort".to_owned(), "axis.load_coefficient".to_owned()];
    assert_eq!(kinds(&d, "correlated"), [&pair[..]], "{:?}", d.identifiability);
    assert_eq!(kinds(&d, "flat-direction"), [&pair[..]], "{:?}", d.identifiability);
}

#[test]
fn a_coefficient_without_a_load_is_dead() {
    let mut bench = axis(4);
    if let Some(rig) = bench.axis_mut() {
        rig.load.force_n = 0.0;
        rig.common.uncertain.insert("axis.load_coefficient".into(), 0.02);
    }
    let d = diagnosed(&bench, &[logged(&bench, 5)], &["viscous-friction"]);
    assert_eq!(kinds(&d, "dead"), [&["axis.load_coefficient".to_owned()][..]], "{:?}", d.identifiability);
}

#[test]
fn a_parameter_known_only_from_its_prior_is_not_pinned() {
    let mut bench = axis(4);
    if let Some(rig) = bench.axis_mut() {
        rig.common.uncertain = [("axis.inertia".to_owned(), 0.02)].into();
    }
    let d = diagnosed(&bench, &[logged(&bench, 5)], &["coulomb-level"]);
    assert_eq!(kinds(&d, "not-pinned"), [&["axis.inertia".to_owned()][..]], "{:?}", d.identifiability);
}

#[test]
fn an_estimate_on_a_bound_of_its_range_is_reported() {
    let mut bench = axis(4);
    if let Some(rig) = bench.axis_mut() {
        rig.common.uncertain = [("axis.inertia".to_owned(), 0.2)].into();
    }
    let mut heavy = bench.clone();
    if let Some(rig) = heavy.axis_mut() {
        rig.axis.inertia += 1.0;
    }
    let d = diagnosed(&bench, &[logged(&heavy, 5)], &["coulomb-level"]);
    assert_eq!(kinds(&d, "at-bound"), [&["axis.inertia".to_owned()][..]], "{:?}", d.identifiability);
}
