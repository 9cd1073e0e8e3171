//! Logs with impossible readings, coarse sensors, gaps, and rows that do not fit together.

use super::rows::{keep_rows, multiply};
use super::tests::{found, real, wrong_findings};
use super::*;
use bench::Channel;
use bench::simulate::record;

fn by_kind<'a>(findings: &'a [Finding], kind: &str, channel: Channel) -> Vec<&'a Finding> {
    findings.iter().filter(|f| f.kind == kind && f.channel == channel.name()).collect()
}

#[test]
fn a_gross_error_hides_neither_the_resolution_nor_another_outlier() {
    let clean = record(&real(5), 5).unwrap();
    for gross in [999_999.0, -1e30, 1e300] {
        let mut log = clean.clone();
        let values = log.channels.get_mut(&Channel::JournalY).unwrap();
        values[800] = gross;
        values[1300] += 5e-5;
        let (after, findings) = found(&log);
        assert_eq!(by_kind(&findings, "quantised", Channel::JournalY).len(), 0, "{findings:#?}");
        assert_eq!(after.time_s.len(), clean.time_s.len() - 2, "{findings:#?}");
        assert_eq!(wrong_findings(&findings), []);
    }
    // The resolution of a coarse sensor is found beside a gross error.
    let mut log = clean;
    for v in log.channels.get_mut(&Channel::FrictionTorque).unwrap() {
        *v = (*v / 2.5).round() * 2.5;
    }
    log.channels.get_mut(&Channel::FrictionTorque).unwrap()[700] = 1.3e6;
    let (_, findings) = found(&log);
    let step = by_kind(&findings, "quantised", Channel::FrictionTorque)[0].evidence["step"];
    assert!((step - 2.5).abs() < 1e-9, "{step}");
}

#[test]
fn rows_with_readings_near_the_largest_number_are_left_out() {
    let clean = record(&real(5), 5).unwrap();
    for channel in [Channel::DriveVelocity, Channel::DriveDisplacement, Channel::ShaftSpeed] {
        let mut log = clean.clone();
        log.channels.get_mut(&channel).unwrap()[900..902].fill(1.797e308);
        let (after, findings) = found(&log);
        assert_eq!(wrong_findings(&findings), [], "{findings:#?}");
        assert!(after.time_s.len() + 4 >= clean.time_s.len(), "{findings:#?}");
        assert!(after.channels[&channel].iter().all(|v| v.abs() < 1e3), "{channel}");
    }
}

#[test]
fn signals_with_overflowing_squares_or_missing_values_have_no_relation() {
    let time_s: Vec<f64> = (0..100).map(|i| 0.01 * f64::from(i)).collect();
    let wave: Vec<f64> = time_s.iter().map(|t| (6.0 * t).sin()).collect();
    for (value, rate) in [(1e200, 1.0), (1.0, 1e200), (f64::NAN, 1.0), (1.0, f64::NAN)] {
        let scaled = |factor: f64| wave.iter().map(|v| factor * v).collect::<Vec<_>>();
        assert!(motion::relation(&time_s, &scaled(value), &scaled(rate)).is_none());
    }
}

#[test]
fn an_encoder_with_a_resolution_of_one_degree_is_coarse_and_not_stuck() {
    let mut log = record(&real(5), 5).unwrap();
    let degree = core::f64::consts::PI / 180.0;
    for v in log.channels.get_mut(&Channel::ShaftAngle).unwrap() {
        *v = (*v / degree).round() * degree;
    }
    let (after, findings) = found(&log);
    assert_eq!(wrong_findings(&findings), [], "{findings:#?}");
    assert_eq!(by_kind(&findings, "stuck", Channel::ShaftAngle).len(), 0, "{findings:#?}");
    assert_eq!(by_kind(&findings, "quantised", Channel::ShaftAngle).len(), 1, "{findings:#?}");
    assert_eq!(after.time_s.len(), log.time_s.len());
}

#[test]
fn a_gap_in_the_log_does_not_make_the_velocity_contradict_the_position() {
    let clean = record(&real(5), 5).unwrap();
    let rows = clean.time_s.len();
    for gap in [rows / 8..rows * 3 / 8, rows / 2..rows * 3 / 4] {
        let mut log = clean.clone();
        let mut keep = vec![true; rows];
        keep[gap].fill(false);
        keep_rows(&mut log, &keep);
        let (after, findings) = found(&log);
        assert_eq!(findings.iter().filter(|f| f.kind == "contradiction").count(), 0, "{findings:#?}");
        assert_eq!(wrong_findings(&findings), []);
        assert!(after.channels.contains_key(&Channel::DriveVelocity));
        // A wrong velocity is still found beside the gap.
        multiply(&mut log, Channel::DriveVelocity, 1.4);
        assert_eq!(wrong_findings(&found(&log).1), [("drive_velocity_m_s", "contradiction")]);
    }
}

#[test]
fn times_stay_as_they_are_if_only_the_sample_rate_indicates_another_clock_unit() {
    let mut log = record(&real(5), 5).unwrap();
    log.channels.remove(&Channel::DriveVelocity);
    // Half a stroke at one row per second: nothing shows how long it took.
    let from = log.time_s.len() / 8;
    let keep: Vec<bool> = (0..log.time_s.len()).map(|i| (from..from + 200).contains(&i)).collect();
    keep_rows(&mut log, &keep);
    log.time_s = (0..200).map(f64::from).collect();
    let bench = Bench::open("bench-b").unwrap();
    let mut findings = Vec::new();
    let mut after = log.clone();
    clock::correct_unit(&bench, &mut after, &mut findings);
    assert_eq!(after, log, "{findings:#?}");
    let [finding] = findings.as_slice() else { panic!("{findings:#?}") };
    assert_eq!((finding.kind, finding.severity, &finding.applied), ("clock-unit", Severity::Doubtful, &None));
    assert!(finding.correction.as_deref().unwrap().contains("scale = 0.001"));
}

#[test]
fn rows_without_all_inputs_are_refused_with_the_counts() {
    let mut log = record(&real(5), 5).unwrap();
    for (channel, odd) in [(Channel::DriveDisplacement, 0), (Channel::LoadForce, 1)] {
        for (row, v) in log.channels.get_mut(&channel).unwrap().iter_mut().enumerate() {
            if row % 2 == odd {
                *v = f64::NAN;
            }
        }
    }
    let rows = log.time_s.len();
    let error = check(&Bench::open("bench-b").unwrap(), &[log], &[]).err().unwrap().to_string();
    for words in [
        format!("0 of {rows} rows"),
        format!("drive_displacement_m {}", rows.div_ceil(2)),
        format!("load_force_n {}", rows / 2),
    ] {
        assert!(error.contains(&words), "{error}");
    }
}
