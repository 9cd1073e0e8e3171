//! Faults hidden in recorded logs, each of which must be found by its kind.

use super::rows::{keep_rows, multiply};
use super::*;
use bench::Channel;
use bench::log::LogFormat;
use bench::simulate::record;
use bench::simulate::{Inputs, respond};

/// A bench that differs from its description within the declared uncertainty.
pub(super) fn real(seed: u64) -> Bench {
    let mut bench = Bench::open("bench-b").unwrap();
    bench.set_cycles(2);
    let sign = |shift: u64| if (seed >> shift) & 1 == 1 { 1.0 } else { -1.0 };
    for (i, (name, deviation)) in bench.uncertain().clone().into_iter().enumerate() {
        *bench.parameter_mut(&name).unwrap() += 1.5 * sign(i as u64) * deviation;
    }
    bench
}

pub(super) fn found(log: &MeasuredLog) -> (MeasuredLog, Vec<Finding>) {
    let bench = Bench::open("bench-b").unwrap();
    let mut checked = check(&bench, std::slice::from_ref(log), &[]).unwrap();
    (checked.logs.remove(0), checked.findings)
}

pub(super) fn wrong_findings(findings: &[Finding]) -> Vec<(&str, &'static str)> {
    findings.iter().filter(|f| f.severity == Severity::Wrong).map(|f| (f.channel.as_str(), f.kind)).collect()
}

/// Hides a fault in a log, and asserts that it is the only finding, and that none is left after the
/// correction.
fn hidden(change: impl Fn(&mut MeasuredLog), channel: &str, kind: &'static str) -> Finding {
    let mut log = record(&real(5), 5).unwrap();
    change(&mut log);
    let (corrected, findings) = found(&log);
    assert_eq!(wrong_findings(&findings), [(channel, kind)], "{findings:#?}");
    assert_eq!(wrong_findings(&found(&corrected).1), [], "after the correction");
    findings.into_iter().find(|f| f.severity == Severity::Wrong).unwrap()
}

fn times(channel: Channel, factor: f64) -> impl Fn(&mut MeasuredLog) {
    move |log| multiply(log, channel, factor)
}

#[test]
fn units_are_named_and_corrected() {
    for (channel, factor, words) in [
        (Channel::BearingForceY, 1e-3, "kN"),
        (Channel::BearingForceZ, 1e3, "mN"),
        (Channel::DriveForce, 1.0 / 9.806_65, "kgf"),
        (Channel::JournalY, 1e6, "um"),
        (Channel::JournalZ, 1e3, "mm"),
        (Channel::ShaftAngle, 57.295_779_5, "degrees"),
        (Channel::ShaftSpeed, 9.549_297, "revolutions"),
        (Channel::FrictionTorque, 1e3, "N mm"),
        (Channel::DriveDisplacement, 1e3, "mm"),
        (Channel::DriveVelocity, 1e3, "mm/s"),
        (Channel::LoadForce, 1e-3, "kN"),
    ] {
        let finding = hidden(times(channel, factor), channel.name(), "unit");
        assert!(finding.cause.contains(words), "{finding:?}");
        let correction: bench::log::Columns = toml::from_str(finding.correction.as_deref().unwrap()).unwrap();
        let scale = correction.get(channel.name()).unwrap().scale;
        assert!((scale * factor - 1.0).abs() < 1e-6, "{finding:?}");
    }
}

#[test]
fn a_position_and_a_speed_in_the_same_wrong_unit_are_found_by_the_stroke() {
    let mut log = record(&real(5), 5).unwrap();
    multiply(&mut log, Channel::DriveDisplacement, 1e3);
    multiply(&mut log, Channel::DriveVelocity, 1e3);
    let (corrected, findings) = found(&log);
    let expected = [("drive_displacement_m", "unit"), ("drive_velocity_m_s", "unit")];
    assert_eq!(wrong_findings(&findings), expected, "{findings:#?}");
    assert!(findings.iter().any(|f| f.correction.as_deref().is_some_and(|line| {
        line == "drive_velocity_m_s = { from = \"drive_velocity_m_s\", scale = 0.001 }"
    })));
    assert_eq!(wrong_findings(&found(&corrected).1), [], "after the correction");
}

