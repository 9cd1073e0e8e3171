//! Runs in steps from outside against runs in one piece.

use bench::Bench;
use bench::description::{MechanismBench, TransmissionBench};
use bench::plants::transmission::{Snapshot, Transmission};
use bench::simulate::stepped::{BenchMemory, External, SteppedBench, SteppedMechanism};
use bench::simulate::{run_bench_with_law, run_with_held_force};

const TOLERANCE: f64 = 1e-9;

fn transmission(name: &str, change: impl FnOnce(&mut TransmissionBench)) -> TransmissionBench {
    let mut bench = Bench::open(name).unwrap();
    change(bench.transmission_mut().unwrap());
    let bench = bench.checked("changed").unwrap();
    TransmissionBench::from_bench(bench.resolved(), name).unwrap()
}

/// Snapshots of a bench with its laws after each of `steps` steps of `step_s`, and the memory.
fn stepped(bench: &TransmissionBench, step_s: f64, steps: usize) -> (Vec<Snapshot>, BenchMemory) {
    let mut plant = SteppedBench::new(bench, TOLERANCE);
    let external = External::default();
    let mut memory = plant.start(0.0, &external, false);
    let mut snapshots = Vec::new();
    for step in 0..steps {
        let span_s = (step as f64 * step_s, (step + 1) as f64 * step_s);
        plant.step(&mut memory, span_s, &external).unwrap();
        // The memory is plain data: a copy continues.
        memory = memory.clone();
        snapshots.push(plant.snapshot(span_s.1, &memory, (span_s.0, &external)));
    }
    (snapshots, memory)
}

/// Largest differences of normal force, relative to the largest, and of the journal in m.
fn differences(found: &[Snapshot], expected: &[Snapshot]) -> (f64, f64) {
    assert_eq!(found.len(), expected.len());
    let scale_n = expected.iter().map(|s| s.forces.normal_n).fold(0.0, f64::max);
    let pairs = || found.iter().zip(expected);
    let force = pairs().map(|(a, b)| (a.forces.normal_n - b.forces.normal_n).abs()).fold(0.0, f64::max);
    let journal = pairs().map(|(a, b)| (a.y_m - b.y_m).hypot(a.z_m - b.z_m)).fold(0.0, f64::max);
    (force / scale_n, journal)
}

#[test]
fn a_bench_in_steps_follows_the_run_in_one_piece() {
    let stick = |bench: &mut TransmissionBench| {
        bench.friction.law = Some(serde_json::from_str("\"coulomb\"").unwrap());
    };
    let soft = "../../examples/soft-hydraulics.toml";
    let cases = [
        ("bench-b", transmission("bench-b", |_| {}), 1e-3),
        ("bench-b, coarse", transmission("bench-b", |_| {}), 1e-2),
        ("plastic", transmission("bench-b", |b| b.set_material(bench::BearingMaterial::Plastic)), 3e-4),
        ("coulomb", transmission("bench-b", stick), 1e-3),
        ("soft", transmission(soft, |_| {}), 1e-3),
        ("servo", transmission("../../examples/rudder-servo.toml", |_| {}), 1e-3),
    ];
    for (name, bench, step_s) in cases {
        let steps = (bench.duration_s().min(0.5) / step_s) as usize;
        let times: Vec<f64> = (0..=steps).map(|step| step as f64 * step_s).collect();
        let (found, memory) = stepped(&bench, step_s, steps);
        let run = run_bench_with_law(&bench, &times, TOLERANCE).unwrap();
        let (force, journal_m) = differences(&found, &run.samples[1..]);
        println!("{name}: force {force:.1e}, journal {journal_m:.1e} m, {} contacts", memory.contacts);
        assert!(force < 1e-5 && journal_m < 1e-9, "{name}: {force} {journal_m}");
        let begun = run.impacts.iter().filter(|i| i.onset_s <= times[steps]).count();
        assert_eq!(memory.contacts as usize, begun, "{name}");
    }
}

