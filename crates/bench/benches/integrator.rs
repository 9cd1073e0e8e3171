//! Wall time of the integrator: `cargo bench -p bench`.
//!
//! The slider-crank with a clearance joint is solved twice in the same run: by the integrator with
//! located events, and by fixed-step RK4 with a step small enough for the same error of the
//! slider's position after 0.6 revolutions. The ratio of the times is printed. Bench B is one cycle
//! with its analytic law.

use bench::BearingMaterial;
use bench::description::TwoPlaneSection;
use bench::description::{SliderCrankBench, TransmissionBench};
use bench::integrate::{ContactPlant, Touch, integrate};
use bench::plants::slider_crank::{self, SliderCrank};
use bench::plants::transmission::Transmission;
use bench::plants::two_plane::{TwoPlane, run_two_plane};
use bench::simulate::{DEFAULT_TOLERANCE, run_with_law};
use std::hint::black_box;
use std::time::Instant;

/// Slider position after 0.6 revolutions, confirmed by three independent codes.
const REFERENCE_M: f64 = 0.0754435223;
/// Maximum error of the integrator.
const BOUND_M: f64 = 2e-7;

fn problem() -> (SliderCrank, f64) {
    let bench =
        SliderCrankBench::open("slider-crank").unwrap_or_else(|e| unreachable!("the preset is valid: {e}"));
    (bench.plant(), bench.duration_s())
}

fn located(plant: &SliderCrank, end_s: f64) -> f64 {
    let tolerances = plant.tolerances(slider_crank::DEFAULT_TOLERANCE);
    integrate(plant, (0.0, end_s), plant.initial_state(), false, &[], &tolerances, |_, _, _| {})
        .map_or(f64::NAN, |run| run.state[1])
}

/// Classical RK4 that detects a contact at the end of the step in which it begins.
fn fixed_step(plant: &SliderCrank, end_s: f64, step_s: f64) -> f64 {
    let count = (end_s / step_s).round() as usize;
    let h = end_s / count as f64;
    let mut y = plant.initial_state();
    let mut touch = None;
    for step in 0..count {
        let t = step as f64 * h;
        let mut k = [[0.0; 4]; 4];
        plant.derivative(t, &y, touch, &mut k[0]);
        for (stage, share) in [(1, 0.5), (2, 0.5), (3, 1.0)] {
            let at: [f64; 4] = std::array::from_fn(|i| y[i] + share * h * k[stage - 1][i]);
            plant.derivative(t + share * h, &at, touch, &mut k[stage]);
        }
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]));
        let (depth, rate) = plant.deformation(t + h, &y);
        if (depth > 0.0) != touch.is_some() {
            touch = (depth > 0.0).then(|| Touch { latched_m_s: rate.max(0.0), ..Touch::default() });
        }
    }
    y[1]
}

fn seconds(solve: impl Fn() -> f64, times: u32) -> (f64, f64) {
    let mut best = f64::INFINITY;
    let mut value = f64::NAN;
    for _ in 0..times {
        let start = Instant::now();
        value = black_box(solve());
        best = best.min(start.elapsed().as_secs_f64());
    }
    (value, best)
}

/// Solves the same problem to the same error with both methods.
fn compare() {
    let (plant, end_s) = problem();
    let (position, wall_s) = seconds(|| located(&plant, end_s), 50);
    let error = (position - REFERENCE_M).abs();
    println!(
        "slider-crank, located events: {:.3} wall s per simulated s, error {error:.1e} m",
        wall_s / end_s
    );
    let mut step_s = 1.6e-8;
    loop {
        let (position, fixed_s) = seconds(|| fixed_step(&plant, end_s, step_s), 1);
        let error = (position - REFERENCE_M).abs();
        println!(
            "slider-crank, RK4 at {step_s:.1e} s: {:.1} wall s per simulated s, error {error:.1e} m, \
             ratio {:.0}",
            fixed_s / end_s,
            fixed_s / wall_s
        );
        if error <= BOUND_M || step_s < 1e-9 {
            break;
        }
        step_s *= 0.5;
    }
}

fn main() {
    if std::env::args().any(|a| a == "--bench") {
        compare();
    }
    divan::main();
}

#[divan::bench]
fn slider_crank_located(bencher: divan::Bencher<'_, '_>) {
    let (plant, end_s) = problem();
    bencher.bench(|| located(&plant, end_s));
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn slider_crank_fixed_step(bencher: divan::Bencher<'_, '_>) {
    let (plant, end_s) = problem();
    bencher.bench(|| fixed_step(&plant, end_s, 1e-8));
}

/// A tenth of a cycle of bench B with its bearing in 11 slices and the load outside the bearing's
/// middle.
#[divan::bench(sample_count = 10)]
fn bench_b_in_two_planes(bencher: divan::Bencher<'_, '_>) {
    let Ok(mut bench) = TransmissionBench::open("bench-b") else { return };
    bench.two_plane = Some(TwoPlaneSection { load_offset_m: 0.02, ..TwoPlaneSection::default() });
    let plant = TwoPlane::new(&bench, bench.drive_profile(), bench.load_profile());
    bencher.bench(|| run_two_plane(&plant, 0.1, &[], DEFAULT_TOLERANCE).map(|r| r.steps));
}

/// One cycle of bench B takes one second: the result is wall seconds per simulated second.
#[divan::bench(args = ["babbitt", "plastic"])]
fn bench_b_with_the_law(bencher: divan::Bencher<'_, '_>, bearing: &str) {
    let Ok(mut bench) = TransmissionBench::open("bench-b") else { return };
    bench.set_material(if bearing == "babbitt" {
        BearingMaterial::Babbitt
    } else {
        BearingMaterial::Plastic
    });
    let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
    let times = bench.sample_times_s(1000.0);
    bencher.bench(|| run_with_law(&plant, bench.duration_s(), &times, DEFAULT_TOLERANCE).map(|r| r.steps));
}
