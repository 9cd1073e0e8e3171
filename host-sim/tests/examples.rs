//! Every file in `examples/` works as its head describes.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples")
}

fn host_sim(directory: &Path, arguments: &[&str]) -> Value {
    let output =
        Command::new(env!("CARGO_BIN_EXE_host-sim")).current_dir(directory).args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Bench descriptions among the examples.
fn benches() -> Vec<(String, String)> {
    let mut out: Vec<(String, String)> = std::fs::read_dir(examples())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .map(|path| (path.display().to_string(), std::fs::read_to_string(&path).unwrap()))
        .filter(|(_, text)| text.lines().any(|line| line.starts_with("plant = ")))
        .collect();
    out.sort();
    assert!(out.len() >= 6, "{} benches among the examples", out.len());
    out
}

#[test]
fn every_bench_runs_or_is_recorded() {
    let directory = tempfile::tempdir().unwrap();
    for (path, text) in benches() {
        if text.contains("plant = \"transmission-bench\"") {
            let run = host_sim(
                directory.path(),
                &["run", "--bench", &path, "--force", "law", "--controller", "none", "--json"],
            );
            assert!(run["peak_contact_force_n"].as_f64().is_some_and(|f| f > 1e3), "{path}");
        }
        if text.contains("plant = \"mechanism\"") {
            let run = host_sim(directory.path(), &["run", "--bench", &path, "--json"]);
            assert!(run["energy_residual_rel"].as_f64().is_some_and(|rel| rel < 1e-6), "{path} {run}");
            for contact in run["contacts"].as_array().unwrap() {
                let [peak, bar] = ["peak_force_n", "error_bar_n"].map(|name| contact[name].as_f64().unwrap());
                assert!(peak > 100.0 && bar < 1e-3 * peak, "{path} {contact}");
            }
            let rows = |name: &str| {
                let text = std::fs::read_to_string(directory.path().join("out/run").join(name)).unwrap();
                let widths: Vec<usize> = text.lines().map(|line| line.split(',').count()).collect();
                assert!(widths.iter().all(|width| *width == widths[0]), "{path} {name}");
                widths.len()
            };
            let samples = text.split_once("samples = ").map_or(4000, |(_, rest)| {
                rest.split(|c: char| !c.is_ascii_digit()).next().unwrap().parse().unwrap()
            });
            assert!(rows("log.csv") == samples + 1 && rows("impacts.csv") > 1, "{path}");
            let page = std::fs::read_to_string(directory.path().join("out/run/report.html")).unwrap();
            assert!(page.contains("Energy balance"), "{path}");
            for part in ["data-frames", "<button", "type=\"range\"", "prefers-reduced-motion"] {
                assert!(page.contains(part), "{path} {part}");
            }
            let drawn = page.split("<script").next().unwrap();
            assert!(!drawn.contains("NaN") && !drawn.contains("src="), "{path}");
            continue;
        }
        for name in ["log.csv", "log.parquet", "log.mat"] {
            let written = host_sim(directory.path(), &["record", "--bench", &path, "--out", name, "--json"]);
            assert!(written["samples"].as_u64().is_some_and(|n| n >= 100), "{path} {name}");
        }
    }
}

#[test]
fn the_servo_axis_is_diagnosed_from_a_mat_file_and_from_parquet() {
    let directory = tempfile::tempdir().unwrap();
    let bench = examples().join("servo-axis.toml").display().to_string();
    for log in ["logs/servo-axis.mat", "logs/servo-axis.parquet"] {
        let log = examples().join(log).display().to_string();
        let diagnosis = host_sim(directory.path(), &["diagnose", &log, "--bench", &bench, "--json"]);
        assert_eq!(diagnosis["verdict"], "named", "{diagnosis}");
        assert_eq!(diagnosis["causes"][0]["effect"], "viscous-friction");
        let value = diagnosis["causes"][0]["parameters"][0]["value"].as_f64().unwrap();
        assert!((value / 2.0 - 1.0).abs() < 0.1, "{value}");
        assert!(
            diagnosis["checks"].as_array().unwrap().iter().all(|f| f["severity"] != "wrong"),
            "{diagnosis}"
        );
    }
}

#[test]
fn the_sticking_rig_is_recorded_and_diagnosed() {
    let directory = tempfile::tempdir().unwrap();
    let bench = examples().join("sticking-rig.toml").display().to_string();
    host_sim(directory.path(), &["record", "--bench", &bench, "--seed", "3", "--out", "log.mat", "--json"]);
    let diagnosis = host_sim(directory.path(), &["diagnose", "log.mat", "--bench", "friction-rig", "--json"]);
    let causes: Vec<&str> =
        diagnosis["causes"].as_array().unwrap().iter().filter_map(|c| c["effect"].as_str()).collect();
    assert!(causes.contains(&"position-ripple"), "{diagnosis}");
    // On a sine of one speed the catalogue calls these two confounded: in both cases friction falls
    // after each reversal.
    assert!(causes.contains(&"stribeck-friction") || causes.contains(&"breakaway"), "{diagnosis}");
}

#[test]
fn a_mechanism_takes_forces_from_networks_and_its_record_is_diagnosed() {
    let directory = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(examples().join("bench-b-mechanism.toml")).unwrap();
    let text = text
        .replace("duration_s = 1.0", "duration_s = 0.1, samples = 500")
        .replace("name = \"babbitt\"", "name = \"babbitt\"\nnetwork = \"babbitt\"")
        + "[[measured]]\nchannel = \"journal_z_m\"\nof = \"ground_shaft\"\n\
           [sensors.journal_z_m]\nnoise = 1e-6\n";
    std::fs::write(directory.path().join("b.toml"), text).unwrap();
    let net = host_sim(directory.path(), &["run", "--bench", "b.toml", "--json"]);
    let law = host_sim(directory.path(), &["run", "--bench", "b.toml", "--force", "law", "--json"]);
    assert_eq!((&net["force"], &law["force"]), (&"quantised-net".into(), &"law".into()));
    let [found, known] = [&net, &law].map(|run| run["contacts"][0]["peak_force_n"].as_f64().unwrap());
    assert!(found != known && (found / known - 1.0).abs() < 0.1, "{found} {known}");
    assert!(net["networks"]["outside_training_share"].as_f64().is_some_and(|share| share < 0.2), "{net}");
    assert!(net["energy_residual_rel"].as_f64().is_some_and(|rel| rel < 1e-6), "{net}");
    let record = |seed: &str| {
        let written = host_sim(directory.path(), &["record", "--bench", "b.toml", "--seed", seed, "--json"]);
        assert_eq!((&written["samples"], &written["channels"]), (&500.into(), &["journal_z_m"][..].into()));
        std::fs::read(directory.path().join("out/record/log.csv")).unwrap()
    };
    let first = record("7");
    assert!(first == record("7") && first != record("8"));
    let log = "out/record/log.csv";
    let evaluated = host_sim(directory.path(), &["evaluate", log, "--bench", "b.toml", "--json"]);
    let rms = evaluated["channels"][0]["rms"].as_f64().unwrap();
    assert!((0.8e-6..1.2e-6).contains(&rms), "{evaluated}");
    let diagnosis = host_sim(directory.path(), &["diagnose", log, "--bench", "b.toml", "--json"]);
    assert_eq!(diagnosis["verdict"], "none", "{diagnosis}");
}