#[test]
fn a_held_force_in_steps_is_the_run_in_one_piece_to_rounding() {
    let bench = transmission("bench-b", |_| {});
    let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
    let (step_s, end_s) = (1e-5, 0.1);
    let times: Vec<f64> = (1..100).map(|i| f64::from(i) * 1e-3).collect();
    let whole = run_with_held_force(&plant, end_s, &times, step_s, |view| plant.law(view)).unwrap();
    let mut stepped = SteppedBench::new(&bench, TOLERANCE);
    let external = External::default();
    let mut memory = stepped.start(0.0, &external, true);
    for (i, sample) in whole.samples.iter().enumerate() {
        let span_s = (i as f64 * 1e-3, times[i]);
        stepped.step_held(&mut memory, span_s, &external, (step_s, &mut |view| plant.law(view))).unwrap();
        let found = stepped.snapshot(times[i], &memory, (span_s.0, &external));
        assert!((found.y_m - sample.y_m).hypot(found.z_m - sample.z_m) < 1e-12, "{}", times[i]);
    }
    assert_eq!(memory.contacts as usize, whole.impacts.len());
}

#[test]
fn external_motion_and_load_replace_the_described_ones() {
    let bench = transmission("bench-b", |_| {});
    let (drive, load) = (bench.drive_profile(), bench.load_profile());
    let mut plant = SteppedBench::new(&bench, TOLERANCE);
    let at = |time_s: f64| External { drive: Some(drive.at(time_s)), load_n: Some(load.at(time_s).value) };
    let mut memory = plant.start(0.0, &at(0.0), false);
    let (steps, step_s) = (2000, 1e-4);
    for step in 0..steps {
        let start_s = f64::from(step) * step_s;
        plant.step(&mut memory, (start_s, start_s + step_s), &at(start_s)).unwrap();
    }
    let end_s = f64::from(steps) * step_s;
    let found = plant.snapshot(end_s, &memory, (end_s, &at(end_s)));
    let expected = run_bench_with_law(&bench, &[0.0, end_s], TOLERANCE).unwrap().samples[1];
    let error = (found.forces.normal_n / expected.forces.normal_n - 1.0).abs();
    assert!(error < 2e-2, "{found:?} {expected:?}");
    // Another load is not the described one.
    let other = External { load_n: Some(-5e3), ..at(0.0) };
    let mut memory = plant.start(0.0, &other, false);
    plant.step(&mut memory, (0.0, 0.1), &other).unwrap();
    assert_eq!(plant.snapshot(0.1, &memory, (0.0, &other)).load_force_n, -5e3);
}

#[test]
fn a_mechanism_in_steps_follows_the_run_in_one_piece() {
    let bench = Bench::open("../../examples/four-bar.toml").unwrap();
    let mut bench = MechanismBench::from_bench(bench, "four-bar").unwrap();
    bench.run.tolerance = TOLERANCE;
    let (step_s, steps) = (1e-3, 200);
    let times: Vec<f64> = (1..=steps).map(|step| f64::from(step) * step_s).collect();
    let run = bench.simulate(&times, TOLERANCE).unwrap();
    let mut mechanism = SteppedMechanism::new(&bench, false).unwrap();
    let (mut memory, first) = mechanism.start();
    let at_start = bench.simulate(&[0.0], TOLERANCE).unwrap();
    assert_eq!(first.bodies, at_start.samples[0].bodies);
    let mut unused = |_: usize, _: &_| unreachable!("no networks");
    for (i, expected) in run.samples.iter().take(steps as usize).enumerate() {
        let span_s = (i as f64 * step_s, times[i]);
        let found = mechanism.step(&mut memory, span_s, &[], (1e-5, &mut unused)).unwrap();
        for (found, expected) in found.bodies.iter().zip(&expected.bodies) {
            let error = found.position.iter().zip(expected.position).map(|(a, b)| (a - b).abs());
            assert!(error.fold(0.0, f64::max) < 1e-7, "{} s: {found:?} {expected:?}", times[i]);
        }
    }
    // A force on a body moves it.
    let (mut pushed, _) = mechanism.start();
    let loads = [[0.0; 3], [0.0, 500.0, 0.0], [0.0; 3]];
    let found = mechanism.step(&mut pushed, (0.0, 0.05), &loads, (1e-5, &mut unused)).unwrap();
    assert!((found.bodies[1].position[1] - run.samples[49].bodies[1].position[1]).abs() > 1e-7);
}
