//! Tests of `model-quant dataset collision` and `friction`: content, reproducibility, refused
//! inputs.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a test that cannot set itself up has failed"
)]

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::RowAccessor;
use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Output};

fn dataset(arguments: &[&str], out: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_model-quant"));
    command.arg("dataset").args(arguments);
    if !arguments.contains(&"--summary") {
        command.arg("--out").arg(out);
    }
    command.output().expect("model-quant")
}

fn json(arguments: &[&str], out: &Path) -> serde_json::Value {
    let output = dataset(arguments, out);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("json")
}

fn read(directory: &Path, name: &str) -> String {
    fs::read_to_string(directory.join(name)).expect("file")
}

#[test]
fn files_are_independent_of_threads_and_begin_with_shorter_ones() {
    let directory = tempfile::tempdir().expect("directory");
    for range in ["paper", "bench"] {
        let make = |name: &str, rows: &str, threads: &str| {
            let out = directory.path().join(name);
            let arguments = [
                "collision",
                "--range",
                range,
                "--rows",
                rows,
                "--threads",
                threads,
                "--seed",
                "6",
                "--json",
            ];
            (json(&arguments, &out), out)
        };
        // Each part has several blocks, the last of them incomplete.
        let (one, one_files) = make("one", "700000", "1");
        let (three, three_files) = make("three", "700000", "3");
        let (short, short_files) = make("short", "60", "2");
        assert_eq!(one["normal_force_n"], three["normal_force_n"]);
        for (part, rows) in [("training", 466_666), ("validation", 116_666), ("test", 116_668)] {
            let file = format!("collision-babbitt-{range}-{part}.csv");
            let text = read(&one_files, &file);
            assert!(text == read(&three_files, &file), "{file}");
            assert_eq!(text.lines().count() - 1, rows);
            assert_eq!(one["rows"][part].as_u64(), Some(rows as u64));
            assert!(text.starts_with(&read(&short_files, &file)));
        }
        assert_eq!(short["rows"]["training"], 40);
        // Three parts and a card, no temporary files.
        assert_eq!(fs::read_dir(&one_files).expect("files").count(), 4);
        for directory in [one_files, three_files, short_files] {
            fs::remove_dir_all(directory).expect("files");
        }
    }
}

#[test]
fn parquet_and_csv_have_the_same_numbers() {
    let directory = tempfile::tempdir().expect("directory");
    let out = directory.path();
    for more in [
        &["--rows", "3000"][..],
        &["--rows", "300", "--windows"],
        &["--range", "bench", "--rows", "3000"],
        &["--source", "bench"],
    ] {
        let csv = json(&[&["collision", "--bearing", "plastic", "--json"], more].concat(), out);
        let parquet = json(
            &[&["collision", "--bearing", "plastic", "--json", "--format", "parquet"], more].concat(),
            out,
        );
        for part in 0..3 {
            let path =
                |summary: &serde_json::Value| summary["files"][part].as_str().expect("path").to_owned();
            let text = fs::read_to_string(path(&csv)).expect("csv");
            let reader =
                SerializedFileReader::new(File::open(path(&parquet)).expect("file")).expect("parquet");
            let schema = reader.metadata().file_metadata().schema().clone();
            let names: Vec<_> = schema.get_fields().iter().map(|field| field.name().to_owned()).collect();
            let mut lines = text.lines();
            assert_eq!(lines.next(), Some(names.join(",").as_str()));
            let mut rows = 0;
            for row in reader.get_row_iter(None).expect("rows") {
                let row = row.expect("row");
                let line: Vec<f32> =
                    lines.next().expect("line").split(',').map(|v| v.parse().unwrap()).collect();
                let found: Vec<f32> = (0..names.len()).map(|i| row.get_float(i).expect("float")).collect();
                assert_eq!(found, line);
                rows += 1;
            }
            assert_eq!(lines.next(), None);
            assert!(rows >= 50, "{rows}");
        }
    }
}