#[test]
fn a_drive_without_velocity_is_compared_by_its_stroke() {
    let change = |log: &mut MeasuredLog| {
        log.channels.remove(&Channel::DriveVelocity);
        multiply(log, Channel::DriveDisplacement, 1e3);
    };
    assert!(hidden(change, "drive_displacement_m", "unit").cause.contains("mm"));
}

#[test]
fn a_load_far_from_every_known_factor_is_reported_and_the_outputs_stay_unchecked() {
    let mut log = record(&real(5), 5).unwrap();
    multiply(&mut log, Channel::LoadForce, 137.0);
    multiply(&mut log, Channel::JournalY, 1e3);
    let (_, findings) = found(&log);
    let load: Vec<_> = findings.iter().filter(|f| f.channel == Channel::LoadForce.name()).collect();
    let [finding] = load[..] else { panic!("{findings:#?}") };
    assert_eq!((finding.severity, finding.kind), (Severity::Doubtful, "contradiction"));
    assert!(finding.found.ends_with("the outputs were not checked"), "{}", finding.found);
}

#[test]
fn signs_are_named_and_corrected() {
    for channel in [
        Channel::BearingForceY,
        Channel::BearingForceZ,
        Channel::DriveForce,
        Channel::JournalY,
        Channel::JournalZ,
        Channel::ShaftAngle,
        Channel::ShaftSpeed,
        Channel::FrictionTorque,
        Channel::DriveDisplacement,
        Channel::DriveVelocity,
        Channel::LoadForce,
    ] {
        let finding = hidden(times(channel, -1.0), channel.name(), "sign");
        assert!(finding.applied.is_some() && finding.correction.unwrap().contains("scale = -1.0"));
    }
}

#[test]
fn swapped_axes_are_named_and_exchanged() {
    for (y, z) in [(Channel::JournalY, Channel::JournalZ), (Channel::BearingForceY, Channel::BearingForceZ)] {
        let log = record(&real(6), 6).unwrap();
        let mut swapped = log.clone();
        swapped.channels.insert(y, log.channels[&z].clone());
        swapped.channels.insert(z, log.channels[&y].clone());
        let (corrected, findings) = found(&swapped);
        assert_eq!(
            wrong_findings(&findings),
            [(y.name(), "swapped-axes"), (z.name(), "swapped-axes")],
            "{findings:#?}"
        );
        assert_eq!(corrected, found(&log).0);
        assert!(findings[0].correction.as_deref().unwrap().starts_with(&format!("{z} = {{ from = \"{y}\"")));
        let mut alone = log.clone();
        alone.channels.insert(y, log.channels[&z].clone());
        alone.channels.remove(&z);
        assert_eq!(wrong_findings(&found(&alone).1), [(y.name(), "swapped-axes")]);
    }
}

#[test]
fn factors_of_the_geometry_are_named_and_corrected() {
    for (channel, factor) in [
        (Channel::BearingForceY, 1.2),
        (Channel::DriveForce, 1.0 / 1.2),
        (Channel::JournalY, 2.0),
        (Channel::ShaftAngle, 1.2),
        (Channel::ShaftSpeed, 0.5),
        (Channel::DriveVelocity, 2.0),
        (Channel::LoadForce, 4.0),
        (Channel::LoadForce, 1.2),
        (Channel::FrictionTorque, 2.0),
    ] {
        let finding = hidden(times(channel, factor), channel.name(), "gain");
        assert!((finding.evidence["factor"] / factor - 1.0).abs() < 1e-6, "{finding:?}");
    }
}

