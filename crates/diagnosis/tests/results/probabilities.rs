//! Probabilities of nothing, of every fitted cause, and of an unknown cause.

use super::{axis, diagnosed, effect, logged, with};
use bench::effects::Effect;
use bench::{Bench, Channel, MeasuredLog};
use diagnosis::{Diagnosis, Verdict};

/// The reason why a selected cause is rejected.
fn rejection_reason(d: &Diagnosis) -> &str {
    d.rejection.as_ref().map_or("", |r| r.reason.as_str())
}

fn sums_to_one(d: &Diagnosis) -> bool {
    let causes: f64 = d.hypotheses.iter().map(|h| h.probability).sum();
    let all = d.hypotheses.iter().map(|h| h.probability).chain([d.probability_none, d.probability_unknown]);
    (causes + d.probability_none + d.probability_unknown - 1.0).abs() < 1e-9
        && all.into_iter().all(|p| (0.0..=1.0).contains(&p))
}

/// A log of the axis with a force outside the catalogue: the fifth harmonic of the motion.
fn foreign(bench: &Bench, size: f64) -> MeasuredLog {
    let mut log = logged(bench, 9);
    let times = log.time_s.clone();
    for (t, force) in times.iter().zip(log.channels.get_mut(&Channel::DriveForce).unwrap()) {
        *force += size * (std::f64::consts::PI * 5.0 * t).cos();
    }
    log
}

#[test]
fn the_verdict_has_most_of_the_probability_and_all_add_up_to_one() {
    let (bench, library) = (axis(6), ["coulomb-level", "viscous-friction"]);
    let clean = diagnosed(&bench, &[logged(&bench, 5)], &library);
    assert!(clean.verdict == Verdict::None && sums_to_one(&clean));
    assert!(clean.probability_none > 0.9, "{} {}", clean.probability_none, clean.probability_unknown);

    let truth = with(&bench, effect("coulomb-level", None, "coulomb_effort", 5.0));
    let named = diagnosed(&bench, &[logged(&truth, 5)], &library);
    assert!(named.verdict == Verdict::Named && sums_to_one(&named));
    assert!(named.causes[0].probability > 0.9, "{:?} {}", named.hypotheses, named.probability_unknown);

    let unknown = diagnosed(&bench, &[foreign(&bench, 8.0)], &library);
    assert!(unknown.verdict == Verdict::Unknown && sums_to_one(&unknown));
    assert!(unknown.probability_unknown > 0.9, "{:?} {}", unknown.hypotheses, unknown.probability_unknown);
}

#[test]
fn remaining_structure_makes_a_cause_less_probable() {
    let bench = axis(6);
    let truth = with(&bench, effect("coulomb-level", None, "coulomb_effort", 20.0));
    let share = |size: f64| {
        let d = diagnosed(&bench, &[foreign(&truth, size)], &["coulomb-level"]);
        assert!(sums_to_one(&d));
        d.probability_unknown
    };
    let (nothing, some, much) = (share(0.0), share(5.0), share(20.0));
    assert!(nothing < 0.05 && nothing < some && some < 0.5 && much > 0.5, "{nothing} {some} {much}");
}

#[test]
fn both_causes_and_each_alone_are_hypotheses() {
    let bench = axis(6);
    let one = with(&bench, effect("coulomb-level", None, "coulomb_effort", 10.0));
    let both = with(&one, effect("viscous-friction", None, "viscous_effort", 60.0));
    let d = diagnosed(&bench, &[logged(&both, 5)], &["coulomb-level", "viscous-friction"]);
    assert!(d.verdict == Verdict::Named && sums_to_one(&d));
    assert_eq!(d.causes.len(), 2);
    assert!(d.hypotheses[0].causes.len() == 2 && d.hypotheses[0].probability > 0.9, "{:?}", d.hypotheses);
}

