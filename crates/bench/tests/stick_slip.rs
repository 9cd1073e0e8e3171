//! Located stick-slip on the transmission bench: against an independent time stepping with
//! set-valued friction, as the limit of regularised laws, and against its own rules.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]
use bench::Bench;
use bench::description::{Servo, TransmissionBench};
use bench::plants::transmission::{Snapshot, Transmission};
use bench::simulate::{DEFAULT_TOLERANCE, Run, run_bench_with_law, run_with_law, snapshots};

const PRESET: &str = include_str!("../presets/bench-b.toml");

/// Bench B with a friction law and its coefficients of sliding and of break-away.
fn bench(law: &str, coulomb: f64, break_away: f64, more: &str) -> TransmissionBench {
    let memory = match law {
        "seven-parameter" => "bristle_stiffness_per_m = 1e4\n[friction_memory]\nlag_s = 0.01\nrise_s = 0.2\n",
        _ => "",
    };
    let text = PRESET
        .replace("coulomb_coefficient = 0.14", &format!("coulomb_coefficient = {coulomb}"))
        .replace("static_coefficient = 0.22", &format!("static_coefficient = {break_away}"))
        .replace("\n[drive]", &format!("law = \"{law}\"\n{memory}{more}\n[drive]"));
    let Bench::Transmission(bench) = Bench::parse("x.toml", &text).unwrap() else { panic!("bench-b") };
    *bench
}

fn run(bench: &TransmissionBench, end_s: f64, samples_s: &[f64]) -> Run {
    let plant = Transmission::new(bench, bench.drive_profile(), bench.load_profile());
    run_with_law(&plant, end_s, samples_s, DEFAULT_TOLERANCE).unwrap()
}

fn every(step_s: f64, end_s: f64) -> Vec<f64> {
    (0..(end_s / step_s).round() as usize).map(|i| i as f64 * step_s).collect()
}

fn stuck(run: &Run) -> (usize, f64) {
    run.impacts.iter().fold((0, 0.0), |(count, time_s), i| (count + i.sticks, time_s + i.stuck_s))
}

/// Time stepping of bench B with impulses: the velocities of journal and crank, the fork as a
/// constraint on them, friction as an impulse from a set. The contact is a spring with a damper.
struct TimeStepping {
    coulomb: f64,
    break_away: f64,
}

#[derive(Default)]
struct Stepped {
    journal: [f64; 4],
    heat_j: f64,
    stuck_s: f64,
}

impl TimeStepping {
    const STIFFNESS_N_M: f64 = 3e8;
    const DAMPING_N_S_M: f64 = 2e5;

