//! Effects that a log cannot separate are both reported with a proposed experiment. The experiment,
//! recorded on the true bench, identifies the true one together with the first log.

use super::{axis, diagnosed, effect, logged, with};
use bench::effects::Effect;
use bench::{Bench, Channel, MeasuredLog};
use diagnosis::{Diagnosis, Verdict};

fn group(d: &Diagnosis) -> Vec<&str> {
    let mut names: Vec<&str> = d.causes.iter().map(|c| c.effect.as_str()).collect();
    names.extend(d.ambiguous_with.iter().map(|a| a.effect.as_str()));
    names.sort_unstable();
    names
}

/// Hides `truth`, expects `pair` to be ambiguous, records the proposed experiment, and returns its
/// description.
fn resolved(bench: &Bench, truth: &Effect, pair: [&str; 2], library: &[&str]) -> String {
    let mut logs = vec![logged(&with(bench, truth.clone()), 5)];
    let first = diagnosed(bench, &logs, library);
    assert_eq!(first.verdict, Verdict::Ambiguous, "{:?} {:?}", group(&first), first.ranking);
    let names = group(&first);
    assert!(pair.iter().all(|name| names.contains(name)), "{names:?}");
    let experiment = first.experiment.as_ref().unwrap();
    assert_eq!(first.next_experiment.as_ref(), Some(&experiment.words));
    assert!(experiment.separation.iter().all(|s| s.chi_square > 20.0), "{experiment:?}");
    let log = |(seed, r): (u64, &diagnosis::Recording)| -> MeasuredLog {
        logged(&with(&Bench::parse("proposed", &r.bench).unwrap(), truth.clone()), seed)
    };
    logs.extend((17..).zip(&experiment.recordings).map(log));
    let second = diagnosed(bench, &logs, library);
    let found: Vec<_> = second.causes.iter().map(|c| (c.effect.as_str(), c.channel)).collect();
    let expected = vec![(truth.name.as_str(), truth.channel)];
    assert_eq!((second.verdict, found), (Verdict::Named, expected), "{experiment:?} {:?}", second.ranking);
    assert!(experiment.words.contains("together with those at hand"), "{}", experiment.words);
    experiment.words.clone()
}

/// The axis with changed parameters, and without the uncertainties of the pair's parameters.
fn certain(change: impl Fn(&mut bench::description::Axis)) -> Bench {
    let mut bench = axis(4);
    if let Some(rig) = bench.axis_mut() {
        rig.common.uncertain.clear();
        change(&mut rig.axis);
    }
    bench
}

#[test]
fn another_load_separates_a_friction_level_from_load_dependent_friction() {
    let pair = ["coulomb-level", "load-dependent-friction"];
    for truth in [
        effect("coulomb-level", None, "coulomb_effort", 10.0),
        effect("load-dependent-friction", None, "load_coefficient", 0.02),
    ] {
        let library = ["coulomb-level", "load-dependent-friction", "viscous-friction"];
        let words = resolved(&certain(|_| {}), &truth, pair, &library);
        // At any one load the two are alike; with the first log, one other load is enough.
        assert!(["half the load,", "twice the load,"].iter().any(|w| words.contains(w)), "{words}");
    }
}

#[test]
fn another_motion_separates_viscous_friction_from_a_sensor_delay() {
    // At one speed, a sine with a small delay is a sine with a small part of its rate.
    let mut bench = certain(|axis| (axis.coulomb_effort, axis.viscous_effort) = (0.0, 0.0));
    if let Some(rig) = bench.axis_mut() {
        rig.load.force_n = 0.0;
    }
    let pair = ["sensor-delay", "viscous-friction"];
    for truth in [
        effect("viscous-friction", None, "viscous_effort", 3.0),
        effect("sensor-delay", Some(Channel::DriveForce), "delay_s", 0.01),
    ] {
        resolved(&bench, &truth, pair, &["sensor-delay", "viscous-friction", "coulomb-level"]);
    }
}

#[test]
fn an_experiment_separates_asymmetric_friction_from_an_offset() {
    // The inertia is small, so that the few samples at the reversals do not separate them.
    let bench = certain(|axis| (axis.inertia, axis.coulomb_effort) = (1.0, 2.0));
    let pair = ["coulomb-asymmetry", "sensor-offset"];
    for truth in [
        effect("sensor-offset", Some(Channel::DriveForce), "offset", 0.8),
        effect("coulomb-asymmetry", None, "asymmetry_effort", 1.6),
    ] {
        resolved(&bench, &truth, pair, &["coulomb-asymmetry", "sensor-offset", "viscous-friction"]);
    }
}

#[test]
fn no_recording_is_proposed_if_none_separates_the_effects() {
    // The axis has inertia alone: a factor of the sensor and one of the mass are the same for every
    // motion.
    let mut bench = certain(|axis| (axis.coulomb_effort, axis.viscous_effort) = (0.0, 0.0));
    if let Some(rig) = bench.axis_mut() {
        rig.load.force_n = 0.0;
    }
    let truth = effect("inertia-mismatch", None, "inertia_change", 4.0);
    let d = diagnosed(&bench, &[logged(&with(&bench, truth), 5)], &["inertia-mismatch", "sensor-gain"]);
    assert_eq!((d.verdict, group(&d)), (Verdict::Ambiguous, vec!["inertia-mismatch", "sensor-gain"]));
    assert!(d.experiment.as_ref().unwrap().recordings.is_empty(), "{:?}", d.next_experiment);
    assert!(d.next_experiment.unwrap().starts_with("none of"));
}

#[test]
fn a_fall_beyond_all_recorded_speeds_is_no_rival_of_a_level() {
    // With few samples, the penalty of one more shape is below the difference that counts.
    let bench = axis(2);
    let truth = with(&bench, effect("coulomb-level", None, "coulomb_effort", 1.5));
    let mut log = logged(&truth, 10);
    let fifth = |values: &mut Vec<f64>| *values = values.iter().step_by(5).copied().collect();
    fifth(&mut log.time_s);
    log.channels.values_mut().for_each(fifth);
    let d = diagnosed(&bench, &[log], &["coulomb-level", "stribeck-friction"]);
    assert_eq!(d.verdict, Verdict::Named, "{:?} {:?}", d.causes, d.ambiguous_with);
    assert_eq!(d.causes[0].effect, "coulomb-level");
}