#[test]
fn a_rejected_cause_is_not_probable() {
    let bench = axis(6);
    for (name, parameter, size) in [
        ("coulomb-level", "coulomb_effort", 1.5),
        ("viscous-friction", "viscous_effort", 12.0),
        ("coulomb-asymmetry", "asymmetry_effort", 2.0),
        ("stribeck-friction", "effort_rise", 6.0),
        ("breakaway", "excess_effort", 6.0),
        ("presliding-hysteresis", "distance_m", 2e-4),
    ] {
        let truth = with(&bench, effect(name, None, parameter, size));
        let others = bench::effects::CATALOGUE.iter().map(|k| k.name).filter(|other| *other != name);
        let d = diagnosed(&bench, &[logged(&truth, 5)], &others.collect::<Vec<_>>());
        let likely = d.hypotheses.iter().map(|h| h.probability).fold(0.0, f64::max);
        assert!(
            sums_to_one(&d) && (d.verdict != Verdict::Unknown || likely < 0.5),
            "{name}: {:?}",
            d.hypotheses
        );
    }
}

#[test]
fn a_parameter_at_its_bound_makes_no_other_cause_probable() {
    // The mass, declared to 1 kg, is wrong by 4.2 kg: a ripple explains the excess, and is no
    // cause.
    let truth = with(&axis(6), effect("inertia-mismatch", None, "inertia_change", 4.2));
    let others = bench::effects::CATALOGUE.iter().map(|k| k.name).filter(|name| *name != "inertia-mismatch");
    let d = diagnosed(&axis(6), &[logged(&truth, 5)], &others.collect::<Vec<_>>());
    assert!(d.verdict == Verdict::Unknown && sums_to_one(&d));
    assert!(d.signature.is_none() && d.probability_unknown > 0.9, "{:?}", d.hypotheses);
}

#[test]
fn an_effect_that_leaves_a_parameter_at_its_bound_is_no_cause() {
    // The viscous friction, declared to 3 N s/m, is wrong by 20 N s/m: a level explains much of the
    // excess, and leaves the parameter at its bound.
    let truth = with(&axis(6), effect("viscous-friction", None, "viscous_effort", 20.0));
    let d = diagnosed(&axis(6), &[logged(&truth, 5)], &["coulomb-level"]);
    assert!(d.verdict == Verdict::Unknown && d.probability_unknown > 0.9, "{:?}", d.causes);
    assert_eq!(rejection_reason(&d), "declared-number-at-bound");
}

#[test]
fn an_effect_at_the_end_of_its_shape_is_no_cause() {
    // Static friction that never ages is a level.
    let bench = axis(6);
    let truth = with(&bench, effect("coulomb-level", None, "coulomb_effort", 6.0));
    let d = diagnosed(&bench, &[logged(&truth, 5)], &["breakaway"]);
    assert!(d.verdict == Verdict::Unknown && sums_to_one(&d), "{:?}", d.causes);
    assert!(d.probability_unknown > 0.9 && rejection_reason(&d) == "shape-at-bound", "{:?}", d.hypotheses);
}

#[test]
fn an_effect_of_the_speed_alone_is_no_cause_of_friction_with_memory() {
    // A fall with speed imitates most of a static friction, and differs in size between rising and
    // falling speed.
    let parameters = [("excess_effort", 20.0), ("rest_time_s", 0.15), ("distance_m", 2e-3)];
    let parameters = parameters.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    let breakaway = Effect { name: "breakaway".into(), channel: None, of: None, parameters };
    let d = diagnosed(&axis(6), &[logged(&with(&axis(6), breakaway), 5)], &["stribeck-friction"]);
    assert!(d.verdict == Verdict::Unknown && d.probability_unknown > 0.9, "{:?}", d.causes);
    assert_eq!(rejection_reason(&d), "no-memory");
    let fall = with(&axis(6), effect("stribeck-friction", None, "effort_rise", 20.0));
    let d = diagnosed(&axis(6), &[logged(&fall, 5)], &["stribeck-friction"]);
    assert!(d.verdict == Verdict::Named && d.rejection.is_none());
}