    fn run(&self, end_s: f64, h: f64) -> Stepped {
        let (mass, inertia, drive, load_lever, clearance) = (150.0, 60.0, 0.3, 0.36, 0.5e-3);
        let (radius, turn) = (0.07 - clearance, std::f64::consts::TAU);
        let fork = |t: f64| (0.086 * (1.0 - (turn * t).cos()), 0.086 * turn * (turn * t).sin());
        let (mut y, mut z, mut u, mut w) = (0.0, -clearance * (1.0 - 1e-3), 0.0, 0.0);
        let (mut turning, mut side) = (0.0, 0.0_f64);
        let mut result = Stepped::default();
        for i in 0..(end_s / h).round() as usize {
            let t = i as f64 * h;
            let load =
                1e4 * if t < 0.05 { 0.5 * (1.0 - (t / 0.05 * std::f64::consts::PI).cos()) } else { 1.0 };
            let distance = f64::hypot(y, z);
            let (ny, nz) = (y / distance, z / distance);
            let depth = distance - clearance;
            let spring = Self::STIFFNESS_N_M * depth + Self::DAMPING_N_S_M * (ny * u + nz * w);
            let normal = if depth > 0.0 { spring.max(0.0) } else { 0.0 };
            let sine = (fork(t).0 - y) / drive;
            let lever = drive * (sine.asin() + h * turning).cos();
            let load_torque = load * load_lever * (1.0 - sine * sine).sqrt();
            // Velocities after an impulse of friction. The fork's keeps its pin on the fork.
            let after = |impulse: f64| {
                let free_u = u + (h * (load - normal * ny) + impulse * nz) / mass;
                let free_turning = turning + (h * load_torque + impulse * radius) / inertia;
                let missing = fork(t + h).1 - free_u - lever * free_turning;
                let push = missing / (1.0 / mass + lever * lever / inertia);
                let new_w = w - h * 9.81 - (h * normal * nz + impulse * ny) / mass;
                [free_u + push / mass, new_w, free_turning + push * lever / inertia]
            };
            let sliding = |[u, w, turning]: [f64; 3]| radius * turning + nz * u - ny * w;
            let (free, one) = (sliding(after(0.0)), sliding(after(1.0)));
            let holding = -free / (one - free);
            let holds = holding.abs() <= self.break_away * normal * h;
            let mut impulse = -side * self.coulomb * normal * h;
            if side == 0.0 || side * sliding(after(impulse)) <= 0.0 {
                side = if holds { 0.0 } else { -holding.signum() };
                impulse = if holds { holding } else { -side * self.coulomb * normal * h };
            }
            let before = sliding([u, w, turning]);
            [u, w, turning] = after(impulse);
            (y, z) = (y + h * u, z + h * w);
            result.heat_j -= impulse * 0.5 * (before + sliding([u, w, turning]));
            result.stuck_s += if side == 0.0 && normal > 0.0 { h } else { 0.0 };
        }
        Stepped { journal: [y, z, u, w], ..result }
    }
}

fn bench_text(bench: &TransmissionBench) -> String {
    Bench::Transmission(Box::new(bench.clone())).to_toml().unwrap()
}

/// Journal at the end, heat and time of sticking converge to the located ones with the first order
/// of the stepping.
#[test]
fn sticking_agrees_with_time_stepping_of_set_valued_friction() {
    let contact = "[contact]\nlaw = \"kelvin-voigt\"\ncoefficient = 3e8\ndamping_n_s_m = 2e5";
    for (coulomb, break_away) in [(0.14, 0.14), (0.14, 0.22), (0.3, 0.5)] {
        let text = bench_text(&bench("coulomb", coulomb, break_away, "")).replace("[contact]", contact);
        let Bench::Transmission(bench) = Bench::parse("x.toml", &text).unwrap() else { panic!("bench-b") };
        let end_s = 0.65;
        let located = run(&bench, end_s, &[0.0, end_s - 1e-9]);
        let (count, stuck_s) = stuck(&located);
        assert!(count >= 2 && stuck_s > 0.014, "{count} {stuck_s}");
        let last = located.samples.last().unwrap();
        let reference = TimeStepping { coulomb, break_away };
        let off = |h: f64| {
            let stepped = reference.run(end_s, h);
            let [y, z, ..] = stepped.journal;
            let heat_j = stepped.heat_j - located.energy.friction_heat_j;
            [(stepped.stuck_s - stuck_s).abs(), heat_j.abs(), (y - last.y_m).hypot(z - last.z_m)]
        };
        let (coarse, fine) = (off(4e-6), off(0.5e-6));
        for ((coarse, fine), bound) in coarse.into_iter().zip(fine).zip([2e-6, 5e-5, 1e-7]) {
            assert!(fine < bound && fine < 0.3 * coarse, "{coulomb}: {coarse:e} {fine:e}");
        }
    }
}

