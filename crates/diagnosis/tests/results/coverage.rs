//! Coverage of 95 % intervals for effects with several parameters and coloured noise.
//!
//! A draw is an axis that differs from its description within its uncertainty, an effect of random
//! size and shape, and one or more logs with noise of one colour. A draw whose cause is not named
//! has no interval and does not count.

use super::intervals::{coloured, normal};
use super::{axis, diagnosed, effect, logged, with};
use bench::effects::Effect;
use bench::simulate::record;
use bench::{Bench, MeasuredLog};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use statrs::statistics::Statistics;
use std::collections::BTreeMap;

/// A number that is uniformly distributed in its logarithm.
fn between(rng: &mut ChaCha8Rng, min: f64, max: f64) -> f64 {
    min * (max / min).powf(f64::from(rng.next_u32()) / f64::from(u32::MAX))
}

/// The axis with a period. At slower periods its friction reverses over 6 mm/s, as that of a soft
/// seal does.
fn swinging(period_s: f64) -> Bench {
    let mut bench = axis(4);
    if let (Some(rig), true) = (bench.axis_mut(), period_s > 2.0) {
        (rig.axis.period_s, rig.axis.regularisation_m_s) = (period_s, 6e-3);
    }
    bench
}

/// Logs of one real axis with an effect.
fn logs(bench: &Bench, truth: &Effect, colour: f64, count: usize, rng: &mut ChaCha8Rng) -> Vec<MeasuredLog> {
    let mut real = bench.clone();
    real.effects_mut().push(truth.clone());
    if let Some(rig) = real.axis_mut() {
        rig.axis.inertia += normal(rng);
        rig.axis.viscous_effort += 3.0 * normal(rng);
        rig.common.sensors.clear();
    }
    // Complete logs: friction depends on the time before a log, which no log shows.
    (0..count).map(|_| coloured(record(&real, 1).unwrap(), colour, rng)).collect()
}

type Parameters = Vec<(&'static str, f64)>;

/// Intervals of one parameter: the number that contain the truth, and the positions of the
/// estimates relative to the truth, in half-widths.
#[derive(Default)]
struct Tally {
    containing: usize,
    places: Vec<f64>,
}

impl Tally {
    fn share(&self) -> f64 {
        self.containing as f64 / self.places.len() as f64
    }

    /// Mean and standard deviation of the positions: 0 and 0.51 if the intervals are right.
    fn scatter(&self) -> (f64, f64) {
        (self.places.iter().mean(), self.places.iter().population_std_dev())
    }
}

type Tallies = BTreeMap<String, Tally>;

/// Intervals by parameter; logs without a named cause are counted and printed.
fn coverage(
    (name, period_s, count): (&str, f64, usize),
    colour: f64,
    draws: u64,
    draw: impl Fn(&mut ChaCha8Rng) -> Parameters,
) -> Tallies {
    let bench = swinging(period_s);
    let (mut tallies, mut unnamed) = (Tallies::new(), 0);
    for seed in 0..draws {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let parameters: BTreeMap<String, f64> =
            draw(&mut rng).into_iter().map(|(n, v)| (n.to_owned(), v)).collect();
        let truth = Effect { name: name.into(), channel: None, of: None, parameters };
        let d = diagnosed(&bench, &logs(&bench, &truth, colour, count, &mut rng), &[name]);
        let Some(cause) = d.causes.first() else {
            unnamed += 1;
            continue;
        };
        for p in &cause.parameters {
            let entry = tallies.entry(p.name.clone()).or_default();
            let (value, [low, high]) = (truth.parameters[&p.name], p.ci95);
            entry.containing += usize::from((low..=high).contains(&value));
            entry.places.push((p.value - value) / (0.5 * (high - low)));
        }
    }
    println!("{name}, colour {colour}, {count} logs: {unnamed} of {draws} not named");
    assert!(2 * unnamed < draws, "{name}, colour {colour}: {unnamed} of {draws} not named");
    for (parameter, tally) in &tallies {
        let (mean, scatter) = tally.scatter();
        println!(
            "  {parameter}: {:.3}, estimates {mean:+.2} +- {scatter:.2} of a half interval",
            tally.share()
        );
    }
    tallies
}

fn arms(draws: u64) -> Vec<Tallies> {
    let mut out = Vec::new();
    for colour in [0.0, 0.8] {
        out.push(coverage(("breakaway", 4.0, 1), colour, draws, |rng| {
            vec![
                ("excess_effort", between(rng, 10.0, 25.0)),
                ("rest_time_s", between(rng, 0.1, 0.5)),
                ("distance_m", between(rng, 4e-3, 16e-3)),
            ]
        }));
        out.push(coverage(("presliding-hysteresis", 2.0, 1), colour, draws, |rng| {
            vec![("distance_m", between(rng, 1e-4, 1e-3))]
        }));
        out.push(coverage(("stribeck-friction", 2.0, 1), colour, draws, |rng| {
            vec![("effort_rise", between(rng, 5.0, 15.0)), ("speed_m_s", between(rng, 5e-3, 4e-2))]
        }));
        out.push(coverage(("coulomb-level", 2.0, 3), colour, draws, |rng| {
            vec![("coulomb_effort", between(rng, 4.0, 12.0))]
        }));
    }
    out
}

#[test]
#[ignore = "eight arms of 100 logs, some minutes: cargo test -p diagnosis --test results -- --ignored \
    --nocapture coverage"]
fn intervals_of_shapes_contain_the_truth_in_95_percent() {
    for (parameter, tally) in arms(100).into_iter().flatten() {
        // Of 100 intervals with 95 % coverage, fewer than 88 contain the truth with a probability
        // of 0.4 %.
        assert!(tally.share() >= 0.88, "{parameter}: {}", tally.share());
    }
}

#[test]
fn differences_between_logs_widen_an_interval() {
    let bench = swinging(2.0);
    let half = |levels: &[f64]| {
        let level = |(i, effort): (usize, &f64)| {
            logged(&with(&bench, effect("coulomb-level", None, "coulomb_effort", *effort)), i as u64)
        };
        let logs: Vec<MeasuredLog> = levels.iter().enumerate().map(level).collect();
        let d = diagnosed(&bench, &logs, &["coulomb-level"]);
        let cause = d.causes.first().unwrap_or_else(|| panic!("{:?} {:?}", d.verdict, d.signature));
        let [low, high] = cause.parameters[0].ci95;
        assert!((low..=high).contains(&8.0), "{:?}", cause.parameters);
        0.5 * (high - low)
    };
    let (same, apart) = (half(&[8.0; 5]), half(&[7.2, 7.6, 8.0, 8.4, 8.8]));
    // Student's t with 4 degrees of freedom times the standard error of the mean, 2.78 * 0.63 N /
    // sqrt 5; noise alone gives 0.16 N.
    assert!(same < 0.2 && (0.6..1.0).contains(&apart), "{same} {apart}");
}
