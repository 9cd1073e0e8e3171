//! Probabilities over nothing, every fitted cause, and something unknown.

use super::{axis, diagnosed, effect, logged, with};
use bench::{Bench, Channel, MeasuredLog};
use diagnosis::{Diagnosis, Verdict};

fn sums_to_one(d: &Diagnosis) -> bool {
    let causes: f64 = d.hypotheses.iter().map(|h| h.probability).sum();
    let all = d.hypotheses.iter().map(|h| h.probability).chain([d.probability_none, d.probability_unknown]);
    (causes + d.probability_none + d.probability_unknown - 1.0).abs() < 1e-9
        && all.into_iter().all(|p| (0.0..=1.0).contains(&p))
}

/// A log of the axis with a force that no effect of the library makes: the fifth harmonic of the motion.
fn foreign(bench: &Bench, size: f64) -> MeasuredLog {
    let mut log = logged(bench, 9);
    let times = log.time_s.clone();
    for (t, force) in times.iter().zip(log.channels.get_mut(&Channel::DriveForce).unwrap()) {
        *force += size * (std::f64::consts::PI * 5.0 * t).cos();
    }
    log
}

#[test]
fn each_answer_has_most_of_the_probability_and_all_add_up_to_one() {
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
fn what_a_cause_leaves_makes_it_less_sure() {
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
fn of_two_causes_both_and_each_alone_are_hypotheses() {
    let bench = axis(6);
    let one = with(&bench, effect("coulomb-level", None, "coulomb_effort", 10.0));
    let both = with(&one, effect("viscous-friction", None, "viscous_effort", 60.0));
    let d = diagnosed(&bench, &[logged(&both, 5)], &["coulomb-level", "viscous-friction"]);
    assert!(d.verdict == Verdict::Named && sums_to_one(&d));
    assert_eq!(d.causes.len(), 2);
    assert!(d.hypotheses[0].causes.len() == 2 && d.hypotheses[0].probability > 0.9, "{:?}", d.hypotheses);
}

#[test]
fn what_is_not_accepted_is_not_probable() {
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