#[test]
fn the_complete_table_2_has_the_expected_counts_and_forces() {
    let summary =
        |more: &[&str]| json(&[&["collision", "--summary", "--json"], more].concat(), Path::new(""));
    let (limited, printed) = (summary(&[]), summary(&["--printed"]));
    assert_eq!(
        printed["rows"],
        serde_json::json!({"training": 10_000_000, "validation": 2_500_000, "test": 2_500_000})
    );
    assert_eq!((&printed["files"], &limited["files"]), (&serde_json::json!([]), &serde_json::json!([])));
    let number = |summary: &serde_json::Value, path: &str| {
        summary.pointer(path).and_then(serde_json::Value::as_f64).expect(path)
    };
    // P(x > 6 max(y, .001)) for two independent truncated exponentials with a mean of a fifth, by
    // integration over the approach speed. The axes are random, hence the tolerance.
    let density = |y: f64| 5.0 * (-5.0 * y).exp() / (1.0 - (-5.0_f64).exp());
    let above =
        |x: f64| if x < 1.0 { ((-5.0 * x).exp() - (-5.0_f64).exp()) / (1.0 - (-5.0_f64).exp()) } else { 0.0 };
    let expected: f64 = (0..100_000)
        .map(|i| (f64::from(i) + 0.5) * 1e-5)
        .map(|y| density(y) * above(6.0 * y.max(1e-3)) * 1e-5)
        .sum();
    let share = number(&printed, "/ratio/share_limited");
    assert!((share / expected - 1.0).abs() < 0.03, "{share} for {expected}");
    // Of the points beyond the limit one remains for each approach speed that has any.
    let rows: f64 = ["training", "validation", "test"]
        .map(|part| number(&limited, &format!("/rows/{part}")))
        .iter()
        .sum();
    assert!((0.0..0.01).contains(&(rows / 1.5e7 - (1.0 - share))), "{rows}");
    let force = |summary: &serde_json::Value, of: &str| number(summary, &format!("/normal_force_n/{of}"));
    assert!(force(&limited, "max") < 6e5 && force(&printed, "max") > 50.0 * force(&limited, "max"));
    assert!(force(&printed, "mean") > 5.0 * force(&limited, "mean"), "{printed} {limited}");
    assert_eq!(number(&printed, "/bench_share_outside_range/deformation"), 0.0);
}

#[test]
fn wrong_input_exits_with_2_and_a_failed_write_with_1_and_neither_leaves_a_file() {
    let directory = tempfile::tempdir().expect("directory");
    let out = directory.path().join("sets");
    for (arguments, expected) in [
        (&["collision", "--rows", "5"][..], "--rows: found 5, expected 6 to 15000000"),
        (&["collision", "--rows", "15000001"], "--rows: found 15000001"),
        (&["collision", "--rows", "many"], "invalid"),
        (&["collision", "--printed", "--range", "bench"], "expected --source table and --range paper"),
        (&["collision", "--printed", "--windows"], "cannot be used with"),
        (&["collision", "--source", "bench", "--rows", "60"], "the length of the runs is fixed"),
        (&["collision", "--source", "moon"], "table"),
        (&["collision", "--format", "xlsx"], "parquet"),
        (&["collision", "--bearing", "wood"], "expected `babbitt` or `plastic`"),
    ] {
        let output = dataset(arguments, &out);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?} {message}");
        assert!(message.contains(expected), "{message}");
        assert!(!out.exists());
    }
    fs::write(&out, "a file where the directory should be").expect("file");
    let output = dataset(&["collision", "--rows", "600"], &out);
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stderr).contains("collision-babbitt-paper-training.csv"));
    assert_eq!(fs::read_dir(directory.path()).expect("entries").count(), 1);
}

