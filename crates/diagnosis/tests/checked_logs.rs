//! Faults of a log are no effects of the plant: outliers and wrong units change neither verdict nor
//! cause.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bench::effects::Effect;
use bench::simulate::record;
use bench::{Bench, Channel, MeasuredLog};
use diagnosis::{Diagnosis, Options, Severity, Verdict, diagnose};

fn log(viscous_effort: f64) -> (Bench, MeasuredLog) {
    let described = Bench::open("friction-rig").unwrap();
    let mut bench = described.clone();
    bench.set_cycles(2);
    bench.effects_mut().push(Effect {
        name: "viscous-friction".into(),
        channel: None,
        of: None,
        parameters: [("viscous_effort".to_owned(), viscous_effort)].into(),
    });
    (described, record(&bench, 11).unwrap())
}

fn diagnosed(bench: &Bench, log: &MeasuredLog) -> Diagnosis {
    diagnose(bench, std::slice::from_ref(log), &[], &Options::default()).unwrap()
}

fn causes(d: &Diagnosis) -> Vec<&str> {
    d.causes.iter().map(|c| c.effect.as_str()).collect()
}

fn with_outliers(log: &MeasuredLog) -> MeasuredLog {
    let mut log = log.clone();
    let torque = log.channels.get_mut(&Channel::DriveTorque).unwrap();
    for i in 0..20 {
        torque[100 + 331 * i] += if i % 3 == 0 { -400.0 } else { 250.0 };
    }
    log
}

#[test]
fn twenty_outliers_do_not_change_the_verdict() {
    for (effort, verdict, cause) in
        [(0.0, Verdict::None, None), (300.0, Verdict::Named, Some("viscous-friction"))]
    {
        let (bench, clean) = log(effort);
        let (without, with) = (diagnosed(&bench, &clean), diagnosed(&bench, &with_outliers(&clean)));
        assert_eq!((without.verdict, causes(&without)), (verdict, cause.into_iter().collect()));
        assert_eq!((with.verdict, causes(&with)), (without.verdict, causes(&without)), "{:?}", with.checks);
        let finding = with.checks.iter().find(|f| f.kind == "outliers").unwrap();
        assert_eq!((finding.channel.as_str(), finding.evidence["outliers"]), ("drive_torque_nm", 20.0));
    }
}

#[test]
fn a_wrong_unit_is_reported_and_is_no_cause() {
    let (bench, mut log) = log(0.0);
    for value in log.channels.get_mut(&Channel::DriveTorque).unwrap() {
        *value *= -1e-3;
    }
    let d = diagnosed(&bench, &log);
    assert_eq!((d.verdict, causes(&d)), (Verdict::None, vec![]), "{:?}", d.checks);
    let wrong = d.checks.first().unwrap();
    assert_eq!((wrong.severity, wrong.kind), (Severity::Wrong, "unit"));
    assert_eq!(
        wrong.correction.as_deref(),
        Some("drive_torque_nm = { from = \"drive_torque_nm\", scale = -1000.0 }")
    );
}