/// The differences fall with the width of the regularised sign.
#[test]
fn regularised_laws_converge_to_the_located_one() {
    let end_s = 0.6;
    let located = run(&bench("coulomb", 0.14, 0.14, ""), end_s, &[0.0, end_s - 1e-9]);
    assert!(stuck(&located).1 > 0.01, "{:?}", stuck(&located));
    let off = |width_m_s: f64| {
        let mut bench = bench("regularised-linear", 0.14, 0.14, "");
        bench.friction.regularisation_m_s = width_m_s;
        let found = run(&bench, end_s, &[0.0, end_s - 1e-9]);
        let (a, b) = (found.samples.last().unwrap(), located.samples.last().unwrap());
        let heat_j = found.energy.friction_heat_j - located.energy.friction_heat_j;
        [heat_j.abs(), (a.y_m - b.y_m).hypot(a.z_m - b.z_m)]
    };
    let (wide, narrow) = (off(1e-3), off(1e-5));
    for ((wide, narrow), bound) in wide.into_iter().zip(narrow).zip([1e-4, 5e-8]) {
        assert!(narrow < bound && narrow < 0.02 * wide, "{wide:e} {narrow:e}");
    }
}

/// Checks every sample against the law, with an asymmetry of its coefficients, and returns the
/// number of samples at standstill.
fn check_samples(samples: &[Snapshot], coulomb: f64, break_away: f64, asymmetry: f64) -> usize {
    let mut still = 0;
    for s in samples.iter().filter(|s| s.forces.normal_n > 0.0) {
        let (v, ratio) = (s.contact.sliding_speed_m_s, s.forces.friction_n / s.forces.normal_n);
        if v.abs() < 1e-8 {
            still += 1;
            // Friction opposes the motion that it prevents.
            let limit = break_away * (1.0 - asymmetry * ratio.signum());
            assert!(ratio.abs() <= limit * (1.0 + 1e-9), "{s:?}");
        } else {
            let expected = coulomb * (1.0 + asymmetry * v.signum());
            assert!((ratio * v.signum() + expected).abs() < 1e-9, "{s:?}");
        }
    }
    still
}

#[test]
fn a_contact_slides_with_its_sign_or_sticks_within_its_limit() {
    for (coulomb, break_away) in [(0.14, 0.14), (0.14, 0.22), (0.05, 0.3)] {
        let bench = bench("coulomb", coulomb, break_away, "");
        let times = every(1e-4, 1.0);
        let run = run(&bench, 1.0, &times);
        let (count, stuck_s) = stuck(&run);
        let still = check_samples(&run.samples, coulomb, break_away, 0.0);
        assert!(count >= 1 && stuck_s > 0.01, "{count} {stuck_s}");
        assert!((1e-4 * still as f64 - stuck_s).abs() < 2e-4 * (1.0 + count as f64), "{still} {stuck_s}");
        assert!(run.energy.residual_rel < 1e-8, "{:?}", run.energy);
        // No heat while it sticks.
        let pairs = run.samples.windows(2).zip(run.losses_j.windows(2));
        let held = pairs.filter(|(s, _)| s.iter().all(|s| s.contact.sliding_speed_m_s.abs() < 1e-8));
        assert!(held.clone().count() > 50 && held.filter(|(_, heat)| heat[0][0] == heat[1][0]).count() > 50);
        // The plant without energies makes the same motion.
        let inputs = (bench.drive_profile(), bench.load_profile());
        let same = snapshots(&bench, inputs, 1.0, &times, DEFAULT_TOLERANCE).unwrap();
        check_samples(&same, coulomb, break_away, 0.0);
        let off = same.iter().zip(&run.samples).map(|(a, b)| (a.y_m - b.y_m).abs()).fold(0.0, f64::max);
        assert!(off < 1e-8, "{off}");
    }
}

