//! Tests of the training report and of the goals in `verify`.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn model_quant(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_model-quant")).args(arguments).output().expect("run")
}

fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("json")
}

fn name(path: &Path) -> &str {
    path.to_str().expect("utf-8")
}

#[test]
fn the_report_has_every_picture_goal_and_claim_and_is_the_same_every_time() {
    let folder = tempfile::tempdir().expect("folder");
    let [first, second] = ["first", "second"].map(|part| folder.path().join(part));
    let arguments =
        |out: &Path| ["report", "--bearing", "plastic", "--json", "--out", name(out)].map(str::to_owned);
    let found = json(&model_quant(&arguments(&first).each_ref().map(String::as_str)));
    let ids: Vec<u64> =
        found["claims"].as_array().expect("claims").iter().filter_map(|c| c["id"].as_u64()).collect();
    assert_eq!(ids, [12, 13, 14, 15]);
    let network = &found["networks"][0];
    assert_eq!(network["bearing"], "plastic");
    for verdict in network["verdicts"].as_array().expect("verdicts") {
        let goals = verdict["goals"].as_array().expect("goals");
        assert!(goals.iter().any(|g| g["figure"].as_str().is_some_and(|f| f.contains("held-out"))));
        for goal in goals {
            let [value, limit] = ["value", "limit"].map(|key| goal[key].as_f64().expect("number"));
            assert_eq!(goal["met"], if goal["relation"] == ">=" { value >= limit } else { value <= limit });
        }
    }
    let page = std::fs::read_to_string(first.join("report.html")).expect("page");
    assert!(page.contains("Figs. 12 and 13") && page.matches("<svg").count() >= 10);
    assert!(page.contains("train --friction rig") && page.contains("--example companding"));
    for picture in [
        "epochs-plastic-collision-mse",
        "epochs-plastic-friction-mae",
        "prediction-plastic-collision",
        "torque-plastic-speed",
        "torque-plastic-map",
        "bands-plastic-friction",
    ] {
        assert!(first.join(format!("{picture}.svg")).exists(), "{picture}");
    }
    json(&model_quant(&arguments(&second).each_ref().map(String::as_str)));
    for file in ["report.html", "report.json"] {
        let [a, b] = [&first, &second].map(|part| std::fs::read(part.join(file)).expect("file"));
        assert!(a == b, "{file}");
    }
}

#[test]
fn a_history_of_another_training_is_refused() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("history.json");
    std::fs::write(&path, r#"{"bearing": "plastic", "training_id": "00", "epochs": []}"#).expect("file");
    let out = folder.path().join("out");
    let arguments = ["report", "--bearing", "plastic", "--history", name(&path), "--out", name(&out)];
    let output = model_quant(&arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("--history: found") && message.contains("training id 00"), "{message}");
    std::fs::write(&path, "{}").expect("file");
    let output = model_quant(&arguments);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("history.json: found missing field"));
    assert!(!out.exists());
}

