//! The bench in two planes: the planar bench as its special case, edges, moments, energy.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]
use bench::Bench;
use bench::description::{LoadFriction, TransmissionBench, TwoPlaneSection};
use bench::plants::transmission::Transmission;
use bench::plants::two_plane::{TwoPlane, TwoPlaneRun, TwoPlaneSnapshot, run_two_plane};
use bench::simulate::{DEFAULT_TOLERANCE, run_with_law};

fn bench(stiffness: &str, section: TwoPlaneSection) -> TransmissionBench {
    let text = include_str!("../presets/bench-b.toml").replace("hybrid-as-printed", stiffness);
    let Bench::Transmission(mut bench) = Bench::parse("bench-b", &text).unwrap() else { panic!("bench-b") };
    bench.two_plane = Some(section);
    *bench
}

fn run(bench: &TransmissionBench, end_s: f64) -> TwoPlaneRun {
    let plant = TwoPlane::new(bench, bench.drive_profile(), bench.load_profile());
    let times: Vec<f64> = (0..(end_s * 1e4) as usize).map(|i| 1e-4 * i as f64).collect();
    run_two_plane(&plant, end_s, &times, DEFAULT_TOLERANCE).unwrap()
}

/// Mean over a run after its start.
fn mean(run: &TwoPlaneRun, read: impl Fn(&TwoPlaneSnapshot) -> f64) -> f64 {
    let samples: Vec<f64> = run.samples.iter().filter(|s| s.planar.time_s > 0.1).map(read).collect();
    samples.iter().sum::<f64>() / samples.len() as f64
}

#[test]
fn without_tilt_the_result_is_that_of_the_planar_bench() {
    for stiffness in ["hybrid-as-printed", "liu-times-length", "johnson"] {
        for slices in [1, 11] {
            let bench = bench(stiffness, TwoPlaneSection { slices, ..TwoPlaneSection::default() });
            let two = run(&bench, 0.4);
            let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
            let times: Vec<f64> = two.samples.iter().map(|s| s.planar.time_s).collect();
            let planar = run_with_law(&plant, 0.4, &times, DEFAULT_TOLERANCE).unwrap();
            let mut worst = [0.0_f64; 4];
            for (a, b) in two.samples.iter().zip(&planar.samples) {
                let distances = [
                    (a.planar.y_m - b.y_m).hypot(a.planar.z_m - b.z_m),
                    a.planar.force_y_n - b.force_y_n,
                    a.planar.drive_force_n - b.drive_force_n,
                    a.planar.friction_torque_nm - b.friction_torque_nm,
                ];
                worst = std::array::from_fn(|i| worst[i].max(distances[i].abs()));
                // Rounding only: a billionth of the tilt that the clearance allows.
                assert!(a.tilt_about_y_rad.abs() + a.tilt_about_z_rad.abs() < 1e-12);
            }
            eprintln!("{stiffness}, {slices} slices: {worst:?}");
            // The two differ by the integrator's tolerance; the bench's sensors have noise of 0.2
            // um, 15 N and 0.4 N m.
            for (worst, bound) in worst.iter().zip([1e-9, 0.5, 0.5, 0.05]) {
                assert!(worst < &bound, "{stiffness}, {slices} slices: {worst:.1e} of {bound:.1e}");
            }
            let last = two.samples.last().unwrap();
            assert!((last.edge_ratio() - 1.0).abs() < 1e-9, "{}", last.edge_ratio());
            assert!(two.energy.residual_rel < 1e-7, "{:?}", two.energy);
        }
    }
}

#[test]
fn a_misaligned_bearing_loads_one_edge() {
    let section = |misalignment_z_rad| TwoPlaneSection {
        misalignment_z_rad,
        support_stiffness_nm_rad: 3e6,
        support_damping_nm_s_rad: 500.0,
        ..TwoPlaneSection::default()
    };
    let ratio = |s: &TwoPlaneSnapshot| s.edge_ratio();
    let even = run(&bench("liu-times-length", section(0.0)), 0.3);
    let up = run(&bench("liu-times-length", section(5e-4)), 0.3);
    let down = run(&bench("liu-times-length", section(-5e-4)), 0.3);
    assert!((mean(&even, ratio) - 1.0).abs() < 1e-6);
    assert!(mean(&up, ratio) > 1.5, "{}", mean(&up, ratio));
    // The mirrored misalignment loads the other edge equally.
    let ends = |run: &TwoPlaneRun| {
        (mean(run, |s| s.slices[0].line_load_n_m), mean(run, |s| s.slices[10].line_load_n_m))
    };
    let ((a, b), (c, d)) = (ends(&up), ends(&down));
    assert!(a.max(b) > 3.0 * a.min(b), "{a} {b}");
    assert!((a / d - 1.0).abs() < 1e-3 && (b / c - 1.0).abs() < 1e-3, "{a} {b} {c} {d}");
    // On average the load decreases from the loaded edge on.
    let loads: Vec<f64> = (0..11).map(|k| mean(&up, |s| s.slices[k].line_load_n_m)).collect();
    let rising = b > a;
    assert!(loads.windows(2).all(|w| (w[1] > w[0]) == rising || w[0] == w[1]), "{loads:?}");
    for run in [&even, &up, &down] {
        assert!(run.energy.residual_rel < 1e-6, "{:?}", run.energy);
    }
}

