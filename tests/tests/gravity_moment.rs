//! A log of the independent generator hides a moment of gravity. In a wide swing the diagnosis
//! names it with its size; in a narrow one, where an offset and a spring have the same course, it
//! names none but these.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bench::{Bench, MeasuredLog};
use diagnosis::{Diagnosis, Options, Verdict, diagnose};
use std::f64::consts::TAU;
use system_tests::generator::hidden::HiddenEffect;
use system_tests::generator::noise::Noise;
use system_tests::generator::plant::Plant;
use system_tests::generator::record::{Point, Record};

/// Rms moment of the swings, about the dry friction of the axis, N m.
const MOMENT_NM: f64 = 40.0;
/// Largest deviation of the axis' parameters, in declared deviations.
const OTHERS: f64 = 0.8;

/// Hidden moments at the angles 0 and a quarter of a turn, and the diagnosis of a log with
/// `stroke` times the described stroke.
fn diagnosed(seed: u64, stroke: f64) -> ([f64; 2], Diagnosis) {
    let mut noise = Noise::new(seed);
    let point = Point { stroke, ..Point::default() };
    let record = Record::draw(Plant::Rotary, OTHERS, point, &mut noise);
    let phase = TAU * noise.uniform();
    let moments = [MOMENT_NM * phase.cos(), MOMENT_NM * phase.sin()];
    let hidden =
        HiddenEffect::new("gravity-moment", &[("cos_effort", moments[0]), ("sin_effort", moments[1])]);
    let text = record.log(&[hidden], &mut noise);
    let bench = Bench::parse("bench.toml", Plant::Rotary.description()).unwrap();
    let log = MeasuredLog::parse("a.csv", &text, &bench.log_format()).unwrap();
    (moments, diagnose(&bench, &[log], &[], &Options::default()).unwrap())
}

#[test]
fn a_moment_of_gravity_is_named_with_its_size_in_a_wide_swing() {
    for seed in 1..=6 {
        let (moments, d) = diagnosed(seed, 4.0);
        let answer = format!("{seed}: {moments:?} {:?} {:?} {:?}", d.verdict, d.causes, d.ambiguous_with);
        assert_eq!(d.verdict, Verdict::Named, "{answer}");
        assert_eq!((d.causes.len(), d.causes[0].effect.as_str()), (1, "gravity-moment"), "{answer}");
        for (found, moment) in d.causes[0].parameters.iter().zip(moments) {
            assert!((found.value - moment).abs() < 0.05 * MOMENT_NM, "{answer}");
        }
        assert!(d.gain.iter().all(|g| g.extended_rms < 1.2 * g.noise_rms), "{answer}");
    }
}

#[test]
fn a_narrow_swing_names_only_what_looks_like_gravity() {
    let alike = ["gravity-moment", "sensor-offset", "spring-effort", "inertia-mismatch", "position-ripple"];
    for seed in 11..=14 {
        let (moments, d) = diagnosed(seed, 1.0);
        let answer = format!("{seed}: {moments:?} {:?} {:?}", d.verdict, d.causes);
        assert!(!d.causes.is_empty(), "{answer}");
        assert!(d.causes.iter().all(|c| alike.contains(&c.effect.as_str())), "{answer}");
    }
}
