//! Courses of drive and load, and the rudder servo, on the transmission bench.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use bench::description::TransmissionBench;
use bench::plants::transmission::Snapshot;
use bench::signals::{Motion, Profile};
use bench::simulate::{Run, run_bench_with_law, snapshots};
use bench::{Bench, PRESETS};
use std::fmt::Write as _;

const STEPS: &str = "[drive_profile]\nkind = \"steps\"\npoints = [[0.0, 0.0], [0.2, 0.1], [0.6, -0.05]]\n\
                     transition_s = 0.15\n";
const RAMPS: &str = "[drive_profile]\nkind = \"ramps\"\npoints = [[0.0, 0.0], [0.3, 0.1], [0.5, 0.1]]\n\
                     transition_s = 0.1\n";
const SPLINE: &str = "[drive_profile]\nkind = \"spline\"\npoints = [[0.0, 0.0], [0.3, 0.1], [0.5, -0.1]]\n";
const SPECTRUM: &str = "[drive_profile]\nkind = \"spectrum\"\nheight = 0.1\nperiod_s = 0.7\nseed = 3\n\
                        peak_enhancement = 3.3\n";
const SINE: &str = "[drive_profile]\nkind = \"sine\"\nheight = 0.2\nmean = 0.02\nperiod_s = 0.8\n";
const SERVO: &str = "[servo]\nkp = 10.0\nfull_speed_m_s = 0.4\ncompliance_m_n = 5e-8\n";

fn parse(more: &str, changes: &[(&str, &str)]) -> Result<TransmissionBench, String> {
    let (_, text) = PRESETS[0];
    let changed = changes.iter().fold(text.to_owned(), |text, (from, to)| text.replacen(from, to, 1));
    let text = changed.replacen("[logging]", &format!("{more}\n[logging]"), 1);
    let bench = Bench::parse("x", &text).map_err(|error| error.to_string())?;
    TransmissionBench::from_bench(bench, "x").map_err(|error| error.to_string())
}

fn bench(more: &str, changes: &[(&str, &str)]) -> TransmissionBench {
    parse(more, changes).unwrap()
}

fn run(bench: &TransmissionBench) -> Run {
    run_bench_with_law(bench, &bench.sample_times_s(10_000.0), 1e-8).unwrap()
}

#[test]
fn every_course_is_integrated_with_a_closed_energy_balance() {
    for course in [STEPS, RAMPS, SPLINE, SPECTRUM, SINE] {
        let bench = bench(course, &[("cycles = 1", "cycles = 2")]);
        let run = run(&bench);
        let drive = bench.drive_profile();
        let last = run.samples.last().unwrap();
        eprintln!("{course}: {} steps, residual {:e}", run.steps, run.energy_residual_rel);
        assert!(run.energy_residual_rel < 1e-6, "{course}: {:e}", run.energy_residual_rel);
        assert!(run.steps < 60_000, "{course}: {}", run.steps);
        assert_eq!(last.drive, drive.at(last.time_s));
        // The written description is the same bench.
        let again = Bench::from(bench.clone());
        assert_eq!(Bench::parse("again", &again.to_toml().unwrap()).unwrap(), again, "{course}");
    }
}