#[test]
fn an_input_that_contradicts_another_one_is_left_out() {
    hidden(times(Channel::DriveVelocity, 1.4), "drive_velocity_m_s", "contradiction");
    let late = |log: &mut MeasuredLog| {
        let v = log.channels.get_mut(&Channel::DriveVelocity).unwrap();
        v.rotate_right(10);
        v[..10].fill(0.0);
    };
    let finding = hidden(late, "drive_velocity_m_s", "delay");
    assert!((finding.evidence["ahead_s"] - 0.010).abs() < 1e-3, "{finding:?}");
    let other = |log: &mut MeasuredLog| {
        for (i, v) in log.channels.get_mut(&Channel::DriveVelocity).unwrap().iter_mut().enumerate() {
            *v = (0.05 * i as f64).sin();
        }
    };
    hidden(other, "drive_velocity_m_s", "contradiction");
}

#[test]
fn contradicting_outputs_are_reported() {
    let mut log = record(&real(5), 5).unwrap();
    multiply(&mut log, Channel::ShaftSpeed, 1.4);
    let (_, findings) = found(&log);
    let finding = findings.iter().find(|f| f.kind == "contradiction").unwrap();
    assert_eq!((finding.channel.as_str(), finding.severity), ("shaft_speed_rad_s", Severity::Doubtful));
}

#[test]
fn a_clock_in_other_units_is_named_and_corrected() {
    for factor in [1e3, 1e6] {
        let change = |log: &mut MeasuredLog| log.time_s.iter_mut().for_each(|t| *t *= factor);
        let finding = hidden(change, "t_s", "clock-unit");
        assert!(finding.correction.unwrap().starts_with("t_s = { from = \"t_s\", scale = "));
    }
    // Another sample rate is no wrong clock.
    let mut fast = real(3);
    if let Some(b) = fast.transmission_mut() {
        b.logging.sample_rate_hz = 100.0;
        b.drive.period_s = 3.0;
    }
    assert_eq!(wrong_findings(&found(&record(&fast, 3).unwrap()).1), []);
}

#[test]
fn dead_and_stuck_channels_are_left_out_and_named() {
    let constant = |log: &mut MeasuredLog| log.channels.get_mut(&Channel::JournalY).unwrap().fill(1e-4);
    hidden(constant, "journal_y_m", "constant");
    let stuck = |log: &mut MeasuredLog| {
        let force = log.channels.get_mut(&Channel::BearingForceZ).unwrap();
        let value = force[700];
        force[700..1400].fill(value);
    };
    hidden(stuck, "bearing_force_z_n", "stuck");
    let at_its_largest = |log: &mut MeasuredLog| {
        let force = log.channels.get_mut(&Channel::BearingForceZ).unwrap();
        let largest = force.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        force[700..1400].fill(largest);
    };
    hidden(at_its_largest, "bearing_force_z_n", "stuck");
    let missing = |log: &mut MeasuredLog| {
        log.channels.get_mut(&Channel::DriveForce).unwrap()[..1000].fill(f64::NAN);
    };
    hidden(missing, "drive_force_n", "missing-values");
}

