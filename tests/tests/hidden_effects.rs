//! A log of an independent generator hides an effect, and the diagnosis must name it; in a clean
//! log it must name none.
//!
//! Each effect exceeds the declared uncertainty of the bench. The real bench differs from its
//! description in every uncertain parameter. Therefore a parameter that adds to an uncertain one
//! (clearance, friction level) cannot be determined more exactly.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use bench::{Bench, MeasuredLog};
use diagnosis::{Diagnosis, Options, Verdict, diagnose};
use system_tests::generator::noise::Noise;
use system_tests::generator::{Hidden, RealBench};

/// Maximum deviation of the real bench from its description beside a hidden effect, in declared
/// standard deviations.
const DEVIATIONS: f64 = 0.8;

fn diagnosed(hidden: &Hidden, deviations: f64, seed: u64, change: impl Fn(&mut RealBench)) -> Diagnosis {
    let mut noise = Noise::new(seed);
    let mut real = RealBench::near_description(&mut noise, deviations);
    change(&mut real);
    let text = real.log(hidden, &mut noise);
    let bench = Bench::open("bench-b").unwrap();
    let log = MeasuredLog::parse("a.csv", &text, &bench.log_format()).unwrap();
    diagnose(&bench, &[log], &[], &Options::default()).unwrap()
}

/// Requires the name, the channel, the value within 15 %, and a gain on held-out samples.
fn found(hidden: &Hidden, seed: u64, effect: &str, channel: Option<&str>, size: f64) {
    let d = diagnosed(hidden, DEVIATIONS, seed, |_| {});
    let summary =
        format!("seed {seed}: {:?} {:?} left {:?} ranking {:?}", d.verdict, d.causes, d.signature, d.ranking);
    assert_eq!(d.verdict, Verdict::Named, "{summary}");
    assert_eq!(d.causes.len(), 1, "{summary}");
    let cause = &d.causes[0];
    assert_eq!((cause.effect.as_str(), cause.channel.map(|c| c.name())), (effect, channel), "{summary}");
    let value = cause.parameters[0].value;
    eprintln!(
        "{effect} seed {seed}: {value:.4e} for {size:.4e}, {:.1} %, interval {:?}",
        100.0 * (value / size - 1.0),
        cause.parameters[0].ci95
    );
    assert!((value / size - 1.0).abs() < 0.15, "{value} for {size}; {summary}");
    assert!(d.explained_share.is_some_and(|s| s > 0.9), "{:?}", d.explained_share);
    assert!(d.gain.iter().any(|g| g.held_out && g.extended_rms < 0.8 * g.baseline_rms), "{:?}", d.gain);
}

/// Seeds of a test: one, and with the variable `PINTLE_LONG` (`cargo xtask test --long`) two.
fn seeds(first: u64) -> std::ops::RangeInclusive<u64> {
    let is_long = std::env::var_os("PINTLE_LONG").is_some();
    first..=first + u64::from(is_long)
}

#[test]
fn clearance_wear_is_named() {
    for seed in seeds(11) {
        found(&Hidden { clearance_m: 1e-4, ..Hidden::default() }, seed, "clearance-wear", None, 1e-4);
    }
}

#[test]
fn coulomb_level_is_named() {
    for seed in seeds(21) {
        found(&Hidden { friction: 0.35, ..Hidden::default() }, seed, "coulomb-level", None, 0.35);
    }
}

#[test]
fn viscous_friction_is_named() {
    for seed in seeds(31) {
        found(&Hidden { viscous_n_s_m: 300.0, ..Hidden::default() }, seed, "viscous-friction", None, 300.0);
    }
}

#[test]
fn hydraulic_compliance_is_named() {
    for seed in seeds(41) {
        found(
            &Hidden { compliance_m_n: 2e-8, ..Hidden::default() },
            seed,
            "hydraulic-compliance",
            None,
            2e-8,
        );
    }
}

#[test]
fn sensor_delay_is_named() {
    for seed in seeds(51) {
        let hidden = Hidden { journal_y_delay_s: 4e-4, ..Hidden::default() };
        found(&hidden, seed, "sensor-delay", Some("journal_y_m"), 4e-4);
    }
}

#[test]
fn sensor_offset_is_named() {
    for seed in seeds(61) {
        let hidden = Hidden { force_y_offset_n: 25.0, ..Hidden::default() };
        found(&hidden, seed, "sensor-offset", Some("bearing_force_y_n"), 25.0);
    }
}

#[test]
fn clean_logs_give_none() {
    for seed in 1..=6 {
        // Other loads and lengths than described; every uncertain parameter off by up to two
        // deviations.
        let d = diagnosed(&Hidden::default(), 2.0, seed, |real| {
            real.load_n = [10e3, 6e3, 3e3][seed as usize % 3];
            real.cycles = 2 + seed as usize % 2;
        });
        assert_eq!(d.verdict, Verdict::None, "seed {seed}: {:?} {:?} {:?}", d.causes, d.signature, d.ranking);
    }
}

#[test]
fn an_effect_outside_the_catalogue_gets_no_wrong_name() {
    let hidden = Hidden { third_harmonic_n: 150.0, ..Hidden::default() };
    let d = diagnosed(&hidden, DEVIATIONS, 71, |_| {});
    assert_eq!(d.verdict, Verdict::Unknown, "{:?}", d.causes);
    let left = d.signature.unwrap();
    assert!(left.rms_over_noise > 0.2 && !left.place.is_empty());
}

#[test]
fn two_effects_are_both_named() {
    let hidden = Hidden { viscous_n_s_m: 300.0, force_y_offset_n: 25.0, ..Hidden::default() };
    let d = diagnosed(&hidden, DEVIATIONS, 81, |_| {});
    let mut names: Vec<&str> = d.causes.iter().map(|c| c.effect.as_str()).collect();
    names.sort_unstable();
    assert_eq!((d.verdict, names), (Verdict::Named, vec!["sensor-offset", "viscous-friction"]));
}

#[test]
fn an_effect_deleted_from_the_library_is_unknown() {
    let hidden = Hidden { journal_y_delay_s: 4e-4, ..Hidden::default() };
    let mut noise = Noise::new(91);
    let text = RealBench::near_description(&mut noise, DEVIATIONS).log(&hidden, &mut noise);
    let bench = Bench::open("bench-b").unwrap();
    let log = MeasuredLog::parse("a.csv", &text, &bench.log_format()).unwrap();
    let exclude = ["sensor-delay".to_owned()];
    let d = diagnose(&bench, &[log], &[], &Options { exclude: &exclude, ..Options::default() }).unwrap();
    assert_eq!(d.verdict, Verdict::Unknown, "{:?}", d.causes);
    assert_eq!(d.signature.unwrap().channel.name(), "journal_y_m");
}