#[test]
fn a_friction_set_of_the_rig_has_a_picture_with_both_curves() {
    let directory = tempfile::tempdir().expect("directory");
    let make = |name: &str, threads: &str, more: &[&str]| {
        let out = directory.path().join(name);
        (
            json(
                &[&["friction", "--bearing", "plastic", "--seed", "4", "--threads", threads, "--json"], more]
                    .concat(),
                &out,
            ),
            out,
        )
    };
    let (summary, out) = make("one", "1", &[]);
    assert_eq!(summary["series"], serde_json::json!({"training": 60, "validation": 20, "test": 20}));
    assert_eq!(summary["groups"].as_array().map(Vec::len), Some(20));
    let error = |name: &str| summary["torque_error_rms_nm"][name].as_f64().expect("error");
    assert!(error("cleaned") < 0.25 * error("as_logged"));
    let picture = read(&out, "friction-plastic-cleaning.svg");
    assert_eq!(picture.matches("<polyline").count() >= 6, picture.contains("as logged"));
    assert!(picture.contains("Gaussian-weighted average") && picture.trim_end().ends_with("</svg>"));
    let (_, other) = make("two", "2", &[]);
    for entry in fs::read_dir(&out).expect("files") {
        let name = entry.expect("entry").file_name();
        assert!(fs::read(out.join(&name)).unwrap() == fs::read(other.join(&name)).unwrap(), "{name:?}");
    }
    // The file has the scale that the card states.
    let test = read(&out, "friction-plastic-test.csv");
    assert_eq!(test.lines().count(), 1 + 20 * 2048);
    let scale = |of: &str| summary["scales"]["friction_torque_nm"][of].as_f64().expect("scale");
    for line in test.lines().skip(1).step_by(97) {
        let numbers: Vec<f64> = line.split(',').map(|number| number.parse().expect("number")).collect();
        let z = (numbers[5] - scale("mean")) / scale("deviation");
        assert!((z - numbers[8]).abs() < 1e-5, "{line}");
    }
    let (_, parquet) = make("three", "0", &["--format", "parquet"]);
    let file = File::open(parquet.join("friction-plastic-test.parquet")).expect("file");
    let reader = SerializedFileReader::new(file).expect("parquet");
    assert_eq!(reader.metadata().file_metadata().num_rows(), 20 * 2048);
}

/// Writes a log of `samples` samples at 100 Hz in degrees and kilonewtons.
fn foreign_log(path: &Path, samples: usize, hole: bool) {
    let mut text = String::from("time;speed;load;torque\n");
    for i in 0..samples {
        let t = i as f64 * 0.01;
        let speed = 6.0 * (0.157 * t).sin();
        let torque = if hole && i == 40 { "off".to_owned() } else { format!("{}", -900.0 * speed.signum()) };
        text.push_str(&format!("{t};{speed};100;{torque}\n"));
    }
    fs::write(path, text).expect("log");
}