#[test]
fn networks_of_the_rig_are_compared_with_its_records_and_other_files_are_refused() {
    let folder = tempfile::tempdir().expect("folder");
    let (out, rig) = (folder.path().join("out"), folder.path().join("babbitt.rig.json"));
    let train = ["train", "--friction", "rig", "--bearing", "babbitt", "--rows", "8192", "--epochs", "8"];
    let trained = json(&model_quant(&[&train[..], &["--json", "--out", name(folder.path())]].concat()));
    let companding = folder.path().join("companding.txt");
    std::fs::write(&companding, "plastic, a comparison\n| target | above |\n|---|---|\n| force | 12.5 |\n")
        .expect("file");
    let files = ["--rig", name(&rig), "--companding", name(&companding)];
    let report = ["report", "--bearing", "plastic", "--json", "--out", name(&out)];
    let found = json(&model_quant(&[&report[..], &files[..]].concat()));
    let facts = &found["rigs"][0];
    assert_eq!(facts["bearing"], "babbitt");
    let errors = facts["errors"].as_array().expect("groups");
    assert_eq!((errors.len(), &errors[0]["group"]), (5, &Value::from("all")));
    // The training measures the drawn samples, the report all samples.
    let number = |value: &Value, path: &str| value.pointer(path).and_then(Value::as_f64).expect("number");
    let r2 = number(&errors[0], "/truth/r2");
    assert!((r2 - number(&trained, "/test_against_truth/r2")).abs() < 1e-3, "{r2}");
    assert_eq!(facts["met"], r2 >= 0.999);
    let page = std::fs::read_to_string(out.join("report.html")).expect("page");
    assert!(page.contains("plastic, a comparison") && page.contains("12.5"));
    assert!(out.join("rig-babbitt-3-speed.svg").exists());

    let text = std::fs::read_to_string(&rig).expect("file");
    for (from, to, expected) in [
        (
            "\"part\":\"test\"",
            "\"part\":\"training\"",
            "found other groups; expected those of friction-rig-babbitt",
        ),
        ("\"bearing\":\"babbitt\"", "\"bearing\":\"tin\"", "found bearing `tin`"),
        ("\"parameters\":[", "\"parameters\":[0.0,", "parameters; expected"),
        ("\"scales\"", "\"scale\"", "missing field `scales`"),
    ] {
        assert!(text.contains(from), "{from}");
        std::fs::write(&rig, text.replacen(from, to, 1)).expect("file");
        let output = model_quant(&["report", "--rig", name(&rig), "--out", name(&out)]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("babbitt.rig.json") && message.contains(expected), "{message}");
    }
}

#[test]
fn verify_compares_both_networks_with_their_goals_and_reports_friction_as_a_torque() {
    let found = json(&model_quant(&["verify", "--bearing", "plastic", "--json"]));
    let [collision, friction] = [&found[0], &found[1]];
    assert!(collision.get("mae_nm").is_none());
    let [mae_n, mae_nm] = ["mae_n", "mae_nm"].map(|key| friction[key].as_f64().expect("number"));
    assert!((mae_nm / mae_n - 0.07).abs() < 1e-12);
    let number = |value: &Value, path: &str| value.pointer(path).and_then(Value::as_f64).expect("number");
    let share = number(collision, "/mae_n") / number(collision, "/p99_force_n");
    assert!((number(collision, "/mae_share_of_p99") - share).abs() < 1e-12 && share < 0.003);
    assert!(number(collision, "/held_out/image/rows") > 90_000.0);
    assert!(number(collision, "/p99_force_n") > 10_000.0);
}

#[test]
fn no_work_is_begun_if_the_output_cannot_be_written() {
    let folder = tempfile::tempdir().expect("folder");
    let file = folder.path().join("file");
    std::fs::write(&file, "in the way").expect("file");
    let out = file.join("out");
    // Each command line also names a missing file: its error would come first if the work had
    // begun.
    let report = ["report", "--rig", "no-such.json", "--out", name(&out)];
    let train = ["train", "--friction", "rig", "--rig", "no-such.toml", "--out", name(&out)];
    let dataset = ["dataset", "friction", "--bench", "no-such.toml", "--out", name(&out)];
    for arguments in [&report[..], &train[..], &dataset[..]] {
        let output = model_quant(arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(message.contains("file") && !message.contains("no-such"), "{message}");
    }
    let law = ["train", "--rows", "512", "--epochs", "1", "--grid-epochs", "0", "--out", name(&out)];
    let output = model_quant(&law);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("file") && !message.contains("epoch"), "{message}");
}

#[test]
fn the_history_next_to_a_checkpoint_may_also_be_an_option() {
    let folder = tempfile::tempdir().expect("folder");
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    let [checkpoint, history] = ["plastic.float", "plastic.history.json"].map(|file| {
        let copy = folder.path().join(file);
        std::fs::copy(models.join(file), &copy).expect("copy");
        copy
    });
    // All inputs are valid; only the output directory is unusable.
    let out = history.join("out");
    let output = model_quant(&[
        "report",
        "--checkpoint",
        name(&checkpoint),
        "--history",
        name(&history),
        "--out",
        name(&out),
    ]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
}
