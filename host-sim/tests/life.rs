//! `host-sim life`: its files, its effect, its errors.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn host_sim(folder: &Path, arguments: &str) -> Output {
    let arguments: Vec<&str> = arguments.split(' ').collect();
    Command::new(env!("CARGO_BIN_EXE_host-sim")).current_dir(folder).args(arguments).output().unwrap()
}

#[test]
fn a_life_is_predicted_tracked_and_written_as_an_effect_with_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let life = |threads: &str| {
        let output = host_sim(
            folder.path(),
            &format!("life --bearing plastic --cycles 1e5 --threads {threads} --out {threads} --json"),
        );
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    let (one, two) = (life("1"), life("2"));
    assert_eq!(one, two);
    let result: Value = serde_json::from_slice(&one).unwrap();
    let number = |name: &str| result[name].as_f64().unwrap();
    let [low, high] = [0, 1].map(|i| result["clearance_ci95_m"][i].as_f64().unwrap());
    assert!(5e-4 < low && low < number("clearance_m") && number("clearance_m") < high, "{low} {high}");
    for tracked in result["tracked"].as_array().unwrap() {
        let [predicted, found, sd] =
            ["predicted_m", "clearance_m", "clearance_sd_m"].map(|name| tracked[name].as_f64().unwrap());
        assert!((found - predicted).abs() < 4.0 * sd && sd < 5e-6, "{tracked}");
    }
    for name in ["life.csv", "profile.csv", "tracked.csv", "report.html", "clearance.svg"] {
        let [a, b] = ["1", "2"].map(|threads| std::fs::read(folder.path().join(threads).join(name)).unwrap());
        assert!(a == b && !a.is_empty(), "{name}");
    }
    let record = host_sim(folder.path(), "record --bench 1/worn-bench.toml --out worn.csv --json");
    assert!(record.status.success(), "{}", String::from_utf8_lossy(&record.stderr));
    let worn = bench::Bench::open(folder.path().join("1/worn-bench.toml").to_str().unwrap()).unwrap();
    let clearance_m = worn.resolved().transmission().unwrap().bearing.radial_clearance_m;
    assert!((clearance_m - number("clearance_m")).abs() < 1e-12, "{clearance_m}");
}

#[test]
fn a_life_that_the_controller_cannot_track_keeps_its_result() {
    let folder = tempfile::tempdir().unwrap();
    let output = host_sim(folder.path(), "life --clearance-mm 3 --cycles 3 --out o --json");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    let tracked = result["tracked"].as_array().unwrap();
    assert!(tracked.len() == 6 && tracked.iter().all(|t| t["clearance_m"].is_null()), "{tracked:?}");
    let page = std::fs::read_to_string(folder.path().join("o/report.html")).unwrap();
    assert!(page.contains("not tracked"));
}

#[test]
fn a_change_outside_the_range_of_the_effect_is_said_and_gives_no_bench() {
    let folder = tempfile::tempdir().unwrap();
    let (_, text) = bench::PRESETS[0];
    let text = text.replace("[logging]", "[thermal]\nswelling = 0.055\n[logging]");
    std::fs::write(folder.path().join("b.toml"), text).unwrap();
    let output = host_sim(
        folder.path(),
        "life --bench b.toml --bearing plastic --clearance-mm 0.6 --cycles 3 --out o",
    );
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).contains("worn-bench.toml is not written"));
    let page = std::fs::read_to_string(folder.path().join("o/report.html")).unwrap();
    assert!(
        page.contains("worn-bench.toml is not written") && !folder.path().join("o/worn-bench.toml").exists()
    );
}

#[test]
fn a_life_that_cannot_be_is_refused_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, field) in [
        ("life --cycles 0", "life.cycles is 0; expected 1 to"),
        ("life --bench friction-rig", "friction-rig"),
        ("life --clearance-mm -1", "bearing.radial_clearance_m"),
    ] {
        let output = host_sim(folder.path(), arguments);
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && error.contains(field), "{arguments}: {error}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