#[test]
fn a_rail_is_reported_and_left_to_the_diagnosis() {
    let mut log = record(&real(4), 4).unwrap();
    let mut sizes: Vec<f64> = log.channels[&Channel::BearingForceY].iter().map(|v| v.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let limit = sizes[sizes.len() * 8 / 10];
    for v in log.channels.get_mut(&Channel::BearingForceY).unwrap() {
        *v = v.clamp(-limit, limit);
    }
    let (after, findings) = found(&log);
    assert!(
        findings.iter().any(|f| f.kind == "saturated" && f.channel == "bearing_force_y_n"),
        "{findings:#?}"
    );
    assert_eq!((wrong_findings(&findings), after), (vec![], log));
}

/// A log of the friction rig with a larger torque than described, so that the simulation never goes
/// beyond a limit; also returns the torque without a limit. A negative sign mirrors it.
fn torque_beyond_the_described(sign: f64) -> (Bench, MeasuredLog, Vec<f64>) {
    let mut bench = Bench::open("friction-rig").unwrap();
    bench.set_cycles(1);
    let mut log = record(&bench, 4).unwrap();
    let swing = |t: &f64| 1e5 * (1.0 + 0.3 * (core::f64::consts::TAU * t / 40.0).sin());
    *log.channels.get_mut(&Channel::LoadForce).unwrap() = log.time_s.iter().map(swing).collect();
    for channel in [Channel::SpindleAngle, Channel::SpindleSpeed] {
        log.channels.get_mut(&channel).into_iter().flatten().for_each(|value| *value *= sign);
    }
    let simulated = respond(&bench, &Inputs::new(&bench, &log).unwrap()).unwrap();
    let more = |t: &f64| t + sign * (60.0 + 3.0 * (0.37 * t).fract());
    let torque = simulated[&Channel::DriveTorque].iter().map(more).collect();
    (bench, log, torque)
}

#[test]
fn clipped_readings_are_saturated_and_readings_constant_while_the_bench_returns_are_stuck() {
    for sign in [1.0, -1.0] {
        let (bench, mut log, torque) = torque_beyond_the_described(sign);
        let limit = torque.iter().map(|t| sign * t).fold(f64::NEG_INFINITY, f64::max) - 55.0;
        let clipped =
            |torque: &[f64]| -> Vec<f64> { torque.iter().map(|t| sign * (sign * t).min(limit)).collect() };
        log.channels.insert(Channel::DriveTorque, clipped(&torque));
        let from = torque.iter().position(|t| sign * t >= limit).unwrap();
        // The same for a log that begins at the limit: nothing before it shows how far the bench is
        // beyond.
        let mut cut = log.clone();
        cut.time_s.drain(..from);
        cut.channels.values_mut().for_each(|values| drop(values.drain(..from)));
        for log in [&log, &cut] {
            let checked = check(&bench, std::slice::from_ref(log), &[]).unwrap();
            let is_own = |f: &&Finding| f.channel == Channel::DriveTorque.name();
            let kinds: Vec<_> = checked.findings.iter().filter(is_own).map(|f| f.kind).collect();
            assert_eq!(kinds, ["saturated"], "{sign}");
        }
        let mut hung = torque;
        hung[from..from + 1100].fill(sign * limit);
        log.channels.insert(Channel::DriveTorque, clipped(&hung));
        // The only simulated output is left out, and the error names this reason and no fault of an
        // input.
        log.channels.insert(Channel::BearingTemperature, vec![20.0; log.time_s.len()]);
        log.time_s.iter_mut().for_each(|t| *t *= 1e3);
        let error = check(&bench, &[log], &[]).map(|_| ()).unwrap_err().to_string();
        assert!(
            error.contains("(drive_torque_nm: 1100 readings") && error.contains("a sensor that hangs"),
            "{error}"
        );
    }
}

#[test]
fn a_limit_that_is_reached_twice_is_saturated_and_not_stuck() {
    // The simulation stays below this end of the range, so it shows neither a rail nor a stuck
    // sensor.
    let mut log = record(&real(4), 4).unwrap();
    let force = log.channels.get_mut(&Channel::BearingForceZ).unwrap();
    let largest = force.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    force[400..700].fill(largest);
    force[1100..1400].fill(largest);
    let (after, findings) = found(&log);
    let is_own = |f: &&Finding| f.channel == Channel::BearingForceZ.name();
    let kinds: Vec<_> = findings.iter().filter(is_own).map(|f| f.kind).collect();
    assert!(kinds.contains(&"saturated") && !kinds.contains(&"stuck"), "{findings:#?}");
    assert!(after.channels.contains_key(&Channel::BearingForceZ));
}

#[test]
fn outliers_are_left_out_with_their_count() {
    let clean = record(&real(7), 7).unwrap();
    let mut log = clean.clone();
    let rows: Vec<usize> = (0..20).map(|i| 150 + 87 * i + i * i % 7).collect();
    for (i, &row) in rows.iter().enumerate() {
        log.channels.get_mut(&Channel::JournalY).unwrap()[row] += if i % 2 == 0 { 5e-5 } else { -2e-4 };
    }
    let (after, findings) = found(&log);
    let finding = findings.iter().find(|f| f.kind == "outliers").unwrap();
    assert_eq!((finding.channel.as_str(), finding.evidence["outliers"]), ("journal_y_m", 20.0));
    let mut keep = vec![true; clean.time_s.len()];
    rows.iter().for_each(|&row| keep[row] = false);
    let mut expected = clean;
    keep_rows(&mut expected, &keep);
    assert_eq!(after, expected);
}

#[test]
fn times_out_of_order_and_missing_rows_are_corrected() {
    let clean = record(&real(8), 8).unwrap();
    let mut log = clean.clone();
    let repeat = |v: &mut Vec<f64>| v.insert(501, v[500]);
    repeat(&mut log.time_s);
    log.channels.values_mut().for_each(repeat);
    log.time_s[900] = log.time_s[800];
    log.channels.get_mut(&Channel::ShaftAngle).unwrap()[1200] = f64::NAN;
    let (after, findings) = found(&log);
    let kinds: Vec<&str> = findings.iter().map(|f| f.kind).collect();
    for kind in ["duplicate-time", "backward-time", "missing-values", "sampling"] {
        assert!(kinds.contains(&kind), "{kinds:?}");
    }
    assert_eq!(after.time_s.len(), clean.time_s.len() - 2);
    assert_eq!(wrong_findings(&findings), []);
    // Repeating every row changes nothing.
    let mut twice = clean.clone();
    let double = |v: &mut Vec<f64>| *v = v.iter().flat_map(|x| [*x, *x]).collect();
    double(&mut twice.time_s);
    twice.channels.values_mut().for_each(double);
    assert_eq!(found(&twice).0, found(&clean).0);
    // A log with three rows for every time is refused.
    let mut coarse = clean;
    coarse.time_s.iter_mut().for_each(|t| *t = (*t * 300.0).floor() / 300.0);
    let error = check(&Bench::open("bench-b").unwrap(), &[coarse], &[]).err().unwrap().to_string();
    assert!(error.contains("times that ascend strictly"), "{error}");
}

#[test]
fn gaps_and_coarse_readings_are_reported() {
    let mut log = record(&real(9), 9).unwrap();
    let mut keep = vec![true; log.time_s.len()];
    keep[600..640].fill(false);
    keep_rows(&mut log, &keep);
    for v in log.channels.get_mut(&Channel::FrictionTorque).unwrap() {
        *v = (*v / 2.5).round() * 2.5;
    }
    let (_, findings) = found(&log);
    let by_kind = |kind: &str| findings.iter().find(|f| f.kind == kind).unwrap();
    assert!((by_kind("gap").evidence["lost_s"] - 0.040).abs() < 1e-6);
    assert!((by_kind("quantised").evidence["step"] - 2.5).abs() < 1e-9);
    assert!((by_kind("sampling").evidence["rate_hz"] - 1000.0).abs() < 1e-3);
    assert_eq!(wrong_findings(&findings), []);
}

#[test]
fn faults_of_a_friction_rig_are_named_too() {
    let bench = Bench::open("friction-rig").unwrap();
    let clean = record(&bench, 2).unwrap();
    for (channel, factor, kind) in [
        (Channel::DriveTorque, -1.0, "sign"),
        (Channel::DriveTorque, 1e-3, "unit"),
        (Channel::SpindleAngle, 57.295_779_5, "unit"),
        (Channel::SpindleSpeed, 57.295_779_5, "unit"),
        (Channel::LoadForce, 1e-3, "unit"),
    ] {
        let mut log = clean.clone();
        multiply(&mut log, channel, factor);
        let findings = check(&bench, &[log], &[]).unwrap().findings;
        assert_eq!(wrong_findings(&findings), [(channel.name(), kind)], "{findings:#?}");
    }
}

#[test]
fn a_correction_keeps_the_described_scale_and_offset() {
    let mut bench = Bench::open("bench-b").unwrap();
    let columns: bench::log::Columns =
        toml::from_str("journal_y_m = { from = \"Y\", scale = 1e-3, offset = 2e-5 }").unwrap();
    if let Some(b) = bench.transmission_mut() {
        b.common.columns = columns;
    }
    let text = column_mapping::scaled(&bench, "journal_y_m", -1.0);
    assert_eq!(text, "journal_y_m = { from = \"Y\", scale = -0.001, offset = -2e-5 }");
    let _: LogFormat = bench.log_format();
}