#[test]
fn offset_loads_tilt_the_shaft_and_the_bearing_s_moment_balances_them() {
    let section =
        TwoPlaneSection { drive_offset_m: 0.05, load_offset_m: -0.05, ..TwoPlaneSection::default() };
    let inertia = section.transverse_inertia_kg_m2;
    let bench = bench("liu-times-length", section);
    let run = run(&bench, 0.3);
    assert!(run.energy.residual_rel < 1e-6, "{:?}", run.energy);
    let tilt = mean(&run, |s| s.tilt_about_z_rad);
    assert!(tilt.abs() > 1e-5, "{tilt}");
    // Slices begin and end contact independently.
    assert!(run.impacts.iter().any(|i| i.contact == 0) && run.impacts.iter().any(|i| i.contact == 10));
    // Over a window only the moments of drive, load and bearing change the angular momentum.
    let moment =
        |s: &TwoPlaneSnapshot| 0.05 * s.planar.drive_force_n - 0.05 * s.planar.load_force_n + s.moment_y_nm;
    let window: Vec<&TwoPlaneSnapshot> = run.samples.iter().filter(|s| s.planar.time_s > 0.1).collect();
    let step = 1e-4;
    let rate = |i: usize| (window[i + 1].tilt_about_z_rad - window[i - 1].tilt_about_z_rad) / (2.0 * step);
    let last = window.len() - 2;
    let impulse: f64 = window[1..last].windows(2).map(|w| 0.5 * step * (moment(w[0]) + moment(w[1]))).sum();
    let change = inertia * (rate(last - 1) - rate(1));
    let drive: f64 = window[1..last].iter().map(|s| 0.05 * s.planar.drive_force_n.abs() * step).sum();
    eprintln!("{impulse} {change} of {drive}");
    assert!((impulse - change).abs() < 1e-5 * drive, "{impulse} {change} of {drive}");
}

#[test]
fn friction_effects_and_the_load_cylinder_act_as_on_the_planar_bench() {
    let mut bench = bench("liu-times-length", TwoPlaneSection::default());
    bench.extension.viscous_n_s_m = 3000.0;
    bench.extension.coulomb_asymmetry = 0.2;
    bench.extension.drive_lag_s = 0.002;
    bench.load_friction =
        Some(LoadFriction { coulomb_n: 300.0, viscous_n_s_m: 500.0, regularisation_m_s: 1e-3 });
    let two = run(&bench, 0.2);
    let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
    let times: Vec<f64> = two.samples.iter().map(|s| s.planar.time_s).collect();
    let planar = run_with_law(&plant, 0.2, &times, DEFAULT_TOLERANCE).unwrap();
    for (a, b) in two.samples.iter().zip(&planar.samples).filter(|(_, b)| b.time_s > 0.05) {
        assert!((a.planar.y_m - b.y_m).hypot(a.planar.z_m - b.z_m) < 1e-9, "{}", b.time_s);
        assert!((a.planar.friction_torque_nm - b.friction_torque_nm).abs() < 0.05, "{}", b.time_s);
        assert!((a.planar.drive_force_n - b.drive_force_n).abs() < 0.5, "{}", b.time_s);
    }
    assert!(two.energy.residual_rel < 1e-7 && two.energy.load_friction_heat_j > 1.0, "{:?}", two.energy);
}

#[test]
fn a_tilted_record_has_the_channels_of_a_planar_one() {
    let section = TwoPlaneSection { load_offset_m: 0.02, ..TwoPlaneSection::default() };
    let mut tilted = bench("liu-times-length", section);
    tilted.logging.sample_rate_hz = 200.0;
    let mut planar = tilted.clone();
    planar.two_plane = None;
    let record = |b: TransmissionBench| bench::simulate::record(&Bench::from(b), 1).unwrap();
    let (a, b) = (record(tilted), record(planar));
    assert!(a.channels.keys().eq(b.channels.keys()) && a.time_s == b.time_s);
    assert_ne!(a.channels[&bench::Channel::JournalY], b.channels[&bench::Channel::JournalY]);
}
