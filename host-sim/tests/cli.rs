//! The command line: exit codes, messages, files, stable names.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use std::path::Path;
use std::process::{Command, Output};

fn host_sim(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_host-sim")).current_dir(directory).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(output: &Output) -> serde_json::Value {
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn wrong_input_exits_with_2_names_the_field_and_leaves_no_files() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(
        directory.path().join("broken.toml"),
        "plant = \"transmission-bench\"\n[geometry]\nlever = 3\n",
    )
    .unwrap();
    let (_, bench_b) = bench::PRESETS[0];
    let sticking = bench_b.replace("\n[drive]", "law = \"coulomb\"\n\n[drive]");
    std::fs::write(directory.path().join("sticking.toml"), sticking).unwrap();
    for (arguments, expected) in [
        (
            &["run", "--bench", "sticking.toml", "--force", "held-law"][..],
            "found held-law on a bench whose friction",
        ),
        (&["run", "--clearance-mm", "-1"][..], "bearing.radial_clearance_m is -0.001; expected"),
        (&["run", "--clearance-mm", "9"], "bearing.radial_clearance_m"),
        (&["run", "--load-kn", "nan"], "load.force_n is NaN; expected"),
        (&["run", "--cycles", "0"], "drive.cycles is 0; expected"),
        (&["run", "--bench", "no-such.toml"], "neither a preset"),
        (&["run", "--bench", "broken.toml"], "broken.toml"),
        (&["run", "--bench", "friction-rig"], "expected `transmission-bench`"),
        (&["run", "--bench", "slider-crank", "--load-kn", "1"], "--load-kn: found plant `slider-crank`"),
        (&["run", "--bench", "slider-crank", "--record", "a.rec"], "--record: found plant `slider-crank`"),
        (&["run", "--bench", "slider-crank", "--seed", "7"], "--seed: found plant `slider-crank`"),
        (&["run", "--bench", "slider-crank", "--force", "float-net"], "--force: found plant `slider-crank`"),
        (&["record", "--bench", "slider-crank"], "found plant `slider-crank`"),
        (
            &["record", "--bench", "four-bar"],
            "found plant `mechanism`, which only `run` takes; expected a mechanism with",
        ),
        (&["run", "--bench", "four-bar", "--record", "a.rec"], "--record: found plant `mechanism`"),
        (
            &["run", "--bench", "four-bar", "--seed", "2"],
            "--seed: found plant `mechanism`; expected `record`",
        ),
        (&["run", "--bench", "four-bar", "--controller", "none"], "--controller: found plant `mechanism`"),
        (&["run", "--bench", "four-bar", "--step-us", "5"], "--step-us: found plant `mechanism`; expected a"),
        (&["run", "--bench", "four-bar", "--force", "float-net"], "--force: found float-net on a mechanism"),
        (&["run", "--cycles", "4000000000"], "drive.cycles is 4e9; expected 1 to 1000000"),
        (&["run", "--cycles", "5000"], "expected a run of at most 2000 s"),
        (&["run", "--step-us", "0"], "--step-us: found 0; expected"),
        (&["run", "--force", "wishes"], "possible values"),
        (&["run", "--dropout-share", "1"], "--dropout-share: found 1; expected 0 to 0.9"),
        (&["run", "--dropout-share", "-0.1"], "--dropout-share: found -0.1; expected"),
        (&["run", "--controller", "attached"], "--port <PATH>|--probe [<PROBE>]"),
        (&["link", "--controller", "attached"], "--port <PATH>|--probe [<PROBE>]"),
        (&["link", "--controller", "attached", "--port", "a", "--probe"], "cannot be used with"),
        (&["link", "--controller", "attached", "--probe", "st-link"], "expected VID:PID or VID:PID:SERIAL"),
        (&["link", "--controller", "attached", "--probe", "--board", "a"], "expected one of stm32f405"),
        (&["run", "--dropout-samples", "1.5"], "--dropout-samples: found 1.5; expected an integer"),
        (&["export-fmu", "bench", "--bench", "friction-rig"], "expected `transmission-bench`"),
        (&["export-fmu", "mechanism"], "plant: found `transmission-bench`; expected `mechanism`"),
        (&["export-fmu", "contact", "--bench", "sticking.toml"], "friction.law: found one that sticks"),
        (&["export-fmu", "bench", "--libraries", "none"], "none: found none of linux64/pintle_fmu.so"),
        (&["export-fmu", "bench", "--image", "broken.toml"], "broken.toml: "),
        (&["run", "--plant-fmu", "broken.toml"], "broken.toml: found no ZIP archive"),
        (&["run", "--plant-output", "journal_y_m=y"], "--plant-fmu <FILE>"),
        (&["run", "--bench", "four-bar", "--plant-fmu", "a.fmu"], "--plant-fmu: found plant `mechanism`"),
    ] {
        let output = host_sim(directory.path(), arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(expected), "{arguments:?}: {message}");
        assert!(!directory.path().join("out").exists(), "{arguments:?} left output");
    }
}