#[test]
fn measured_logs_replace_the_rig() {
    let directory = tempfile::tempdir().expect("directory");
    let at = |name: &str| directory.path().join(name);
    let path = |name: &str| at(name).to_str().expect("path").to_owned();
    let mut description =
        String::from(bench::PRESETS.iter().find(|p| p.0 == "friction-rig-babbitt").expect("preset").1);
    description.push_str(
        "\n[log]\nseparator = \"semicolon\"\nheader = true\n[columns]\nt_s = { from = \"time\" }\n\
         spindle_speed_rad_s = { from = \"speed\", scale = 0.017453292519943295 }\n\
         load_force_n = { from = \"load\", scale = 1e3 }\nfriction_torque_nm = { from = \"torque\" }\n",
    );
    fs::write(at("rig.toml"), description).expect("description");
    for (name, samples) in [("a.csv", 2100), ("b.csv", 3000), ("c.csv", 4000), ("short.csv", 2000)] {
        foreign_log(&at(name), samples, false);
    }
    foreign_log(&at("hole.csv"), 2100, true);
    let rig = path("rig.toml");
    let [a, b, c, short, hole] = ["a.csv", "b.csv", "c.csv", "short.csv", "hole.csv"].map(path);
    let summary = json(&["friction", "--json", "--bench", &rig, "--logs", &a, &b, &c], &at("out"));
    assert_eq!(summary["series"], serde_json::json!({"training": 5, "validation": 5, "test": 5}));
    assert_eq!(summary["measured"], true);
    assert!(summary["torque_error_rms_nm"].is_null());
    let training = read(&at("out"), "friction-babbitt-training.csv");
    let first: Vec<f64> =
        training.lines().nth(1).expect("line").split(',').map(|v| v.parse().expect("number")).collect();
    assert!((first[3] - 1e5).abs() < 0.1 && first[4].abs() < 0.1048 && first[6] == 0.0, "{first:?}");

    for (arguments, expected) in [
        (vec!["friction", "--bench", &rig, "--logs", &a, &b], "found 2 group(s), expected at least 3"),
        (vec!["friction", "--bench", &rig, "--logs", &a, &b, &short], "short.csv: found 2000 samples"),
        (vec!["friction", "--bench", &rig, "--logs", &a, &b, &hole], "line 42, friction_torque_nm: found"),
        (vec!["friction", "--logs", &a, &b, &c], "no column `t_s` among"),
        (
            vec!["friction", "--bench", "bench-b"],
            "bench-b: found plant `transmission-bench`; expected `friction-rig`",
        ),
        (vec!["friction", "--bench", "nowhere.toml"], "nowhere.toml"),
        (vec!["friction", "--smoothing-ms", "0"], "--smoothing-ms: found 0, expected 1 to 10000"),
        (vec!["friction", "--smoothing-ms", "NaN"], "--smoothing-ms: found NaN"),
    ] {
        let output = dataset(&arguments, &at("refused"));
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?} {message}");
        assert!(message.contains(expected), "{message}");
        assert!(!at("refused").exists());
    }
}

#[test]
fn subcommands_have_help_with_examples() {
    for set in ["collision", "friction"] {
        let output =
            Command::new(env!("CARGO_BIN_EXE_model-quant")).args(["dataset", set, "--help"]).output();
        let help = String::from_utf8_lossy(&output.expect("help").stdout).into_owned();
        assert!(
            help.contains("Examples:") && help.contains(&format!("model-quant dataset {set} --")),
            "{help}"
        );
    }
}

#[test]
fn logs_with_a_gap_become_a_set_and_a_rig_of_another_bearing_does_not() {
    let directory = tempfile::tempdir().expect("directory");
    let mut text = String::from("t_s,load_force_n,spindle_speed_rad_s,friction_torque_nm\n");
    for i in 0..2100 {
        let time_s = 1.7e9 + 0.004 * f64::from(i) + if i < 20 { 0.0 } else { 1000.0 };
        text += &format!("{time_s},100000,{},{}\n", (0.01 * f64::from(i)).sin(), 20 - i % 3);
    }
    let log = directory.path().join("log.csv");
    fs::write(&log, text).unwrap();
    let log = log.to_str().unwrap();
    let out = directory.path().join("out");
    let card = json(&["friction", "--json", "--logs", log, log, log], &out);
    assert_eq!(card["measured"], true);
    let rows = read(&out, "friction-babbitt-test.csv");
    let times: Vec<f64> =
        rows.lines().skip(1).map(|line| line.split(',').nth(2).unwrap().parse().unwrap()).collect();
    assert!(times.iter().all(|time_s| (0.0..1009.0).contains(time_s)), "from the first sample on");
    let output = dataset(&["friction", "--bench", "friction-rig-plastic"], &directory.path().join("none"));
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("friction-rig-plastic: found a plastic pair, expected babbitt"), "{message}");
    assert!(!directory.path().join("none").exists());
}
