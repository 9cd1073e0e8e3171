//! `host-sim accuracy` as a user meets it: figures, verdicts, files, exit codes.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use serde_json::Value;
use std::process::Command;

fn number(value: &Value, path: &str) -> f64 {
    value.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} in {value}"))
}

#[test]
fn every_clearance_and_load_is_judged_and_a_goal_not_met_is_no_failure() {
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
        assert_eq!(number(run, "/gap/estimator_n"), 0.0, "{run}");
        assert!(number(run, "/gap/samples") > 10_000.0);
        // On the same signals float and quantised networks are close; noise makes every estimate worse.
        let force = |of: &str| number(run, &format!("/estimate/{of}/force_rms_n"));
        assert!((force("network") / force("float_network") - 1.0).abs() < 0.1, "{run}");
        assert!(force("perfect_sensors") < force("network"), "{run}");
        // Where the step is small the held law is the law.
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
