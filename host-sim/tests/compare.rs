//! `host-sim compare` on real runs, and the origin in results and pages.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn host_sim(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_host-sim")).current_dir(folder).args(arguments).output().unwrap()
}

fn done(folder: &Path, arguments: &[&str]) -> Output {
    let output = host_sim(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

fn row<'a>(comparison: &'a Value, list: &str, name: &str) -> &'a Value {
    comparison[list].as_array().unwrap().iter().find(|row| row["name"] == name).unwrap()
}

#[test]
fn two_clearances_differ_and_a_run_equals_itself() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    for (out, clearance) in [("a", "0.5"), ("b", "0.6")] {
        done(here, &["run", "--controller", "none", "--clearance-mm", clearance, "--out", out]);
    }
    let printed = done(here, &["compare", "a", "b", "a", "--out", "c", "--json"]).stdout;
    let found: Value = serde_json::from_slice(&printed).unwrap();
    assert_eq!(found, serde_json::from_str::<Value>(&read(&here.join("c/comparison.json"))).unwrap());
    let clearance = &row(&found, "figures", "clearance_mm")["differences"];
    assert!((clearance[1].as_f64().unwrap() - 0.1).abs() < 1e-12 && clearance[2] == 0.0);
    let peaks =
        [0, 1].map(|run| row(&found, "figures", "peak_contact_force_n")["values"][run].as_f64().unwrap());
    assert!((peaks[0] - 11710.0).abs() < 100.0 && peaks[1] > peaks[0] + 100.0, "{peaks:?}");
    let force = &row(&found, "columns", "bearing_force_y_n")["differences"];
    assert!(force[1]["rms"].as_f64().unwrap() > 100.0 && force[2]["max"] == 0.0, "{force}");
    assert!(!found.to_string().contains("wall_s"), "times of the machine are no results");
    let page = read(&here.join("c/report.html"));
    assert!(page.contains("bearing force y: difference from the first run"));
    assert!(!page.contains("drive displacement: difference"), "equal columns have none");
}

#[test]
fn contacts_and_laws_of_mechanisms_are_compared() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/slider-crank-mechanism.toml");
    let text = read(Path::new(example));
    for (name, restitution) in [("a", "0.9"), ("b", "0.5")] {
        let changed = text.replace("restitution = 0.9", &format!("restitution = {restitution}"));
        assert!(name == "a" || changed != text);
        std::fs::write(here.join("my.toml"), changed).unwrap();
        done(here, &["run", "--bench", "my.toml", "--out", name]);
    }
    let printed = done(here, &["compare", "a", "b", "--json"]).stdout;
    let found: Value = serde_json::from_slice(&printed).unwrap();
    let figures = found["figures"].as_array().unwrap();
    let peak = figures.iter().find(|row| row["name"].as_str().unwrap().ends_with(".peak_force_n")).unwrap();
    assert!(peak["differences"][1].as_f64().unwrap().abs() > 100.0, "{peak}");
    let inputs = found["provenance"]["inputs"].as_array().unwrap();
    let paths: Vec<&str> = inputs.iter().map(|input| input["path"].as_str().unwrap()).collect();
    assert_eq!(paths, ["a/run.json", "a/log.csv", "b/run.json", "b/log.csv"]);
}

#[test]
fn a_wrong_day_of_reports_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for text in ["abc", "-5", "99999999999999999"] {
        let output = Command::new(env!("CARGO_BIN_EXE_host-sim"))
            .current_dir(folder.path())
            .env("SOURCE_DATE_EPOCH", text)
            .args(["run", "--controller", "none"])
            .output()
            .unwrap();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(&format!("SOURCE_DATE_EPOCH: found {text:?}; expected")), "{message}");
        assert!(!folder.path().join("out").exists());
    }
}

#[test]
fn results_and_pages_state_their_origin() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/four-bar.toml");
    std::fs::copy(example, here.join("my.toml")).unwrap();
    done(here, &["run", "--bench", "my.toml", "--out", "r"]);
    let run: Value = serde_json::from_str(&read(&here.join("r/run.json"))).unwrap();
    let origin = &run["provenance"];
    assert_eq!(origin["command"], "host-sim run --bench my.toml");
    assert_eq!(origin["inputs"][0]["path"], "my.toml");
    assert_eq!(origin["inputs"][0]["sha256"].as_str().unwrap().len(), 64);
    let page = read(&here.join("r/report.html"));
    assert!(page.contains("host-sim run --bench my.toml") && page.contains(origin["date"].as_str().unwrap()));
}

#[test]
fn wrong_folders_exit_with_2_and_say_what_was_expected() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    done(here, &["run", "--controller", "none", "--out", "a"]);
    std::fs::create_dir(here.join("empty")).unwrap();
    std::fs::create_dir(here.join("broken")).unwrap();
    std::fs::create_dir(here.join("list")).unwrap();
    std::fs::write(here.join("list/run.json"), "[1, 2]").unwrap();
    std::fs::write(here.join("broken/run.json"), "{\"peak_n\": 1}").unwrap();
    std::fs::write(here.join("broken/log.csv"), "t_s,force_n\n0,1\n1,x\n").unwrap();
    for (arguments, expected) in [
        (vec!["compare", "a"], "2 values required"),
        (vec!["compare", "a", "empty"], "empty/run.json: cannot be read"),
        (vec!["compare", "a", "list"], "list/run.json: found no object"),
        (vec!["compare", "a", "a", "--out", "a"], "--out: found a, one of the runs"),
        (vec!["compare", "a", "broken"], "broken/log.csv: line 3, force_n: found \"x\"; expected a number"),
    ] {
        let output = host_sim(here, &arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(expected), "{message}");
    }
}
