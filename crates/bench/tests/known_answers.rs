//! The transmission bench against the published table of an independent multibody code.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]
use bench::BearingMaterial;
use bench::description::TransmissionBench;
use bench::plants::transmission::Transmission;
use bench::simulate::{Run, run_with_held_force, run_with_law};

fn bench_b(material: BearingMaterial, clearance_mm: f64, load_n: f64) -> TransmissionBench {
    let mut bench = TransmissionBench::open("bench-b").unwrap();
    bench.set_material(material);
    bench.set_radial_clearance(clearance_mm * 1e-3);
    bench.load.force_n = load_n;
    bench
}

fn run(bench: &TransmissionBench) -> Run {
    let plant = Transmission::new(bench, bench.drive_profile(), bench.load_profile());
    run_with_law(&plant, bench.duration_s(), &bench.sample_times_s(10_000.0), 1e-8).unwrap()
}

/// The published peaks exclude the start: they count from the end of the load's ramp.
fn peak(run: &Run, read: impl Fn(&bench::plants::transmission::Snapshot) -> f64) -> f64 {
    run.samples.iter().filter(|s| s.time_s >= 0.05).map(|s| read(s).abs()).fold(0.0, f64::max)
}

#[test]
fn bench_b_reproduces_the_table() {
    for (material, rows) in [
        (
            BearingMaterial::Babbitt,
            [
                (0.10, 8067.0, 7998.0, 2178.0, 96.0, 31.0),
                (0.25, 10137.0, 10223.0, 2200.0, 120.0, 37.0),
                (0.50, 11755.0, 11855.0, 2404.0, 137.0, 46.0),
                (1.00, 13924.0, 14050.0, 2654.0, 140.0, 56.0),
            ],
        ),
        (
            BearingMaterial::Plastic,
            [
                (0.10, 6004.0, 5909.0, 1745.0, 34.0, 150.0),
                (0.25, 5952.0, 5854.0, 1779.0, 37.0, 165.0),
                (0.50, 6244.0, 6201.0, 1942.0, 48.0, 184.0),
                (1.00, 7173.0, 7180.0, 2014.0, 54.0, 218.0),
            ],
        ),
    ] {
        for (clearance, normal, y, z, torque, deepest_um) in rows {
            let run = run(&bench_b(material, clearance, 10e3));
            let peak_n = peak(&run, |s| s.forces.normal_n);
            let found = [
                peak_n,
                peak(&run, |s| s.force_y_n),
                peak(&run, |s| s.force_z_n),
                peak(&run, |s| s.friction_torque_nm),
                1e6 * peak(&run, |s| s.contact.deformation_m.max(0.0)),
            ];
            eprintln!(
                "{material:?} {clearance}: {found:.1?} steps {} residual {:e} contacts {}",
                run.steps,
                run.energy_residual_rel,
                run.impacts.len()
            );
            for (found, expected) in found.iter().zip([normal, y, z, torque, deepest_um]) {
                // The table is printed in integer micrometres and newton metres.
                let tolerance = 0.02 * expected + if expected < 300.0 { 0.5 } else { 0.0 };
                assert!(
                    (found - expected).abs() < tolerance,
                    "{material:?} {clearance} mm: {found} for {expected}"
                );
            }
            assert!(run.energy_residual_rel < 1e-6, "energy residual {}", run.energy_residual_rel);
        }
    }
}

#[test]
fn the_load_sweep_matches_the_published_forces() {
    for (material, forces) in [
        (BearingMaterial::Babbitt, [13924.0, 7068.0, 5481.0, 4917.0, 4838.0, 6601.0]),
        (BearingMaterial::Plastic, [7173.0, 5962.0, 5070.0, 4776.0, 5664.0, 6780.0]),
    ] {
        for (load_kn, expected) in [10.0, 5.0, 1.0, -1.0, -5.0, -10.0].into_iter().zip(forces) {
            let run = run(&bench_b(material, 1.0, load_kn * 1e3));
            let found = peak(&run, |s| s.forces.normal_n);
            assert!(
                (found / expected - 1.0).abs() < 0.02,
                "{material:?} {load_kn} kN: {found} for {expected}"
            );
        }
    }
}

/// A force from outside must not add an error of the loop: with the law itself as this force, the
/// run follows the error-controlled run. A force that is held in the direction of the step's start
/// would deviate by 3 %.
#[test]
fn a_law_held_over_the_communication_step_follows_the_located_run() {
    for (material, step_s) in [(BearingMaterial::Babbitt, 10e-6), (BearingMaterial::Plastic, 20e-6)] {
        let bench = bench_b(material, 0.5, 10e3);
        let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
        let times = bench.sample_times_s(10_000.0);
        let held =
            run_with_held_force(&plant, bench.duration_s(), &times, step_s, |view| plant.law(view)).unwrap();
        let located = run(&bench);
        let (a, b) = (peak(&held, |s| s.forces.normal_n), peak(&located, |s| s.forces.normal_n));
        assert!((a / b - 1.0).abs() < 5e-3, "{material:?}: peak {a} for {b}");
        assert!(held.energy_residual_rel < 1e-6, "{}", held.energy_residual_rel);
    }
}
