//! Diagnosis of a mechanism: logs of a four-bar that EXUDYN simulated, with another joint friction,
//! a worn joint, or as described.
//!
//! `crates/bench/benches/peers/exudyn_four_bar.py` wrote the logs; its README has the commands. It
//! shares no code with the bench and adds the noise of `examples/four-bar-log.toml`. A clearance
//! and a mass differ from the description, too, within their declared uncertainty.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bench::{Bench, MeasuredLog};
use diagnosis::{Diagnosis, Options, Verdict, diagnose};

fn diagnosed(log: &str) -> Diagnosis {
    let text = include_str!("../../../examples/four-bar-log.toml");
    let bench = Bench::parse("four-bar-log.toml", text).unwrap();
    let path = format!("{}/tests/logs/{log}.csv", env!("CARGO_MANIFEST_DIR"));
    let log = MeasuredLog::read(path.as_ref(), &bench.log_format()).unwrap();
    diagnose(&bench, &[log], &[], &Options::default()).unwrap()
}

/// Requires one named cause with its part, and an interval of its size around the truth.
fn assert_named(log: &str, effect: &str, part: &str, size: f64) {
    let d = diagnosed(log);
    let summary = format!("{:?} {:?} left {:?} ranking {:?}", d.verdict, d.causes, d.signature, d.ranking);
    assert_eq!(d.verdict, Verdict::Named, "{summary}");
    let [cause] = &d.causes[..] else { unreachable!("one cause: {summary}") };
    assert_eq!((cause.effect.as_str(), cause.of.as_deref()), (effect, Some(part)), "{summary}");
    let [parameter] = &cause.parameters[..] else { unreachable!("one parameter: {summary}") };
    let [low, high] = parameter.ci95;
    assert!((low..=high).contains(&size) && high - low < 0.3 * size, "{parameter:?} for {size}");
    assert!(d.explained_share.is_some_and(|share| share > 0.95), "{:?}", d.explained_share);
}

#[test]
fn a_log_within_the_declared_uncertainty_has_no_cause() {
    let d = diagnosed("four-bar-clean");
    assert_eq!(d.verdict, Verdict::None, "{:?} {:?} {:?}", d.causes, d.signature, d.ranking);
}

#[test]
#[ignore = "slow, some 100 s of a core: cargo test -p diagnosis --test mechanism -- --ignored"]
fn the_friction_of_one_of_two_joints_is_found() {
    assert_named("four-bar-friction", "coulomb-level", "rocker_coupler", 0.06);
}

#[test]
fn wear_of_one_of_two_joints_is_found() {
    assert_named("four-bar-wear", "clearance-wear", "rocker_coupler", 3e-5);
}

#[test]
#[ignore = "slow, some 70 s of a core: cargo test -p diagnosis --test mechanism -- --ignored"]
fn viscous_friction_of_an_ideal_pin_is_found() {
    assert_named("four-bar-viscous", "viscous-friction", "ground_rocker", 0.02);
}
