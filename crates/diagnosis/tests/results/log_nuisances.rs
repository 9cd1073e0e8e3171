//! Declared nuisance parameters of each log are separated from errors of the bench.

use super::{axis, diagnosed, effect, logged, with};
use bench::effects::Effect;
use bench::{Bench, MeasuredLog};
use diagnosis::{Diagnosis, Options, Verdict, diagnose};

/// The axis with an offset of 4 N and a delay of 4 ms declared as nuisance parameters of each log.
fn declaring(cycles: u32) -> Bench {
    let text = axis(cycles).to_toml().unwrap();
    let table = "[nuisances.offset]\ndrive_force_n = 4.0\n[nuisances.delay_s]\ndrive_force_n = 4e-3\n";
    Bench::parse("declaring", &format!("{text}\n{table}")).unwrap()
}

/// A log whose force sensor has an offset and a delay.
fn off(bench: &Bench, offset: f64, delay_s: f64, seed: u64) -> MeasuredLog {
    let mut real = bench.clone();
    *real.parameter_mut("sensors.drive_force_n.offset").unwrap() += offset;
    *real.parameter_mut("sensors.drive_force_n.delay_s").unwrap() += delay_s;
    MeasuredLog { source: format!("log-{seed}.csv"), ..logged(&real, seed) }
}

fn nuisance<'a>(d: &'a Diagnosis, source: &str, name: &str) -> &'a diagnosis::LogNuisance {
    d.nuisances
        .iter()
        .find(|n| n.source == source && n.name == name)
        .unwrap_or_else(|| panic!("{:?}", d.nuisances))
}

#[test]
fn declared_offsets_and_delays_of_logs_are_not_named_as_effects() {
    let truth = [(5.0, -3e-3), (-3.0, 5e-3)];
    let logs: Vec<MeasuredLog> =
        (1..).zip(truth).map(|(seed, (offset, delay))| off(&axis(4), offset, delay, seed)).collect();
    let d = diagnosed(&declaring(4), &logs, &[]);
    assert_eq!(d.verdict, Verdict::None, "{:?} {:?}", d.causes, d.signature);
    for (seed, (offset, delay)) in (1..).zip(truth) {
        let source = format!("log-{seed}.csv");
        for (name, value) in [("offset", offset), ("delay_s", delay)] {
            let n = nuisance(&d, &source, name);
            assert!(
                (n.value - value).abs() < 3.0 * n.deviation && n.deviation < 0.2 * n.declared_deviation,
                "{n:?}"
            );
            assert!((n.deviations_off - n.value / n.declared_deviation).abs() < 1e-9 && !n.held_out, "{n:?}");
        }
    }
    assert!(!d.identifiability.iter().any(|i| i.kind == "dead"), "{:?}", d.identifiability);
}

#[test]
fn undeclared_offsets_of_logs_are_not_explained_away() {
    let logs = [off(&axis(4), 5.0, 0.0, 1), off(&axis(4), -3.0, 0.0, 2)];
    let d = diagnosed(&axis(4), &logs, &[]);
    assert_ne!(d.verdict, Verdict::None);
    assert!(d.nuisances.is_empty());
    let same = [off(&axis(4), 5.0, 0.0, 1), off(&axis(4), 5.0, 0.0, 2)];
    let d = diagnosed(&axis(4), &same, &[]);
    let group = d.causes.iter().map(|c| &c.effect).chain(d.ambiguous_with.iter().map(|a| &a.effect));
    assert!(group.into_iter().any(|e| e == "sensor-offset"), "{:?} {:?}", d.verdict, d.causes);
}

#[test]
fn an_effect_beside_declared_offsets_keeps_its_name_and_parameters() {
    let hidden = effect("coulomb-level", None, "coulomb_effort", 8.0);
    let truth = [(5.0, -3e-3), (-3.0, 5e-3)];
    let real = with(&axis(4), hidden);
    let logs: Vec<MeasuredLog> =
        (1..).zip(truth).map(|(seed, (offset, delay))| off(&real, offset, delay, seed)).collect();
    let straight = [off(&real, 0.0, 0.0, 1), off(&real, 0.0, 0.0, 2)];
    let with_nuisances = diagnosed(&declaring(4), &logs, &[]);
    let without = diagnosed(&axis(4), &straight, &[]);
    for d in [&with_nuisances, &without] {
        let cause = d.causes.first().unwrap_or_else(|| panic!("{:?} {:?}", d.verdict, d.signature));
        assert_eq!((cause.effect.as_str(), d.causes.len()), ("coulomb-level", 1), "{:?}", d.causes);
        let [low, high] = cause.parameters[0].ci95;
        assert!((low..=high).contains(&8.0), "{:?}", cause.parameters);
    }
    let width = |d: &Diagnosis| d.causes[0].parameters[0].ci95[1] - d.causes[0].parameters[0].ci95[0];
    assert!(width(&with_nuisances) < 2.0 * width(&without));
}

