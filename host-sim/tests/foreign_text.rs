//! A log of a hydraulic cylinder as a German logger writes it: semicolons, decimal commas, a line
//! of units, and two pressures in place of a force.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Output};

/// Piston area in m2.
const AREA: f64 = 4.9e-4;

const BENCH: &str = r#"plant = "friction-rig"
[axis]
kind = "linear"
inertia = 120.0
friction_radius_m = 1.0
load_gain = 0.0
coulomb_effort = 0.0
viscous_effort = 0.0
load_coefficient = 0.0
regularisation_m_s = 6e-4
period_s = 2.0
amplitude = 0.02
[load]
force_n = 0.0
ramp_s = 0.05
[logging]
sample_rate_hz = 100.0
[sensors]
drive_force_n = { noise = 0.2 }
[columns]
t_s = "Zeit / 1000"
position_m = "Weg * 1e-3"
drive_force_n = "(`p A` - `p B`) * 1e5 * 4.9e-4"
"#;

fn host_sim(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_host-sim")).current_dir(directory).args(arguments).output().unwrap()
}

fn json(directory: &Path, arguments: &[&str]) -> Value {
    let output = host_sim(directory, &[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn refused(directory: &Path, arguments: &[&str]) -> String {
    let output = host_sim(directory, arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// Writes a log of 120 kg on a sine of 20 mm and 2 s against 50 N of dry friction.
fn write(directory: &Path) {
    let mut text = String::from("# logger 7\r\nZeit;Weg;p A;p B\r\nms;mm;bar;bar\r\n");
    for i in 0..1200 {
        let (t, w) = (f64::from(i) * 0.01, core::f64::consts::PI);
        let (x, v) = (0.02 * (w * t).sin(), 0.02 * w * (w * t).cos());
        let noise = 0.3 * (f64::from(i * 7919 % 101) / 50.0 - 1.0);
        let force = 50.0 * (v / 6e-4).tanh() - 120.0 * w * w * x + noise;
        let back = 20.0 + 0.5 * (0.7 * t).sin();
        let row = format!("{:.1};{:.5};{:.6};{back:.6}", 1e3 * t, 1e3 * x, back + force / (1e5 * AREA));
        write!(text, "{}\r\n", row.replace('.', ",")).unwrap();
    }
    std::fs::write(directory.join("log.csv"), text).unwrap();
}

#[test]
fn a_pressure_difference_is_checked_evaluated_and_diagnosed() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    write(here);
    std::fs::write(here.join("bench.toml"), BENCH).unwrap();
    let checked = json(here, &["check", "log.csv", "--bench", "bench.toml"]);
    let notes = |finding: &Value| finding["severity"] == "note";
    assert!(checked["checks"].as_array().unwrap().iter().all(notes), "{checked}");
    let error = |bench: &str| {
        let evaluated = json(here, &["evaluate", "log.csv", "--bench", bench]);
        assert_eq!(evaluated["channels"][0]["channel"], "drive_force_n");
        evaluated["channels"][0]["rms"].as_f64().unwrap()
    };
    assert!((error("bench.toml") - 50.0).abs() < 3.0, "{}", error("bench.toml"));
    // The extended bench keeps the expressions, and reads the log with them.
    let diagnosis = json(here, &["diagnose", "log.csv", "--bench", "bench.toml", "--out", "out"]);
    assert_eq!(diagnosis["verdict"], "named", "{diagnosis}");
    assert_eq!(diagnosis["causes"][0]["effect"], "coulomb-level");
    assert!(error("out/extended-bench.toml") < 1.0, "{}", error("out/extended-bench.toml"));

    // A wrong sign is corrected by a line with the same expression.
    let wrong =
        BENCH.replace("(`p A` - `p B`)", "(`p B` - `p A`)").replace("= 0.0\nviscous", "= 50.0\nviscous");
    std::fs::write(here.join("wrong.toml"), wrong).unwrap();
    let checked = json(here, &["check", "log.csv", "--bench", "wrong.toml"]).to_string();
    assert!(checked.contains("(`p B` - `p A`) * 1e5 * 4.9e-4\\\", scale = -1.0 }"), "{checked}");
}

#[test]
fn a_template_takes_the_units_from_the_line_under_the_header() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    write(here);
    let described = json(here, &["describe", "log.csv"]);
    let toml = described["toml"].as_str().unwrap();
    for line in [
        "separator = \"semicolon\"\ndecimal_comma = true\n",
        "t_s = { from = \"Zeit\", scale = 0.001 }\nposition_m = { from = \"Weg\", scale = 0.001 }\n",
        "# Two pressures: drive_force_n = \"(`p A` - `p B`) * AREA\" with the piston area in SI units.\n",
    ] {
        assert!(toml.contains(line), "{line}\n{toml}");
    }
}

#[test]
fn wrong_expressions_exit_with_2_and_are_listed_together() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    write(here);
    for (from, to, expected) in [
        (
            "`p B`)",
            "p_b)",
            "log.csv: columns.drive_force_n: found `(`p A` - p_b) * 1e5 * 4.9e-4`, but no column is `p_b`; \
             expected columns among `Zeit`, `Weg`, `p A`, `p B`",
        ),
        ("`p B`)", "`p B`", "at character 30 found the end; expected `)` or an operator, or a column"),
        (
            "* 1e5",
            "/ (Zeit - Zeit)",
            "log.csv: line 4, drive_force_n: found inf from `(`p A` - `p B`) / (Zeit",
        ),
        ("\"Weg * 1e-3\"", "\"Wge\"", "log.csv: columns.position_m: no column `Wge` among `Zeit`, `Weg`,"),
        ("\"Weg * 1e-3\"", "\"?\"", "line 22: columns.position_m is not filled in; expected a column or an"),
        ("\"Weg * 1e-3\"", "3", "line 22: columns.position_m is 3; expected a column or an expression"),
        ("[columns]", "[log]\nheader = true\n[columns]", "looks like `[log]` with separator = \"semicolon\""),
    ] {
        assert!(BENCH.contains(from), "{from}");
        std::fs::write(here.join("bench.toml"), BENCH.replace(from, to)).unwrap();
        for command in ["check", "evaluate", "diagnose"] {
            let message = refused(here, &[command, "log.csv", "--bench", "bench.toml"]);
            assert!(message.contains(expected), "{command}: {message}");
        }
    }
    std::fs::write(here.join("bench.toml"), BENCH.replace("`p A`", "q").replace("Weg", "Wge")).unwrap();
    let message = refused(here, &["evaluate", "log.csv", "--bench", "bench.toml"]);
    assert!(message.contains("log.csv: 2 columns cannot be read\n  columns.drive_force_n: "), "{message}");
    assert!(message.contains("\n  columns.position_m: "), "{message}");
}
