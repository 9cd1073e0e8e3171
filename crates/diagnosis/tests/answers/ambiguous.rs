//! Effects that a log cannot tell apart are both named, with an experiment; the experiment, simulated, tells the truth together with the
//! log at hand.

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

/// Hides `truth` where `pair` cannot be told apart, then records what is proposed; its words.
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
    let wanted = vec![(truth.name.as_str(), truth.channel)];
    assert_eq!((second.verdict, found), (Verdict::Named, wanted), "{experiment:?} {:?}", second.ranking);
    assert!(experiment.words.contains("together with those at hand"), "{}", experiment.words);
    experiment.words.clone()
}

/// The axis without what declares the pair's parameters uncertain.
fn certain(change: impl Fn(&mut bench::description::Axis)) -> Bench {
    let mut bench = axis(4);
    if let Bench::FrictionRig(rig) = &mut bench {
        rig.uncertain.clear();
        change(&mut rig.axis);
    }
    bench
}

#[test]
fn friction_that_follows_the_load_or_not_at_one_load() {
    let pair = ["coulomb-level", "load-dependent-friction"];
    for truth in [
        effect("coulomb-level", None, "coulomb_effort", 10.0),
        effect("load-dependent-friction", None, "load_coefficient", 0.02),
    ] {
        let library = ["coulomb-level", "load-dependent-friction", "viscous-friction"];
        let words = resolved(&certain(|_| {}), &truth, pair, &library);
        // At any one load the two are alike; with the log at hand one other load is enough.
        assert!(["half the load,", "twice the load,"].iter().any(|w| words.contains(w)), "{words}");
    }
}

#[test]
fn viscous_friction_or_a_late_sensor_on_a_sine() {
    // At one speed a sine late by a little is a sine with a little of its rate.
    let mut bench = certain(|axis| (axis.coulomb_effort, axis.viscous_effort) = (0.0, 0.0));
    if let Bench::FrictionRig(rig) = &mut bench {
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
fn friction_that_differs_between_directions_or_an_offset() {
    // Small, so that the few samples at the reversals, where a sign has no value, do not tell.
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
fn where_no_experiment_tells_none_is_proposed() {
    // Nothing but inertia is felt: a factor of the sensor and one of the mass are the same at every motion.
    let mut bench = certain(|axis| (axis.coulomb_effort, axis.viscous_effort) = (0.0, 0.0));
    if let Bench::FrictionRig(rig) = &mut bench {
        rig.load.force_n = 0.0;
    }
    let truth = effect("inertia-mismatch", None, "inertia_change", 4.0);
    let d = diagnosed(&bench, &[logged(&with(&bench, truth), 5)], &["inertia-mismatch", "sensor-gain"]);
    assert_eq!((d.verdict, group(&d)), (Verdict::Ambiguous, vec!["inertia-mismatch", "sensor-gain"]));
    assert!(d.experiment.as_ref().unwrap().recordings.is_empty(), "{:?}", d.next_experiment);
    assert!(d.next_experiment.unwrap().starts_with("none of"));
}

#[test]
fn a_fall_with_speed_beyond_all_speeds_is_no_rival_of_a_level() {
    // Where samples are few, a shape more costs less than the difference that counts.
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
