//! Inspections of recorded logs: what is declared, shown and separated.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use super::*;
use bench::Channel;
use bench::simulate::record;

/// A friction rig with these parameters declared uncertain.
fn rig(uncertain: &[(&str, f64)]) -> Bench {
    let mut bench = Bench::open("friction-rig").unwrap();
    bench.axis_mut().unwrap().common.uncertain =
        uncertain.iter().map(|(name, deviation)| ((*name).to_owned(), *deviation)).collect();
    bench
}

fn inspected(bench: &Bench) -> Inspection {
    inspect(bench, &[record(bench, 3).unwrap()]).unwrap()
}

#[test]
fn a_parameter_that_the_motion_shows_is_determined() {
    let inspection = inspected(&rig(&[("axis.coulomb_effort", 1.0)]));
    let [parameter] = inspection.parameters.as_slice() else { panic!() };
    assert!(parameter.is_determined && parameter.remaining_deviation < 0.1, "{parameter:?}");
    assert!(inspection.not_determined.is_empty() && inspection.motions.is_empty());
    assert!(inspection.logs[0].rows > 1000);
}

#[test]
fn friction_that_a_constant_load_cannot_separate_is_named_with_the_load_that_would() {
    let mut bench = rig(&[("axis.coulomb_effort", 5.0), ("axis.load_coefficient", 0.05)]);
    bench.axis_mut().unwrap().load.ramp_s = 1e-6;
    let inspection = inspected(&bench);
    let pair = inspection.not_determined.iter().find(|r| r.kind == "correlated").unwrap();
    assert_eq!(pair.parameters, ["axis.coulomb_effort", "axis.load_coefficient"]);
    assert!(inspection.parameters.iter().all(|p| !p.is_determined));
    let [advice] = inspection.motions.as_slice() else { panic!("{:?}", inspection.motions) };
    assert!(advice.words.contains("load") && !advice.changes.is_empty(), "{advice:?}");
    assert_eq!(advice.parameters, pair.parameters);
}

#[test]
fn an_inertia_that_a_slow_motion_hides_is_named_with_a_faster_motion() {
    let inspection = inspected(&rig(&[("axis.inertia", 0.5)]));
    assert_eq!(inspection.not_determined[0].parameters, ["axis.inertia"], "{:?}", inspection.not_determined);
    assert!(inspection.motions[0].words.contains("fast"), "{:?}", inspection.motions);
}

#[test]
fn a_description_without_uncertain_parameters_has_nothing_to_determine() {
    let inspection = inspected(&rig(&[]));
    assert!(inspection.parameters.is_empty() && inspection.not_determined.is_empty());
}

#[test]
fn every_channel_has_its_noise_and_the_step_of_its_readings() {
    let bench = rig(&[]);
    let mut log = record(&bench, 3).unwrap();
    log.channels.get_mut(&Channel::DriveTorque).unwrap().iter_mut().for_each(|v| *v = v.round());
    let inspection = inspect(&bench, &[log]).unwrap();
    let torque = inspection.channels.iter().find(|c| c.channel == Channel::DriveTorque).unwrap();
    assert_eq!((torque.resolution, torque.role), (Some(1.0), "output"));
    let angle = inspection.channels.iter().find(|c| c.channel == Channel::SpindleAngle).unwrap();
    assert!(angle.role == "input" && angle.max > angle.min && angle.noise_source == "differences");
}
