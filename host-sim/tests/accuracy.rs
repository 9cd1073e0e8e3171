//! `host-sim accuracy` on the command line: figures, verdicts, files, exit codes.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use serde_json::Value;
use std::process::Command;

fn number(value: &Value, path: &str) -> f64 {
    value.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} in {value}"))
}

#[test]
fn every_clearance_and_load_is_evaluated_and_a_missed_goal_is_no_failure() {
    let directory = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .current_dir(directory.path())
        .args(["accuracy", "--bearing", "plastic", "--json", "--out", "accuracy"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let runs = found["runs"].as_array().unwrap();
    assert_eq!((runs.len(), runs.iter().filter(|r| r["held_out"] == true).count()), (34, 10));
    let known =
        runs.iter().find(|r| number(r, "/clearance_mm") == 1.0 && number(r, "/load_kn") == 10.0).unwrap();
    assert!((number(known, "/in_the_loop/peak_contact_force_n") / 7173.0 - 1.0).abs() < 1e-3, "{known}");
    for goal in found["goals"].as_array().unwrap() {
        let worst = number(goal, "/paper/worst").abs().max(number(goal, "/held_out/worst").abs());
        assert_eq!(goal["met"], worst <= number(goal, "/limit"), "{goal}");
        assert_eq!(number(goal, "/paper/runs") + number(goal, "/held_out/runs"), 34.0);
    }
    for run in runs {
        assert_eq!(number(run, "/gap/network_n"), 0.0, "{run}");
        assert!(number(run, "/gap/samples") > 4_000.0);
        // Float networks and law are close at the same contact; the filter's factors improve on
        // both. Noise hardly matters: the model's uncertainty at the start does.
        let force = |of: &str| number(run, &format!("/estimate/{of}/force_rms_n"));
        assert!((force("law") / force("float_network") - 1.0).abs() < 0.2, "{run}");
        assert!(force("network") < 1.1 * force("float_network"), "{run}");
        assert!(force("perfect_sensors") < 1.3 * force("network"), "{run}");
        // With a small step the held law agrees with the law.
        assert!(number(run, "/in_the_loop/held_law/peak").abs() < 0.02, "{run}");
    }
    let folder = directory.path().join("accuracy");
    for name in ["accuracy.json", "report.html", "peak-change-plastic.svg", "worst-estimate-detail.svg"] {
        assert!(folder.join(name).metadata().unwrap().len() > 1000, "{name}");
    }
    assert!(!folder.join("peak-change-babbitt.svg").exists());
}

#[test]
fn a_step_out_of_range_is_refused_before_any_run() {
    let output =
        Command::new(env!("CARGO_BIN_EXE_host-sim")).args(["accuracy", "--step-us", "-3"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--step-us: found -3; expected"));
}

#[test]
fn a_number_of_worlds_out_of_range_is_refused() {
    for count in ["0", "-1", "10001", "99999999999", "ten"] {
        let arguments = ["accuracy", "--worlds", count, "--out", "/dev/null/none"];
        let output = Command::new(env!("CARGO_BIN_EXE_host-sim")).args(arguments).output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{count}: {message}");
        assert!(message.contains("--worlds") && message.contains(count), "{count}: {message}");
    }
}

/// Compares cases with those of the published campaign (`cargo xtask accuracy`).
fn assert_golden(cases: &[Value]) {
    let golden: Vec<Value> =
        serde_json::from_str(include_str!("../../tests/golden/accuracy-worlds.json")).unwrap();
    let is_same = |a: &Value, b: &Value| {
        ["world", "bearing", "clearance_mm", "load_kn"].iter().all(|name| a[name] == b[name])
    };
    let mut compared = 0;
    for case in cases.iter().filter(|case| case["estimator"] == "network") {
        let known = golden.iter().find(|known| is_same(case, known)).unwrap_or_else(|| panic!("{case}"));
        for name in ["rms_n", "max_n", "full_scale_n", "torque_rms_nm", "torque_full_scale_nm"] {
            let (found, expected) = (number(case, &format!("/{name}")), number(known, &format!("/{name}")));
            // The worlds use the system's sine and exponential.
            assert!((found / expected - 1.0).abs() < 1e-6, "{name}: {found}, golden {expected}: {case}");
        }
        compared += 1;
    }
    assert_eq!(compared, 4 * 21);
}

#[test]
fn worlds_are_measured_with_every_estimator_and_stored_with_a_page() {
    let directory = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .current_dir(directory.path())
        .args(["accuracy", "--worlds", "1", "--bearing", "plastic", "--json", "--out", "worlds"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let cases = found["cases"].as_array().unwrap();
    // Exact, drawn, 14 with a parameter off, 5 with an effect; at 4 operating points.
    assert_eq!(cases.len(), 4 * 21 * 3);
    let of = |world: &str, estimator: &str| {
        let mut chosen = cases.iter().filter(|c| c["world"] == world && c["estimator"] == estimator);
        chosen.find(|c| c["clearance_mm"] == 0.5 && c["load_kn"] == 10.0).unwrap()
    };
    for world in ["exact", "draw-1", "clearance+", "mass-", "drive-lag"] {
        let (network, law) = (of(world, "network"), of(world, "law"));
        assert_eq!(number(network, "/full_scale_n"), number(law, "/full_scale_n"), "{world}");
        assert!(number(network, "/rms_n") < number(network, "/max_n"), "{network}");
        assert!((0.0..=1.0).contains(&number(network, "/inside_2sd")), "{network}");
        assert!((0.0..=1.0).contains(&number(network, "/torque_inside_2sd")), "{network}");
        assert!(number(network, "/torque_rms_nm") < number(network, "/torque_full_scale_nm"), "{network}");
        let both = [network, law].map(|case| number(case, "/rms_n"));
        assert!((both[0] / both[1] - 1.0).abs() < 0.5, "{world}: {both:?}");
    }
    assert_golden(cases);
    // The described world is the bench of the physics: 6241 N along Y with friction.
    let full_scale = number(of("exact", "network"), "/full_scale_n");
    assert!((full_scale / 6258.0 - 1.0).abs() < 0.01, "{full_scale}");
    let with_drive_force = number(of("draw-1", "law with drive force"), "/rms_n");
    assert!(with_drive_force < number(of("draw-1", "law"), "/rms_n"));
    for name in ["worlds.json", "worlds.html", "world-force.svg", "worlds-every.svg"] {
        assert!(directory.path().join("worlds").join(name).metadata().unwrap().len() > 1000, "{name}");
    }
}