#[test]
fn a_log_of_the_sine_moves_the_bench_as_the_sine_does() {
    let plain = bench("", &[]);
    let folder = tempfile::tempdir().unwrap();
    let (drive, load) = (plain.drive_profile(), plain.load_profile());
    let mut csv = String::from("ms,x_mm,kN\n");
    for i in 0..=1000 {
        let t = 1e-3 * f64::from(i);
        let _ = writeln!(csv, "{},{:e},{:e}", i + 500, 1e3 * drive.at(t).value, 1e-3 * load.at(t).value);
    }
    std::fs::write(folder.path().join("motion.csv"), csv).unwrap();
    let log = |smoothing: &str| {
        format!(
            "[drive_profile]\nkind = \"log\"\nfile = \"motion.csv\"\ncolumn = \"x_mm / 1000\"\n\
             time_column = \"ms / 1000\"\n{smoothing}[load_profile]\nkind = \"log\"\nfile = \"motion.csv\"\n\
             column = \"kN * 1000\"\ntime_column = \"ms / 1000\"\n"
        )
    };
    let (_, text) = PRESETS[0];
    let expected = run(&plain).samples;
    for smoothing in ["", "smoothing_s = 0.004\n"] {
        let text = text.replace("[logging]", &format!("{}\n[logging]", log(smoothing)));
        let text = text.replace("force_n = 10e3", "force_n = 0.0").replace("ramp_s = 0.05", "ramp_s = 1e-9");
        let path = folder.path().join("bench.toml");
        std::fs::write(&path, text).unwrap();
        let logged = TransmissionBench::open(&path.display().to_string()).unwrap();
        let found = run(&logged).samples;
        let off = |read: fn(&Snapshot) -> f64| {
            let pairs = found.iter().zip(&expected).filter(|(s, _)| s.time_s < 0.97);
            pairs.map(|(a, b)| (read(a) - read(b)).abs()).fold(0.0, f64::max)
        };
        let (force_n, y_m) = (off(|s| s.forces.normal_n), off(|s| s.y_m));
        eprintln!("{smoothing}: {force_n} N {y_m} m");
        assert!(force_n < 20.0 && y_m < 1e-6, "{smoothing}: {force_n} {y_m}");
        // The path is absolute: a changed description finds the file from any folder.
        assert!(Bench::from(logged).checked("elsewhere/bench.toml").is_ok());
    }
    let text = text.replace("[logging]", &format!("{}\n[logging]", log("")));
    let path = folder.path().join("long.toml");
    std::fs::write(&path, text.replace("cycles = 1", "cycles = 2")).unwrap();
    let error = TransmissionBench::open(&path.display().to_string()).unwrap_err().to_string();
    assert!(
        error.contains("drive_profile.file is of a log of 1 s; expected a log as long as the run"),
        "{error}"
    );
}

#[test]
fn a_course_of_the_load_is_added_within_its_ramp() {
    let load = "[load_profile]\nkind = \"sine\"\nheight = 4000.0\nperiod_s = 0.25\n";
    let run = run(&bench(load, &[]));
    for s in run.samples.iter().step_by(97) {
        let t = s.time_s;
        let ramp = if t < 0.05 { 0.5 * (1.0 - (core::f64::consts::PI * t / 0.05).cos()) } else { 1.0 };
        let expected = ramp * (10e3 + 2000.0 * (core::f64::consts::TAU * t / 0.25).sin());
        assert!((s.load_force_n - expected).abs() < 1e-6, "{t}");
    }
    assert!(run.energy_residual_rel < 1e-6);
}

