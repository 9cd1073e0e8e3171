//! In a log of the independent generator one declared number lies 3.7 declared deviations from its
//! description, all others at most 0.8. The diagnosis names the effect that changes this number, or
//! lists the number if no effect changes it.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bench::{Bench, MeasuredLog};
use diagnosis::{Diagnosis, Options, Verdict, diagnose};
use rayon::prelude::*;
use system_tests::generator::noise::Noise;
use system_tests::generator::plant::Plant;
use system_tests::generator::record::{Point, Record};

/// Deviation of the number, in declared deviations.
const OFF: f64 = 3.7;
/// Largest deviation of all others.
const OTHERS: f64 = 0.8;

/// Length of the logs of an axis, in cycles.
const CYCLES: f64 = 16.0;

/// The diagnosis of a log in which uncertain parameter `number` is `off` declared deviations off.
fn diagnosed(plant: Plant, number: usize, off: f64, seed: u64, cycles: f64) -> Diagnosis {
    let mut noise = Noise::new(seed);
    let mut record = Record::draw(plant, OTHERS, Point::default(), &mut noise);
    record.off[number] = off;
    if !plant.is_transmission() {
        record.cycles = cycles;
    }
    let bench = Bench::parse("bench.toml", plant.description()).unwrap();
    let log = MeasuredLog::parse("a.csv", &record.log(&[], &mut noise), &bench.log_format()).unwrap();
    diagnose(&bench, &[log], &[], &Options::default()).unwrap()
}

/// Seeds and deviations; a log of the transmission bench takes ten seconds.
fn runs(plant: Plant) -> impl Iterator<Item = (u64, f64)> {
    [(1, OFF), (2, -OFF)].into_iter().take(if plant.is_transmission() { 1 } else { 2 })
}

/// Requires the effect with the number's deviation as its size.
fn is_named(plant: Plant, number: usize, effect: &str, unit: f64) {
    for (seed, off) in runs(plant) {
        let d = diagnosed(plant, number, off, seed, CYCLES);
        let answer = format!("{plant:?} {effect} {off}: {:?} {:?} {:?}", d.verdict, d.causes, d.ranking);
        assert!(matches!(d.verdict, Verdict::Named | Verdict::Ambiguous), "{answer}");
        assert_eq!((d.causes.len(), d.causes[0].effect.as_str()), (1, effect), "{answer}");
        let found = &d.causes[0].parameters[0];
        let change = off * plant.deviations()[number] / unit;
        // The width of a 95 % interval is 3.9 standard deviations.
        assert!((found.value - change).abs() < found.ci95[1] - found.ci95[0], "{answer}");
        assert!(d.gain.iter().all(|g| g.extended_rms < 1.5 * g.noise_rms), "{answer}");
    }
}

/// Requires a finding about the number and a verdict that is neither `none` nor a wrong name.
fn is_listed(plant: Plant, number: usize, name: &str) {
    for (seed, off) in runs(plant) {
        let d = diagnosed(plant, number, off, seed, CYCLES);
        let finding = d.checks.iter().find(|f| f.kind == "out-of-tolerance");
        assert_eq!(finding.map(|f| f.channel.as_str()), Some(name), "{:?} {:?}", d.verdict, d.causes);
        assert_eq!(d.verdict, Verdict::Unknown, "{name}: {:?}", d.causes);
    }
}

#[test]
fn a_number_of_a_rotary_axis_is_named() {
    is_named(Plant::Rotary, 0, "inertia-mismatch", 1.0);
    is_named(Plant::Rotary, 1, "coulomb-level", 1.0);
    is_named(Plant::Rotary, 2, "viscous-friction", 1.0);
    is_named(Plant::Rotary, 3, "load-dependent-friction", 1.0);
}

#[test]
fn a_number_of_a_linear_axis_is_named() {
    is_named(Plant::Linear, 0, "inertia-mismatch", 1.0);
    is_named(Plant::Linear, 1, "coulomb-level", 1.0);
    is_named(Plant::Linear, 2, "viscous-friction", 1.0);
    // Number 3, the load coefficient, is found in 17 of 20 records: other friction resembles it.
    is_named(Plant::Linear, 4, "load-gain", 1.0);
}

#[test]
fn a_clearance_a_friction_level_and_a_lever_of_the_transmission_bench_are_found() {
    is_named(Plant::Bench, 4, "clearance-wear", 1.0);
    is_named(Plant::Bench, 6, "coulomb-level", 1.0);
    is_listed(Plant::Bench, 0, "geometry.drive_lever_radius_m");
}

/// Prints how often the effect of each number is the first cause, how often the answer is `none`,
/// and how often another effect is the first cause, over drawn records.
#[test]
#[ignore = "some minutes: cargo test --release -p system-tests --test out_of_tolerance -- --ignored"]
fn rates_over_drawn_records() {
    const EFFECTS: [&str; 4] =
        ["inertia-mismatch", "coulomb-level", "viscous-friction", "load-dependent-friction"];
    const SEEDS: u64 = 20;
    for (cycles, size) in [(4.0, 3.7), (16.0, 3.7), (16.0, 5.0), (16.0, 2.5)] {
        for plant in [Plant::Rotary, Plant::Linear] {
            for (number, effect) in EFFECTS.into_iter().enumerate() {
                let answers: Vec<Option<String>> = (100..100 + SEEDS)
                    .into_par_iter()
                    .map(|seed| {
                        let off = if seed % 2 == 0 { size } else { -size };
                        let d = diagnosed(plant, number, off, seed, cycles);
                        d.causes.first().map(|c| c.effect.clone())
                    })
                    .collect();
                let count = |hit: &dyn Fn(&Option<String>) -> bool| answers.iter().filter(|a| hit(a)).count();
                let named = count(&|a| a.as_deref() == Some(effect));
                let without = count(&|a| a.is_none());
                println!(
                    "{} {cycles} cycles, {size} deviations, {effect}: named {named}, no cause {without}, \
                     another {} of {SEEDS}",
                    plant.name(),
                    answers.len() - named - without
                );
            }
        }
    }
}