#[test]
fn a_log_beyond_its_declaration_does_not_reject_a_cause_in_all_logs() {
    let real = with(&axis(4), effect("coulomb-level", None, "coulomb_effort", 8.0));
    let logs = [off(&real, 16.3, 0.0, 1), off(&real, 1.0, 0.0, 2), off(&real, -2.0, 0.0, 3)];
    let d = diagnosed(&declaring(4), &logs, &["coulomb-level"]);
    assert!(d.verdict == Verdict::Named && d.rejection.is_none(), "{:?}", d.rejection);
    assert_eq!(d.checks.iter().filter(|f| f.kind == "nuisance-at-bound").count(), 1, "{:?}", d.checks);
}

#[test]
fn the_order_of_logs_changes_nothing() {
    let real = with(&axis(4), effect("coulomb-level", None, "coulomb_effort", 8.0));
    let mut logs: Vec<MeasuredLog> =
        [(1, 5.0), (2, -3.0), (3, 1.0)].map(|(seed, offset)| off(&real, offset, 1e-3, seed)).into();
    let there = diagnosed(&declaring(4), &logs, &["coulomb-level", "viscous-friction", "sensor-offset"]);
    logs.rotate_left(1);
    let rotated = diagnosed(&declaring(4), &logs, &["coulomb-level", "viscous-friction", "sensor-offset"]);
    assert_eq!(there.verdict, rotated.verdict);
    let close = |a: f64, b: f64, size: f64| assert!((a - b).abs() < 0.02 * size, "{a} {b} of {size}");
    let (a, b) = (&there.causes[0].parameters[0], &rotated.causes[0].parameters[0]);
    close(a.value, b.value, a.ci95[1] - a.ci95[0]);
    close(a.ci95[1] - a.ci95[0], b.ci95[1] - b.ci95[0], a.ci95[1] - a.ci95[0]);
    assert_eq!(there.nuisances.len(), 6);
    for n in &there.nuisances {
        let m = nuisance(&rotated, &n.source, n.name);
        close(n.value, m.value, n.deviation);
        close(n.deviation, m.deviation, n.deviation);
    }
}

#[test]
fn the_offset_of_a_held_out_log_is_calibrated_and_does_not_lower_the_gain() {
    let real = with(&axis(4), effect("coulomb-level", None, "coulomb_effort", 8.0));
    let diagnosed = |bench: &Bench, held_out: MeasuredLog| {
        let exclude: Vec<String> = bench::effects::CATALOGUE
            .iter()
            .map(|k| k.name.to_owned())
            .filter(|name| !["coulomb-level", "sensor-offset"].contains(&name.as_str()))
            .collect();
        let options = Options { exclude: &exclude, ..Options::default() };
        diagnose(bench, &[off(&real, 2.0, 0.0, 1)], &[held_out], &options).unwrap()
    };
    let d = diagnosed(&declaring(4), off(&real, -6.0, 0.0, 2));
    assert_eq!(d.verdict, Verdict::Named, "{:?}", d.signature);
    let n = nuisance(&d, "log-2.csv", "offset");
    assert!(n.held_out && (n.value + 6.0).abs() < 3.0 * n.deviation, "{n:?}");
    // The error after the extension is the noise: cycles that do not calibrate the offset have none
    // left.
    assert!((d.gain[0].extended_rms - 1.0).abs() < 0.1 && d.explained_share.unwrap() > 0.9, "{:?}", d.gain);
    let held_out: usize = d
        .series
        .iter()
        .filter(|s| s.source == "log-2.csv")
        .map(|s| s.held_out.iter().filter(|h| **h).count())
        .sum();
    assert!((1150..1250).contains(&held_out), "three of four cycles of 400 samples are compared: {held_out}");
    assert!(!d.checks.iter().any(|f| f.kind == "nuisance-at-bound"), "{:?}", d.checks);
    // Beyond its declaration an offset is limited and reported.
    let far = diagnosed(&declaring(4), off(&real, -40.0, 0.0, 2));
    let finding = far.checks.iter().find(|f| f.kind == "nuisance-at-bound").unwrap();
    assert_eq!(finding.log, "log-2.csv");
    assert!(far.gain[0].extended_rms > 20.0, "{:?}", far.gain);
    // Without a declaration, the same offset remains as an error.
    let d = diagnosed(&axis(4), off(&real, -6.0, 0.0, 2));
    assert!(d.gain[0].extended_rms > 5.0, "{:?}", d.gain);
}

