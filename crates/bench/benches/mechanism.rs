//! Wall time of the solver for mechanisms: `cargo bench -p bench --bench mechanism`.
//!
//! The slider-crank and bench B are solved by their dedicated plants and as mechanisms, each to the
//! same error, in alternation; the best time of each and their ratio are printed. A chain of links
//! that hang from each other in clearance joints shows the cost over the number of joints.

use bench::Bench;
use bench::description::{MechanismBench, SliderCrankBench, TransmissionBench};
use bench::integrate::integrate;
use bench::plants::mechanism::MechanismRun;
use bench::plants::slider_crank;
use bench::plants::transmission::Transmission;
use bench::simulate::{DEFAULT_TOLERANCE, run_with_law};
use std::hint::black_box;
use std::time::Instant;

/// Slider position after 0.6 revolutions, confirmed by three independent codes.
const REFERENCE_M: f64 = 0.0754435223;
/// Relative tolerance at which the mechanism is within 2e-7 m of it.
const CRANK_TOLERANCE: f64 = 3e-9;
/// Alternations of two solvers.
const REPETITIONS: usize = 60;
/// Numbers of clearance joints of the chain.
const CHAINS: [usize; 5] = [1, 2, 4, 8, 16];

fn example(name: &str) -> Option<MechanismBench> {
    let file = format!("{}/../../examples/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&file).ok()?;
    MechanismBench::from_bench(Bench::parse(&file, &text).ok()?, &file).ok()
}

fn run(bench: &MechanismBench, times_s: &[f64], tolerance: f64) -> MechanismRun {
    bench
        .simulate(times_s, tolerance)
        .unwrap_or_else(|error| unreachable!("the example can be integrated: {error}"))
}

/// Best times in s of solvers that alternate, so that other load meets all of them.
fn best_of<const N: usize>(solvers: [&dyn Fn() -> f64; N], repetitions: usize) -> [f64; N] {
    let mut best = [f64::INFINITY; N];
    for _ in 0..repetitions {
        for (best, solve) in best.iter_mut().zip(&solvers) {
            let start = Instant::now();
            black_box(solve());
            *best = best.min(start.elapsed().as_secs_f64());
        }
    }
    best
}

/// Position of the slider at the end, from the dedicated plant.
fn slider_m(bench: &SliderCrankBench) -> f64 {
    let plant = bench.plant();
    let tolerances = plant.tolerances(slider_crank::DEFAULT_TOLERANCE);
    let span_s = (0.0, bench.duration_s());
    integrate(&plant, span_s, plant.initial_state(), false, &[], &tolerances, |_, _, _| {})
        .map_or(f64::NAN, |run| run.state[1])
}

fn compare_slider_crank(general: &MechanismBench) {
    let Ok(bench) = SliderCrankBench::open("slider-crank") else { return };
    let end_s = bench.duration_s();
    let dedicated = || slider_m(&bench);
    let mechanism = || run(general, &[], CRANK_TOLERANCE).end.bodies[2].position[0];
    let [own, other] = best_of([&dedicated, &mechanism], REPETITIONS);
    println!(
        "slider-crank: dedicated {:.3} wall s per simulated s at {:.1e} m, mechanism {:.3} at {:.1e} m, \
         ratio {:.2}",
        own / end_s,
        (dedicated() - REFERENCE_M).abs(),
        other / end_s,
        (mechanism() - REFERENCE_M).abs(),
        other / own
    );
}

fn compare_bench_b(general: &MechanismBench) {
    let Ok(bench) = TransmissionBench::open("bench-b") else { return };
    let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
    let times = bench.sample_times_s(1000.0);
    let dedicated = |tolerance: f64| -> Vec<[f64; 2]> {
        run_with_law(&plant, 1.0, &times, tolerance)
            .map(|run| run.samples.iter().map(|s| [s.y_m, s.z_m]).collect())
            .unwrap_or_default()
    };
    let mechanism = |tolerance: f64| -> Vec<[f64; 2]> {
        let samples = run(general, &times, tolerance).samples;
        samples.iter().map(|s| [s.bodies[1].position[0], s.bodies[1].position[1]]).collect()
    };
    let known = dedicated(1e-12);
    let error = |found: &[[f64; 2]]| {
        let pairs = found.iter().zip(&known);
        pairs.map(|(a, b)| (a[0] - b[0]).abs().max((a[1] - b[1]).abs())).fold(0.0, f64::max)
    };
    let bound = error(&dedicated(DEFAULT_TOLERANCE));
    // The widest tolerance with at most the error of the dedicated plant.
    let mut tolerance = 1e-5;
    while tolerance > 1e-12 && error(&mechanism(tolerance)) > bound {
        tolerance *= 0.7;
    }
    let own = || dedicated(DEFAULT_TOLERANCE).len() as f64;
    let other = || mechanism(tolerance).len() as f64;
    let [own, other] = best_of([&own, &other], REPETITIONS);
    println!(
        "bench B: dedicated {:.2} ms per simulated s at {bound:.1e} m, mechanism {:.2} ms at {:.1e} m, ratio \
         {:.2}",
        1e3 * own,
        1e3 * other,
        error(&mechanism(tolerance)),
        other / own
    );
}

/// Chain of steel links that hang from each other in clearance joints and swing for 0.1 s.
fn chain(joints: usize) -> Option<MechanismBench> {
    let mut text = String::from(
        "plant = \"mechanism\"\nrun = { duration_s = 0.1, gravity_m_s2 = [0, -9.81] }\n\
         contact = [{ name = \"dry\", dissipation = \"flores\", restitution = 0.5, latch_floor_m_s = 0.01, \
         coulomb_coefficient = 0.1, regularisation_m_s = 0.01 }]\n",
    );
    let at = |i: usize| format!("[{:?}, {:?}]", 0.06 * i as f64, -0.08 * i as f64);
    for i in 0..joints {
        let first = if i == 0 { "ground".into() } else { format!("b{}", i - 1) };
        text += &format!(
            "[[body]]\nname = \"b{i}\"\nmass_kg = 0.5\nfrom_m = {}\nto_m = {}\n\
             [[joint]]\nkind = \"clearance\"\nfirst = \"{first}\"\nsecond = \"b{i}\"\nat_m = {}\n\
             contact = \"dry\"\nbearing_radius_m = 0.01\nclearance_m = 1e-4\n",
            at(i),
            at(i + 1),
            at(i)
        );
    }
    MechanismBench::from_bench(Bench::parse("chain", &text).ok()?, "chain").ok()
}

fn compare_chains() {
    let mut per_joint = f64::NAN;
    println!("joints, wall s per simulated s, the same per joint over that of one joint, steps, impacts");
    for joints in CHAINS {
        let Some(chain) = chain(joints) else { return };
        let solve = || run(&chain, &[], chain.run.tolerance).end.time_s;
        let [wall_s] = best_of([&solve], 5);
        let wall_s = wall_s / chain.run.duration_s;
        if joints == 1 {
            per_joint = wall_s;
        }
        let found = run(&chain, &[], chain.run.tolerance);
        println!(
            "{joints}, {wall_s:.3}, {:.2}, {}, {}",
            wall_s / per_joint / joints as f64,
            found.steps,
            found.impacts.len()
        );
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments == ["--bench"] {
        if let Some(bench) = example("slider-crank-mechanism") {
            compare_slider_crank(&bench);
        }
        if let Some(bench) = example("bench-b-mechanism") {
            compare_bench_b(&bench);
        }
        compare_chains();
    }
    divan::main();
}

#[divan::bench(args = CHAINS, sample_count = 3, sample_size = 1)]
fn chain_with_clearance_joints(bencher: divan::Bencher<'_, '_>, joints: usize) {
    let Some(chain) = chain(joints) else { return };
    bencher.bench(|| run(&chain, &[], chain.run.tolerance).steps);
}

#[divan::bench]
fn slider_crank_as_mechanism(bencher: divan::Bencher<'_, '_>) {
    let Some(bench) = example("slider-crank-mechanism") else { return };
    bencher.bench(|| run(&bench, &[], CRANK_TOLERANCE).steps);
}

#[divan::bench]
fn slider_crank_dedicated(bencher: divan::Bencher<'_, '_>) {
    let Ok(bench) = SliderCrankBench::open("slider-crank") else { return };
    bencher.bench(|| slider_m(&bench));
}
