//! `describe`, `check` and `evaluate`: from a foreign log to a judged description; bad input.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Output};

fn host_sim(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_host-sim")).current_dir(directory).args(arguments).output().unwrap()
}

fn printed(directory: &Path, arguments: &[&str]) -> String {
    let output = host_sim(directory, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn json(directory: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&printed(directory, &[arguments, &["--json"]].concat())).unwrap()
}

fn refused(directory: &Path, arguments: &[&str]) -> String {
    let output = host_sim(directory, arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// A log of 12 kg on a sine of 20 mm and 2 s against 5 N of dry friction, as a German logger writes
/// it.
fn write_foreign_log(directory: &Path) {
    let mut text = String::from("Zeit [ms];Weg [mm];Kraft [N]\n");
    for i in 0..1200 {
        let (t, w) = (f64::from(i) * 0.01, core::f64::consts::PI);
        let (x, v) = (0.02 * (w * t).sin(), 0.02 * w * (w * t).cos());
        let ripple = 0.02 * (f64::from(i * 7919 % 101) / 50.0 - 1.0);
        let force = 5.0 * (v / 6e-4).tanh() - 12.0 * w * w * x + ripple;
        writeln!(text, "{:.1};{:.5};{force:.4}", 1e3 * t, 1e3 * x).unwrap();
    }
    std::fs::write(directory.join("log.csv"), text.replace('.', ",")).unwrap();
}

#[test]
fn a_template_that_is_filled_in_is_checked_and_evaluated() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    write_foreign_log(here);
    let described = json(here, &["describe", "log.csv", "--out", "bench.toml"]);
    assert_eq!(described["to_fill_in"], serde_json::json!(["axis.inertia"]));
    assert_eq!(described["columns"][1]["signal"], "position_m");
    let open = refused(here, &["check", "log.csv", "--bench", "bench.toml"]);
    assert!(open.contains("axis.inertia is not filled in; expected a number, 0 to 1e9 kg"), "{open}");

    let template = std::fs::read_to_string(here.join("bench.toml")).unwrap();
    let filled = template.replace("inertia = \"?\"", "inertia = 12.0").replace(
        "# \"axis.coulomb_effort\" = 0.05",
        "\"axis.coulomb_effort\" = 2.0\n\"axis.load_gain\" = 0.1",
    );
    std::fs::write(here.join("bench.toml"), &filled).unwrap();
    let checked = json(here, &["check", "log.csv", "--bench", "bench.toml", "--out", "checked"]);
    let parameter = |name: &str| {
        let all = checked["parameters"].as_array().unwrap();
        all.iter().find(|p| p["name"] == name).unwrap().clone()
    };
    assert_eq!(parameter("axis.coulomb_effort")["is_determined"], true, "{checked}");
    assert_eq!(parameter("axis.load_gain")["is_determined"], false, "{checked}");
    assert_eq!(checked["not_determined"][0]["parameters"], serde_json::json!(["axis.load_gain"]));
    assert!(checked["logs"][0]["cycles"].as_f64().is_some_and(|cycles| (cycles - 6.0).abs() < 0.1));
    assert!(here.join("checked/check.json").exists());

    let error = |bench: &str| {
        let evaluated = json(here, &["evaluate", "log.csv", "--bench", bench]);
        assert_eq!(evaluated["channels"][0]["channel"], "drive_force_n");
        assert!(evaluated["channels"][0]["noise_rms"].as_f64().is_some_and(|noise| noise < 0.1));
        evaluated["channels"][0]["rms"].as_f64().unwrap()
    };
    // Without the friction its level is the error; with it little more than noise.
    assert!((error("bench.toml") - 5.0).abs() < 0.3, "{}", error("bench.toml"));
    std::fs::write(here.join("better.toml"), filled.replace("coulomb_effort = 0.0", "coulomb_effort = 5.0"))
        .unwrap();
    assert!(error("better.toml") < 0.3, "{}", error("better.toml"));
    assert!(!here.join("out").exists(), "nothing is written without --out");
}

#[test]
fn a_report_is_written_where_it_is_asked_for() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    printed(here, &["record", "--cycles", "1", "--seed", "3", "--out", "log.csv"]);
    let text = printed(here, &["evaluate", "log.csv", "--out", "e"]);
    assert!(text.contains("nothing was fitted") && text.contains("journal_y_m"), "{text}");
    let page = std::fs::read_to_string(here.join("e/report.html")).unwrap();
    assert!(page.matches("<svg").count() >= 16 && page.contains("What the model leaves out"));
    assert!(page.contains("default-src 'none'"), "the page fetches nothing");
    for link in [" src=", " href=", "@import"] {
        assert!(!page.contains(link), "{link}");
    }
    let written: Value =
        serde_json::from_str(&std::fs::read_to_string(here.join("e/evaluation.json")).unwrap()).unwrap();
    for channel in written["channels"].as_array().unwrap() {
        let ratio = channel["rms"].as_f64().unwrap() / channel["noise_rms"].as_f64().unwrap();
        assert!((0.9..1.1).contains(&ratio), "{channel}");
    }
    let checked = printed(here, &["check", "log.csv"]);
    assert!(checked.contains("findings: 0 wrong, 0 doubtful"), "{checked}");
    assert!(checked.contains("shaft.inertia_kg_m2"), "{checked}");
}

#[test]
fn bad_input_exits_with_2_and_says_what_was_expected() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    write_foreign_log(here);
    std::fs::write(here.join("words.csv"), "hello world\nno numbers here\n").unwrap();
    std::fs::write(here.join("inputs.csv"), "t_s,position_m\n0,0\n0.1,1\n0.2,0\n").unwrap();
    std::fs::write(
        here.join("flawed.toml"),
        "plant = \"friction-rig\"\n[axis]\nkind = \"square\"\ninertia = -1\n\
         [load]\nforce_n = 0.0\nramp = 1.0\n",
    )
    .unwrap();
    for (arguments, expected) in [
        (&["describe", "nothing.csv"][..], "nothing.csv: "),
        (&["describe", "words.csv"], "no columns of numbers with one separator"),
        (&["describe", "log.csv", "--out", "log.csv"], "log.csv exists; expected a new file"),
        (&["describe", "log.csv", "--plant", "boat"], "possible values"),
        (&["check", "log.csv", "--bench", "friction-rig"], "no column `t_s` among `Zeit [ms]`,"),
        (&["check", "nothing.csv"], "nothing.csv: "),
        (&["check"], "<LOG>"),
        (&["evaluate", "inputs.csv", "--bench", "slider-crank"], "found plant `slider-crank`"),
        (&["evaluate", "inputs.csv"], "inputs.csv: no "),
    ] {
        let message = refused(here, arguments);
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
    let message = refused(here, &["evaluate", "log.csv", "--bench", "flawed.toml"]);
    for expected in [
        "flawed.toml: 13 entries are wrong or missing",
        "line 3: axis.kind is `square`; expected one of rotary, linear",
        "line 4: axis.inertia is -1; expected 0 to 1e9 kg or kg m2",
        "line 2: axis.regularisation_m_s is missing; expected a number, 1e-12 to 1000 m/s",
        "line 2: axis.friction_radius_m is missing; expected a number, 1e-6 to 1000 m",
        "line 7: load.ramp is an unknown field; expected one of force_n, ramp_s",
        "logging is missing; expected `[logging]` with sample_rate_hz",
    ] {
        assert!(message.contains(expected), "{expected}\n{message}");
    }
}

#[test]
fn every_command_for_logs_has_help_with_examples() {
    let directory = tempfile::tempdir().unwrap();
    for command in ["describe", "check", "evaluate"] {
        let help = printed(directory.path(), &[command, "--help"]);
        assert!(help.contains(&format!("Examples:\n  host-sim {command} ")), "{help}");
        assert!(help.contains("--json") && help.contains("--out"), "{help}");
    }
}

#[test]
fn an_output_folder_that_cannot_be_written_exits_with_1_before_the_work() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    printed(here, &["record", "--cycles", "1", "--out", "log.csv"]);
    std::fs::write(here.join("taken"), "a file, not a folder").unwrap();
    for command in ["check", "evaluate"] {
        let output = host_sim(here, &[command, "log.csv", "--out", "taken"]);
        assert_eq!(output.status.code(), Some(1), "{command}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("taken"), "{command}");
    }
    let output = host_sim(here, &["describe", "log.csv", "--out", "taken/bench.toml"]);
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
}
