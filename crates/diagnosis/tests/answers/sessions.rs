//! What a session brings along is told from what the bench lacks, where the description declares it.

use super::{axis, diagnosed, effect, logged, with};
use bench::effects::Effect;
use bench::{Bench, MeasuredLog};
use diagnosis::{Diagnosis, Options, Verdict, diagnose};

/// The axis with an offset of 4 N and a delay of 4 ms declared as what a session may have of its own.
fn declaring(cycles: u32) -> Bench {
    let text = axis(cycles).to_toml().unwrap();
    let table = "[nuisances.offset]\ndrive_force_n = 4.0\n[nuisances.delay_s]\ndrive_force_n = 4e-3\n";
    Bench::parse("declaring", &format!("{text}\n{table}")).unwrap()
}

/// A log whose force sensor is off.
fn off(bench: &Bench, offset: f64, delay_s: f64, seed: u64) -> MeasuredLog {
    let mut real = bench.clone();
    *real.parameter_mut("sensors.drive_force_n.offset").unwrap() += offset;
    *real.parameter_mut("sensors.drive_force_n.delay_s").unwrap() += delay_s;
    MeasuredLog { source: format!("session-{seed}.csv"), ..logged(&real, seed) }
}

fn of<'a>(d: &'a Diagnosis, source: &str, name: &str) -> &'a diagnosis::SessionNuisance {
    d.nuisances
        .iter()
        .find(|n| n.source == source && n.name == name)
        .unwrap_or_else(|| panic!("{:?}", d.nuisances))
}