#[test]
fn wrong_courses_are_refused_with_field_content_and_expectation() {
    let refused = |more: &str| parse(more, &[]).unwrap_err();
    for (more, expected) in [
        ("[drive_profile]\nkind = \"dance\"\n", "drive_profile.kind is `dance`; expected one of sine, steps"),
        (
            "[drive_profile]\nkind = \"steps\"\npoints = [1.0, 2.0]\n",
            "drive_profile.points is an array; expected a list of pairs of numbers",
        ),
        (
            "[drive_profile]\nkind = \"steps\"\npoints = [[0.0, 0.0], [1.5, 0.1]]\ntransition_s = 0.1\n",
            "drive_profile.points is at the times 0, 1.5; expected ascending times from 0 to below the",
        ),
        (
            "[drive_profile]\nkind = \"ramps\"\npoints = [[0.0, 0.0], [0.5, 0.1]]\ntransition_s = 0.6\n",
            "drive_profile.transition_s is 0.6; expected 1e-6 to 0.5 s, the smallest distance of two points",
        ),
        (
            "[drive_profile]\nkind = \"sine\"\nheight = 0.1\nseed = 2\n",
            "drive_profile.seed is set; expected no value with kind = \"sine\"",
        ),
        (
            "[drive_profile]\nkind = \"sine\"\n",
            "drive_profile.height is missing; expected a height above 0 with kind = \"sine\"",
        ),
        (
            "[drive_profile]\nkind = \"sine\"\nheight = 0.7\n",
            "expected at most 0.297 m, 0.99 of the drive crank",
        ),
        (
            "[load_profile]\nkind = \"log\"\nfile = \"no-such.csv\"\n",
            "load_profile.file is `no-such.csv`; expected a readable log:",
        ),
        (
            "[two_plane]\n[servo]\nkp = 1.0\nfull_speed_m_s = 1.0\ncompliance_m_n = 1e-7\n",
            "expected no `[servo]`",
        ),
    ] {
        let error = refused(more);
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn a_sea_state_too_long_for_the_memory_is_refused_before_it_is_drawn() {
    let sea = "[drive_profile]\nkind = \"spectrum\"\nheight = 0.01\nperiod_s = 0.001\n";
    let error = parse(sea, &[("cycles = 1", "cycles = 1000")]).unwrap_err();
    assert!(
        error.contains("drive_profile.period_s is 0.001; expected at most 100000 peak periods"),
        "{error}"
    );
}

#[test]
fn a_schedule_of_one_point_stays_there() {
    let steps = "[drive_profile]\nkind = \"steps\"\npoints = [[0.0, 0.02]]\nperiod_s = 0.25\n";
    let course = bench(steps, &[]).drive_profile();
    for i in 0..=40 {
        let motion = course.at(0.025 * f64::from(i));
        assert_eq!((motion.value, motion.rate, motion.acceleration), (0.02, 0.0, 0.0), "{i}");
    }
}

/// Course with a step of the order by 20 mm at 0.1 s.
const STEP: &str = "[drive_profile]\nkind = \"steps\"\npoints = [[0.0, 0.0], [0.1, 0.02]]\n\
                    transition_s = 1e-3\nperiod_s = 100.0\n";

#[test]
fn a_proportional_servo_follows_a_step_as_a_first_order_lag() {
    // v kp = 4/s; the column and the shaft are 40 times faster. The load is small.
    let bench = bench(
        &format!("{STEP}{SERVO}"),
        &[("force_n = 10e3", "force_n = 100.0"), ("cycles = 1", "cycles = 2")],
    );
    let run = run(&bench);
    for s in run.samples.iter().step_by(500) {
        let since_s = (s.time_s - 0.1005).max(0.0);
        let expected = 0.02 * (1.0 - (-4.0 * since_s).exp());
        // The step of the flow makes the shaft swing on its column.
        let allowed = 0.02 * (0.005 + 0.03 * (-10.0 * since_s).exp());
        assert!((s.drive.value - expected).abs() < allowed, "{}: {} {expected}", s.time_s, s.drive.value);
    }
    assert!(run.energy_residual_rel < 1e-6, "{:e}", run.energy_residual_rel);
}

#[test]
fn the_dead_band_of_the_valve_leaves_its_error() {
    // Opening 0.04 per 10/m: 4 mm remain.
    let more = format!("{STEP}{SERVO}dead_band = 0.04\nvalve_lag_s = 0.01\n");
    let bench = bench(&more, &[("force_n = 10e3", "force_n = 100.0"), ("cycles = 1", "cycles = 4")]);
    let last = *run(&bench).samples.last().unwrap();
    assert!((0.02 - last.drive.value - 0.004).abs() < 5e-5, "{last:?}");
}

#[test]
fn a_rigid_fork_that_follows_the_measured_position_needs_the_force_of_the_servo() {
    let bench = bench(SERVO, &[]);
    let times = bench.sample_times_s(10_000.0);
    let servo = run(&bench).samples;
    let nodes: Vec<Motion> = servo.iter().map(|s| s.drive).collect();
    let drive = Profile::Curve { time_s: times.clone(), nodes };
    let mut rigid = bench.clone();
    rigid.servo = None;
    let found = snapshots(&rigid, (drive, bench.load_profile()), bench.duration_s(), &times, 1e-8).unwrap();
    let off = |read: fn(&Snapshot) -> f64| {
        found.iter().zip(&servo).map(|(a, b)| (read(a) - read(b)).abs()).fold(0.0, f64::max)
    };
    let offs = [off(|s| s.y_m), off(|s| s.forces.normal_n), off(|s| s.drive_force_n), off(|s| s.angle_rad)];
    eprintln!("{offs:?}");
    assert!(offs[0] < 1e-7 && offs[1] < 10.0 && offs[2] < 20.0 && offs[3] < 1e-6, "{offs:?}");
    // The order is the sine; the fork lags it.
    let order = bench.drive_profile();
    let lag = servo.iter().map(|s| (s.drive.value - order.at(s.time_s).value).abs()).fold(0.0, f64::max);
    assert!((0.02..0.15).contains(&lag), "{lag}");
}