#[test]
#[cfg(not(feature = "probe"))]
fn a_build_without_probe_support_names_the_feature_to_build_with() {
    let directory = tempfile::tempdir().unwrap();
    for arguments in [
        &["link", "--controller", "attached", "--probe"][..],
        &["update", "--status", "--controller", "attached", "--probe"],
    ] {
        let output = host_sim(directory.path(), arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(
            message.contains("no support for probes") && message.contains("--features probe"),
            "{message}"
        );
    }
}

#[test]
fn an_output_that_cannot_be_written_exits_with_1() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("taken"), "a file, not a folder").unwrap();
    // Long runs are refused before their work, or this test would take minutes.
    for arguments in [
        &["run", "--force", "law", "--controller", "none", "--out", "taken"][..],
        &["accuracy", "--out", "taken"],
        &["figures", "--out", "taken"],
        &["claims", "--out", "taken"],
        &["sweep", "latch", "--out", "taken"],
        &["sweep", "step", "--out", "taken"],
    ] {
        let output = host_sim(directory.path(), arguments);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {}", text(&output.stderr));
        assert!(text(&output.stderr).contains("taken"), "{arguments:?}: {}", text(&output.stderr));
    }
}

#[test]
fn a_run_follows_the_law_and_its_estimator_follows_the_bench() {
    let directory = tempfile::tempdir().unwrap();
    let run = json(&host_sim(directory.path(), &["run", "--json"]));
    let number = |name: &str| {
        run.pointer(name).and_then(serde_json::Value::as_f64).unwrap_or_else(|| panic!("{name} in {run}"))
    };
    let law = number("/against_law/peak_contact_force_n");
    assert!((law / 11755.0 - 1.0).abs() < 1e-3, "{law}");
    assert!((number("/peak_contact_force_n") / law - 1.0).abs() < 0.03);
    assert!(number("/against_law/force_rms_difference_n") < 0.01 * law);
    assert!(number("/outside_training_share") < 0.01);
    assert!(number("/energy_residual_rel") < 1e-6);
    assert_eq!(number("/estimator/ticks"), 10_000.0);
    assert!(number("/estimator/force_rms_error_n") < 0.05 * number("/estimator/force_full_scale_n"));
    for name in [
        "peak_force_y_n",
        "peak_force_z_n",
        "peak_friction_torque_nm",
        "max_deformation_m",
        "oscillation_rms_n",
        "contacts",
    ] {
        assert!(run.get(name).is_some(), "{name} in {run}");
    }
    assert!((number("/communication_step_s") - 1e-5).abs() < 1e-18 && run["tolerance"].is_null(), "{run}");
    // One cycle of bench B lasts a second.
    assert!(number("/wall_s") > 0.0 && number("/wall_s") == number("/wall_s_per_simulated_s"));
    let time_s = run.pointer("/peaks/0/time_s").and_then(serde_json::Value::as_f64).unwrap();
    assert_eq!(number("/peak_times_s/peak_contact_force_n"), time_s);
    let report = std::fs::read_to_string(directory.path().join("out/run/report.html")).unwrap();
    assert!(report.matches("<svg").count() >= 6 && report.contains("Orbit"));
    assert!(number("/energy/friction_heat_j") > 0.0 && number("/energy/residual_rel") < 1e-6);
    let peaks = run.get("law_peaks").and_then(serde_json::Value::as_array).unwrap();
    let first = |field: &str| peaks[0].get(field).and_then(serde_json::Value::as_f64).unwrap();
    assert_eq!(peaks[0].get("name").and_then(serde_json::Value::as_str), Some("peak_contact_force_n"));
    assert!((first("value") - law).abs() < 1.0 && first("error_bar") < 0.1, "{peaks:?}");
    let own = run.pointer("/peaks/0/error_bar").and_then(serde_json::Value::as_f64).unwrap();
    assert!(own > 0.0 && own < 0.01 * law, "{own}");
    assert_eq!(number("/error_bars/peak_contact_force_n"), own);
    for section in ["Peaks", "Energy", "Contacts", "What the model leaves out"] {
        assert!(report.contains(section), "{section}");
    }
    let impacts = std::fs::read_to_string(directory.path().join("out/run/impacts.csv")).unwrap();
    assert!(impacts.starts_with("contact,onset_s,") && impacts.lines().count() == 2, "{impacts}");
    let log = std::fs::read_to_string(directory.path().join("out/run/log.csv")).unwrap();
    assert!(log.starts_with("t_s,drive_displacement_m,") && log.lines().count() == 1001);
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_does_not() {
    let directory = tempfile::tempdir().unwrap();
    let log = |name: &str, seed: &str| {
        let output =
            host_sim(directory.path(), &["run", "--controller", "none", "--seed", seed, "--out", name]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        std::fs::read(directory.path().join(name).join("log.csv")).unwrap()
    };
    let (a, b, c) = (log("a", "5"), log("b", "5"), log("c", "6"));
    assert_eq!(a, b);
    assert_ne!(a, c);
}

#[test]
fn missing_readings_are_reported_and_reduce_accuracy() {
    let directory = tempfile::tempdir().unwrap();
    let figures = |more: &[&str]| {
        let arguments = [&["run", "--force", "law", "--json"], more].concat();
        let run = json(&host_sim(directory.path(), &arguments));
        let number = |name: &str| run.pointer(&format!("/estimator/{name}")).unwrap().as_f64().unwrap();
        (number("suspect_share"), number("force_rms_error_n"))
    };
    let complete = figures(&[]);
    let gaps = figures(&["--dropout-share", "0.02", "--dropout-samples", "5"]);
    // Four channels with 2 % of gaps each, and the samples after every gap.
    assert!(gaps.0 > complete.0 + 0.05, "{complete:?}, {gaps:?}");
    assert!(gaps.1 > complete.1, "{complete:?}, {gaps:?}");
}

#[test]
fn an_exported_bench_is_the_plant_of_another_run() {
    let directory = tempfile::tempdir().unwrap();
    let exported = json(&host_sim(directory.path(), &["export-fmu", "bench", "--out", "b.fmu", "--json"]));
    assert_eq!((exported["unit"].as_str(), exported["fmi"].as_str()), (Some("bench"), Some("2.0")));
    assert!(exported["outputs"].as_array().unwrap().iter().any(|name| name == "journal_z_m"));
    let law = json(&host_sim(directory.path(), &["run", "--force", "law", "--json"]));
    let unit = json(&host_sim(
        directory.path(),
        &["run", "--plant-fmu", "b.fmu", "--force", "law", "--out", "unit", "--json"],
    ));
    let peak = |run: &serde_json::Value| run["peak_contact_force_n"].as_f64().unwrap();
    assert!((peak(&unit) / peak(&law) - 1.0).abs() < 0.02, "{} {}", peak(&unit), peak(&law));
    assert_eq!(unit["plant"]["inputs"], serde_json::json!([]));
    assert_eq!(unit["energy_residual_rel"], serde_json::Value::Null);
    let error = unit["estimator"]["force_rms_error_n"].as_f64().unwrap();
    assert!(error < 0.02 * peak(&unit), "{error}");
    let wrong = host_sim(
        directory.path(),
        &[
            "run",
            "--plant-fmu",
            "b.fmu",
            "--plant-output",
            "journal_y=1",
            "--plant-set",
            "x=1",
            "--out",
            "no",
        ],
    );
    let message = text(&wrong.stderr);
    assert_eq!(wrong.status.code(), Some(2), "{message}");
    assert!(message.contains("the quantity `journal_y`") && message.contains("--plant-set: found x=1"));
    assert!(!directory.path().join("no").exists());
    for (option, value, expected) in [
        ("--load-kn", "1", "--load-kn: found a load"),
        ("--plant-set", "drive.cycles=1.5", "--plant-set: found drive.cycles=1.5"),
        ("--plant-input", "force_y_n=journal_y_m", "an input of the unit: drive_m"),
    ] {
        let arguments = ["run", "--plant-fmu", "b.fmu", option, value, "--out", "no"];
        let wrong = host_sim(directory.path(), &arguments);
        let message = text(&wrong.stderr);
        assert!(wrong.status.code() == Some(2) && message.contains(expected), "{message}");
    }
}

#[test]
fn every_known_answer_holds() {
    let directory = tempfile::tempdir().unwrap();
    let printed = json(&host_sim(directory.path(), &["validate", "--json", "--out", "v"]));
    let cases = printed.get("cases").and_then(serde_json::Value::as_array).unwrap();
    assert!(cases.len() >= 100);
    for case in cases {
        for name in ["name", "value", "reference", "error", "tolerance"] {
            assert!(case.get(name).is_some(), "{name} in {case}");
        }
        assert_eq!(case.get("ok"), Some(&serde_json::Value::Bool(true)), "{case}");
    }
    let written = std::fs::read_to_string(directory.path().join("v/validate.json")).unwrap();
    assert_eq!(serde_json::from_str::<serde_json::Value>(&written).unwrap(), printed);
}

#[test]
fn a_tilted_bearing_shows_its_edge_load_and_every_peak_its_bar() {
    let directory = tempfile::tempdir().unwrap();
    let preset = include_str!("../../crates/bench/presets/bench-b.toml");
    let tilted =
        "[two_plane]\nslices = 5\nmisalignment_y_rad = 1e-3\nsupport_stiffness_nm_rad = 5e5\n[logging]";
    std::fs::write(directory.path().join("tilted.toml"), preset.replace("[logging]", tilted)).unwrap();
    let run = json(&host_sim(
        directory.path(),
        &["run", "--bench", "tilted.toml", "--force", "law", "--controller", "none", "--json"],
    ));
    let number = |name: &str| run.pointer(name).and_then(serde_json::Value::as_f64).unwrap();
    assert!(number("/tilt/largest_edge_ratio") > 1.1, "{run}");
    assert_eq!((number("/tolerance"), run["communication_step_s"].is_null()), (1e-7, true), "{run}");
    assert!(number("/error_bars/peak_contact_force_n") < 0.05 * number("/peak_contact_force_n"), "{run}");
    let read = |name: &str| std::fs::read_to_string(directory.path().join("out/run").join(name)).unwrap();
    let table = read("tilt.csv");
    assert!(table.starts_with("t_s,tilt_about_y_rad,") && table.lines().count() == 1001);
    assert!(table.lines().next().unwrap().ends_with(",line_load_5_n_m"));
    let report = read("report.html");
    assert!(report.contains("Line load along the bearing") && report.contains("Tilt of the shaft"));
}

#[test]
fn the_slider_cranks_peaks_have_bars_and_its_contacts_a_table() {
    let directory = tempfile::tempdir().unwrap();
    let run = json(&host_sim(directory.path(), &["run", "--bench", "slider-crank", "--json"]));
    let bars = run.get("error_bars_n").and_then(serde_json::Value::as_array).unwrap();
    assert_eq!(bars.len(), 20);
    assert!(bars[0].as_f64().unwrap() < 0.01, "{bars:?}");
    let number = |name: &str| run.get(name).and_then(serde_json::Value::as_f64).unwrap();
    let energy = |name: &str| run["energy"][name].as_f64().unwrap();
    assert!(energy("damping_loss_j") > 1.0 && energy("residual_rel") < 1e-6, "{run}");
    assert_eq!(energy("friction_heat_j"), 0.0, "the preset has no friction");
    // 0.6 revolutions at 5000 1/min.
    let per_second = number("wall_s") / (0.6 * 60.0 / 5000.0);
    assert_eq!(number("tolerance"), 1e-11);
    assert!((number("wall_s_per_simulated_s") / per_second - 1.0).abs() < 1e-9, "{run}");
    let impacts = std::fs::read_to_string(directory.path().join("out/run/impacts.csv")).unwrap();
    assert_eq!(impacts.lines().count(), 21);
}

#[test]
fn every_law_is_listed_with_range_and_source_and_its_name_is_one_of_a_description() {
    let directory = tempfile::tempdir().unwrap();
    let printed = json(&host_sim(directory.path(), &["laws", "--json"]));
    let laws = printed.get("laws").and_then(serde_json::Value::as_array).unwrap();
    let field = |law: &serde_json::Value, name: &str| law.get(name).unwrap().as_str().unwrap().to_owned();
    for law in laws {
        assert!(!field(law, "range").is_empty() && !field(law, "source").is_empty(), "{law}");
    }
    let has = |at: &str, name: &str| laws.iter().any(|l| field(l, "field") == at && field(l, "name") == name);
    assert!(has("contact.stiffness", "liu-times-length") && has("contact.dissipation", "zhiying-qishao"));
    assert!(has("contact.law", "adams-impact") && has("friction.law", "lugre"));
    let text = text(&host_sim(directory.path(), &["laws"]).stdout);
    assert!(text.contains("sticks and slides, on the planar transmission bench"), "{text}");
}

#[test]
fn every_command_has_help_with_an_example() {
    let directory = tempfile::tempdir().unwrap();
    for command in ["run", "record", "replay", "diagnose", "sweep", "figures", "claims", "validate"] {
        let output = host_sim(directory.path(), &[command, "--help"]);
        let help = text(&output.stdout);
        assert!(output.status.success() && help.contains(&format!("host-sim {command}")), "{help}");
        assert!(help.contains("--json") && help.contains("--out") && help.contains("Example"), "{help}");
    }
}

#[test]
fn a_closed_output_pipe_is_no_error() {
    let directory = tempfile::tempdir().unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .current_dir(directory.path())
        .args(["validate", "--json"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
}