#[test]
fn a_log_beyond_its_declaration_is_a_finding() {
    let logs = [off(&axis(4), 40.0, 0.0, 1), off(&axis(4), 0.0, 0.0, 2)];
    let d = diagnosed(&declaring(4), &logs, &["coulomb-level", "sensor-gain"]);
    assert_ne!(d.verdict, Verdict::None);
    let finding = d.checks.iter().find(|f| f.kind == "nuisance-at-bound");
    let finding = finding.unwrap_or_else(|| panic!("{:?} {:?} {:?}", d.causes, d.nuisances, d.noise));
    assert_eq!((finding.log.as_str(), finding.channel.as_str()), ("log-1.csv", "drive_force_n"));
    assert!(finding.found.starts_with("offset ends at 16.00 N, 4 of its declared"), "{}", finding.found);
}

/// Friction that falls by 2 % per kelvin; the bearing warms by some 8 K within 15 s.
fn warming() -> Effect {
    let parameters = [("level_per_k", -0.02), ("resistance_k_w", 2.0), ("time_constant_s", 5.0)];
    Effect {
        name: "thermal-friction-drift".into(),
        channel: None,
        of: None,
        parameters: parameters.map(|(name, value)| (name.to_owned(), value)).into(),
    }
}

#[test]
fn start_temperatures_are_estimated_if_friction_depends_on_temperature() {
    let text = axis(8).to_toml().unwrap();
    let cold = Bench::parse("warm", &format!("{text}\n[nuisances]\ntemperature_start_k = 10.0\n")).unwrap();
    // No friction depends on temperature: dead, listed once, and no finding.
    let plain = diagnosed(&cold, &[logged(&axis(8), 1), logged(&axis(8), 2)], &["coulomb-level"]);
    assert_eq!(plain.verdict, Verdict::None);
    let dead: Vec<_> = plain.identifiability.iter().filter(|i| i.kind == "dead").collect();
    assert!(dead.len() == 1 && dead[0].parameters.len() == 2, "{:?}", plain.identifiability);
    // The description contains the drift, and the logs differ in their start temperature.
    let known = with(&cold, warming());
    let started = |rise_k: f64, seed: u64| {
        let mut real = with(&axis(8), warming());
        real.set_temperature_start_k(rise_k);
        MeasuredLog { source: format!("log-{seed}.csv"), ..logged(&real, seed) }
    };
    let d = diagnosed(&known, &[started(0.0, 1), started(12.0, 2)], &["coulomb-level", "friction-step"]);
    assert_eq!(d.verdict, Verdict::None, "{:?} {:?}", d.causes, d.signature);
    for (seed, rise_k) in [(1, 0.0), (2, 12.0)] {
        let n = nuisance(&d, &format!("log-{seed}.csv"), "temperature_start_k");
        assert!((n.value - rise_k).abs() < 3.0 * n.deviation + 0.1 && n.deviation < 2.0, "{n:?}");
    }
    // Without a declaration, the warm log is not explained.
    let d = diagnosed(&with(&axis(8), warming()), &[started(0.0, 1), started(12.0, 2)], &["coulomb-level"]);
    assert_ne!(d.verdict, Verdict::None);
}

#[test]
fn a_log_given_twice_is_reported_and_counts_once() {
    let log = logged(&with(&axis(4), effect("viscous-friction", None, "viscous_effort", 60.0)), 3);
    let copy = || {
        let time_s = log.time_s.iter().map(|t| t + 100.0).collect();
        MeasuredLog { source: "copy.csv".into(), time_s, ..log.clone() }
    };
    let once = diagnosed(&axis(4), std::slice::from_ref(&log), &[]);
    let twice = diagnosed(&axis(4), &[log.clone(), copy()], &[]);
    let held_out = diagnose(&axis(4), std::slice::from_ref(&log), &[copy()], &Options::default()).unwrap();
    assert_eq!(once.causes[0].effect, "viscous-friction");
    for other in [&twice, &held_out] {
        let found: Vec<_> = other.checks.iter().filter(|f| f.kind == "copy").collect();
        assert!(matches!(found[..], [f] if f.log == "copy.csv" && f.applied.is_some()), "{:?}", other.checks);
        assert_eq!(format!("{:?}", other.causes), format!("{:?}", once.causes));
        assert_eq!(other.series.len(), once.series.len());
    }
    assert!(once.checks.iter().all(|f| f.kind != "copy"));
}

#[test]
fn a_held_out_log_beyond_its_declaration_is_not_called_clean() {
    // Four declared deviations are 16 N; the excess is within the noise.
    let fitted = off(&axis(4), 0.0, 0.0, 1);
    for (offset, is_clean) in [(8.0, true), (16.1, false)] {
        let held_out = [off(&axis(4), offset, 0.0, 2)];
        let d =
            diagnose(&declaring(4), std::slice::from_ref(&fitted), &held_out, &Options::default()).unwrap();
        let at_bound = d.checks.iter().any(|finding| finding.kind == "nuisance-at-bound");
        assert_eq!(
            (d.verdict == Verdict::None, at_bound),
            (is_clean, !is_clean),
            "{offset} N: {:?}",
            d.nuisances
        );
    }
}