#[test]
fn offsets_and_delays_of_sessions_are_no_effect_where_they_are_declared() {
    let truth = [(5.0, -3e-3), (-3.0, 5e-3)];
    let logs: Vec<MeasuredLog> =
        (1..).zip(truth).map(|(seed, (offset, delay))| off(&axis(4), offset, delay, seed)).collect();
    let d = diagnosed(&declaring(4), &logs, &[]);
    assert_eq!(d.verdict, Verdict::None, "{:?} {:?}", d.causes, d.signature);
    for (seed, (offset, delay)) in (1..).zip(truth) {
        let source = format!("session-{seed}.csv");
        for (name, value) in [("offset", offset), ("delay_s", delay)] {
            let n = of(&d, &source, name);
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
fn the_same_sessions_are_a_finding_where_nothing_is_declared() {
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
fn an_effect_on_top_of_them_keeps_its_name_and_its_parameters() {
    let hidden = effect("coulomb-level", None, "coulomb_effort", 8.0);
    let truth = [(5.0, -3e-3), (-3.0, 5e-3)];
    let real = with(&axis(4), hidden);
    let logs: Vec<MeasuredLog> =
        (1..).zip(truth).map(|(seed, (offset, delay))| off(&real, offset, delay, seed)).collect();
    let straight = [off(&real, 0.0, 0.0, 1), off(&real, 0.0, 0.0, 2)];
    let with_sessions = diagnosed(&declaring(4), &logs, &[]);
    let without = diagnosed(&axis(4), &straight, &[]);
    for d in [&with_sessions, &without] {
        let cause = d.causes.first().unwrap_or_else(|| panic!("{:?} {:?}", d.verdict, d.signature));
        assert_eq!((cause.effect.as_str(), d.causes.len()), ("coulomb-level", 1), "{:?}", d.causes);
        let [low, high] = cause.parameters[0].ci95;
        assert!((low..=high).contains(&8.0), "{:?}", cause.parameters);
    }
    let width = |d: &Diagnosis| d.causes[0].parameters[0].ci95[1] - d.causes[0].parameters[0].ci95[0];
    assert!(width(&with_sessions) < 2.0 * width(&without));
}

#[test]
fn a_session_beyond_its_declaration_says_nothing_of_a_cause_in_all_of_them() {
    let real = with(&axis(4), effect("coulomb-level", None, "coulomb_effort", 8.0));
    let logs = [off(&real, 16.3, 0.0, 1), off(&real, 1.0, 0.0, 2), off(&real, -2.0, 0.0, 3)];
    let d = diagnosed(&declaring(4), &logs, &["coulomb-level"]);
    assert!(d.verdict == Verdict::Named && d.refused.is_none(), "{:?}", d.refused);
    assert_eq!(d.checks.iter().filter(|f| f.kind == "nuisance-at-bound").count(), 1, "{:?}", d.checks);
}

#[test]
fn the_order_of_sessions_changes_nothing() {
    let real = with(&axis(4), effect("coulomb-level", None, "coulomb_effort", 8.0));
    let mut logs: Vec<MeasuredLog> =
        [(1, 5.0), (2, -3.0), (3, 1.0)].map(|(seed, offset)| off(&real, offset, 1e-3, seed)).into();
    let there = diagnosed(&declaring(4), &logs, &["coulomb-level", "viscous-friction", "sensor-offset"]);
    logs.rotate_left(1);
    let again = diagnosed(&declaring(4), &logs, &["coulomb-level", "viscous-friction", "sensor-offset"]);
    assert_eq!(there.verdict, again.verdict);
    let close = |a: f64, b: f64, size: f64| assert!((a - b).abs() < 0.02 * size, "{a} {b} of {size}");
    let (a, b) = (&there.causes[0].parameters[0], &again.causes[0].parameters[0]);
    close(a.value, b.value, a.ci95[1] - a.ci95[0]);
    close(a.ci95[1] - a.ci95[0], b.ci95[1] - b.ci95[0], a.ci95[1] - a.ci95[0]);
    assert_eq!(there.nuisances.len(), 6);
    for n in &there.nuisances {
        let m = of(&again, &n.source, n.name);
        close(n.value, m.value, n.deviation);
        close(n.deviation, m.deviation, n.deviation);
    }
}

#[test]
fn a_held_out_session_tells_its_own_offset_and_loses_no_gain_by_it() {
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
    let n = of(&d, "session-2.csv", "offset");
    assert!(n.held_out && (n.value + 6.0).abs() < 3.0 * n.deviation, "{n:?}");
    // The error after is the noise: of the cycles that tell no offset there is none left.
    assert!((d.gain[0].extended_rms - 1.0).abs() < 0.1 && d.explained_share.unwrap() > 0.9, "{:?}", d.gain);
    let held: usize = d
        .series
        .iter()
        .filter(|s| s.source == "session-2.csv")
        .map(|s| s.held_out.iter().filter(|h| **h).count())
        .sum();
    assert!((1150..1250).contains(&held), "three of four cycles of 400 samples are compared: {held}");
    assert!(!d.checks.iter().any(|f| f.kind == "nuisance-at-bound"), "{:?}", d.checks);
    // Farther off than declared it is held back and told.
    let far = diagnosed(&declaring(4), off(&real, -40.0, 0.0, 2));
    let finding = far.checks.iter().find(|f| f.kind == "nuisance-at-bound").unwrap();
    assert_eq!(finding.log, "session-2.csv");
    assert!(far.gain[0].extended_rms > 20.0, "{:?}", far.gain);
    // Where it is not declared, the same offset is an error that stays.
    let d = diagnosed(&axis(4), off(&real, -6.0, 0.0, 2));
    assert!(d.gain[0].extended_rms > 5.0, "{:?}", d.gain);
}

#[test]
fn a_session_that_is_farther_off_than_declared_is_a_finding() {
    let logs = [off(&axis(4), 40.0, 0.0, 1), off(&axis(4), 0.0, 0.0, 2)];
    let d = diagnosed(&declaring(4), &logs, &["coulomb-level", "sensor-gain"]);
    assert_ne!(d.verdict, Verdict::None);
    let finding = d.checks.iter().find(|f| f.kind == "nuisance-at-bound");
    let finding = finding.unwrap_or_else(|| panic!("{:?} {:?} {:?}", d.causes, d.nuisances, d.noise));
    assert_eq!((finding.log.as_str(), finding.channel.as_str()), ("session-1.csv", "drive_force_n"));
    assert!(finding.found.starts_with("offset ends at 16.00 N, 4 of its declared"), "{}", finding.found);
}

/// Friction that loses 2 % a kelvin and settles at some 8 K within 15 s.
fn warming() -> Effect {
    let parameters = [("level_per_k", -0.02), ("resistance_k_w", 2.0), ("time_constant_s", 5.0)];
    Effect {
        name: "thermal-friction-drift".into(),
        channel: None,
        parameters: parameters.map(|(name, value)| (name.to_owned(), value)).into(),
    }
}

#[test]
fn sessions_that_start_warm_and_cold_tell_their_temperature_where_friction_follows_it() {
    let text = axis(8).to_toml().unwrap();
    let cold = Bench::parse("warm", &format!("{text}\n[nuisances]\ntemperature_start_k = 10.0\n")).unwrap();
    // Nothing follows temperature: dead, said once, and no finding.
    let plain = diagnosed(&cold, &[logged(&axis(8), 1), logged(&axis(8), 2)], &["coulomb-level"]);
    assert_eq!(plain.verdict, Verdict::None);
    let dead: Vec<_> = plain.identifiability.iter().filter(|i| i.kind == "dead").collect();
    assert!(dead.len() == 1 && dead[0].parameters.len() == 2, "{:?}", plain.identifiability);
    // The description knows the drift: what differs is where each session starts.
    let known = with(&cold, warming());
    let started = |rise_k: f64, seed: u64| {
        let mut real = with(&axis(8), warming());
        real.set_temperature_start_k(rise_k);
        MeasuredLog { source: format!("session-{seed}.csv"), ..logged(&real, seed) }
    };
    let d = diagnosed(&known, &[started(0.0, 1), started(12.0, 2)], &["coulomb-level", "friction-step"]);
    assert_eq!(d.verdict, Verdict::None, "{:?} {:?}", d.causes, d.signature);
    for (seed, rise_k) in [(1, 0.0), (2, 12.0)] {
        let n = of(&d, &format!("session-{seed}.csv"), "temperature_start_k");
        assert!((n.value - rise_k).abs() < 3.0 * n.deviation + 0.1 && n.deviation < 2.0, "{n:?}");
    }
    // Undeclared, the warm session is not explained.
    let d = diagnosed(&with(&axis(8), warming()), &[started(0.0, 1), started(12.0, 2)], &["coulomb-level"]);
    assert_ne!(d.verdict, Verdict::None);
}

#[test]
fn a_log_given_twice_is_named_and_counts_once() {
    let log = logged(&with(&axis(4), effect("viscous-friction", None, "viscous_effort", 60.0)), 3);
    let copy = || {
        let time_s = log.time_s.iter().map(|t| t + 100.0).collect();
        MeasuredLog { source: "copy.csv".into(), time_s, ..log.clone() }
    };
    let once = diagnosed(&axis(4), std::slice::from_ref(&log), &[]);
    let twice = diagnosed(&axis(4), &[log.clone(), copy()], &[]);
    let held = diagnose(&axis(4), std::slice::from_ref(&log), &[copy()], &Options::default()).unwrap();
    assert_eq!(once.causes[0].effect, "viscous-friction");
    for other in [&twice, &held] {
        let found: Vec<_> = other.checks.iter().filter(|f| f.kind == "copy").collect();
        assert!(matches!(found[..], [f] if f.log == "copy.csv" && f.done.is_some()), "{:?}", other.checks);
        assert_eq!(format!("{:?}", other.causes), format!("{:?}", once.causes));
        assert_eq!(other.series.len(), once.series.len());
    }
    assert!(once.checks.iter().all(|f| f.kind != "copy"));
}

#[test]
fn a_held_out_log_beyond_what_is_declared_is_not_called_sound() {
    // Four declared deviations are 16 N; what is left of it beyond them drowns in the noise.
    let fitted = off(&axis(4), 0.0, 0.0, 1);
    for (offset, is_sound) in [(8.0, true), (16.1, false)] {
        let held = [off(&axis(4), offset, 0.0, 2)];
        let d = diagnose(&declaring(4), std::slice::from_ref(&fitted), &held, &Options::default()).unwrap();
        let at_bound = d.checks.iter().any(|finding| finding.kind == "nuisance-at-bound");
        assert_eq!(
            (d.verdict == Verdict::None, at_bound),
            (is_sound, !is_sound),
            "{offset} N: {:?}",
            d.nuisances
        );
    }
}