#[test]
fn the_balance_closes_on_every_drive_and_shaft() {
    let servo = Servo {
        kp: 30.0,
        ki: 0.0,
        kd: 0.0,
        full_speed_m_s: 1.0,
        valve_lag_s: 0.01,
        dead_band: 0.0,
        compliance_m_n: 5e-8,
    };
    for law in ["coulomb", "karnopp", "seven-parameter"] {
        let rigid = bench(law, 0.14, 0.22, "");
        let mut all = vec![("rigid", rigid.clone()); 6];
        let [_, column, shaft, oval, with_servo, band] = &mut all[..] else { panic!("six") };
        (column.0, column.1.extension.hydraulic_compliance_m_n) = ("column", 5e-8);
        (shaft.0, shaft.1.extension.shaft_compliance_rad_nm) = ("shaft", 1e-7);
        (oval.0, oval.1.extension.out_of_round_m) = ("oval", [1e-5, 0.0]);
        (with_servo.0, with_servo.1.servo) = ("servo", Some(servo.clone()));
        (band.0, band.1.friction.regularisation_m_s) = ("wide band", 0.02);
        for (name, bench) in all {
            let run = run_bench_with_law(&bench, &every(1e-4, 1.0), DEFAULT_TOLERANCE).unwrap();
            assert!(stuck(&run).0 > 0, "{law}, {name}");
            assert!(run.energy.residual_rel < 1e-7, "{law}, {name}: {:?}", run.energy);
            if law == "coulomb" {
                assert!(check_samples(&run.samples, 0.14, 0.22, 0.0) > 50, "{name}");
            }
        }
    }
}

/// An effect that depends on the direction of sliding must not jump when the spring breaks: the
/// contact would slide back, stick and break again.
#[test]
fn effects_on_friction_do_not_make_the_spring_of_a_contact_chatter() {
    let plain = bench("seven-parameter", 0.14, 0.22, "");
    let text =
        bench_text(&plain).replace("bristle_stiffness_per_m = 10000.0", "bristle_stiffness_per_m = 1e5");
    for effect in [
        "",
        "[[effects]]\nname = \"stribeck-friction\"\ncoefficient_rise = 0.3\nspeed_m_s = 0.02\n",
        "[[effects]]\nname = \"coulomb-asymmetry\"\nasymmetry = 0.5\n",
    ] {
        let bench = Bench::parse("x.toml", &format!("{text}\n{effect}")).unwrap().resolved();
        let Bench::Transmission(bench) = bench else { panic!("bench-b") };
        let found = run(&bench, 1.0, &every(1e-3, 1.0));
        assert!(found.energy.residual_rel < 1e-6, "{effect}: {:?}", found.energy);
        // Stick-slip of the spring has periods of milliseconds.
        let (sticks, stuck_s) = stuck(&found);
        assert!(sticks >= 2 && stuck_s / sticks as f64 > 1e-3, "{effect}: {sticks} sticks, {stuck_s} s");
    }
}

#[test]
fn effects_on_friction_act_on_both_slips() {
    let effect = |text: &str| format!("\n[[effects]]\n{text}\n");
    let plain = bench("coulomb", 0.14, 0.22, "");
    let with = |text: &str| {
        let text = bench_text(&plain) + &effect(text);
        Bench::parse("x.toml", &text)
    };
    // A factor on friction from .3 s on, before the contact sticks.
    let Bench::Transmission(stepped) =
        with("name = \"friction-step\"\ntime_s = 0.3\nrelative_change = 0.5").unwrap().resolved()
    else {
        panic!("bench-b")
    };
    let found = run(&stepped, 1.0, &every(1e-4, 1.0));
    assert!(check_samples(&found.samples[3200..], 0.21, 0.33, 0.0) > 50);
    assert!(found.energy.residual_rel < 1e-8, "{:?}", found.energy);
    let uneven = with("name = \"coulomb-asymmetry\"\nasymmetry = 0.3").unwrap().resolved();
    let Bench::Transmission(mut uneven) = uneven else { panic!("bench-b") };
    uneven.friction.level = 1.5;
    let found = run(&uneven, 1.0, &every(1e-4, 1.0));
    assert!(check_samples(&found.samples, 0.21, 0.33, 0.3) > 50);
    assert!(found.energy.residual_rel < 1e-8, "{:?}", found.energy);
    let error = with("name = \"presliding-hysteresis\"\ndistance_m = 1e-5").unwrap_err().to_string();
    let expected =
        "effects is `presliding-hysteresis` with a friction law that sticks; expected one of the two";
    assert!(error.contains(expected), "{error}");
}
