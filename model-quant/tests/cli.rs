//! Tests of the command line: written files, refused inputs and their messages.
#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot set itself up has failed")]

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

fn model_quant(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_model-quant")).args(arguments).output().expect("model-quant")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(output: &Output) -> serde_json::Value {
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("json")
}

fn as_str(path: &Path) -> &str {
    path.to_str().expect("path")
}

#[test]
fn a_data_set_is_independent_of_threads_and_begins_with_a_shorter_one() {
    let directory = tempfile::tempdir().expect("directory");
    let write = |name: &str, range: &str, rows: &str, threads: &str| {
        let file = directory.path().join(name);
        let output = model_quant(&[
            "dataset",
            "--range",
            range,
            "--rows",
            rows,
            "--seed",
            "7",
            "--threads",
            threads,
            "--json",
            "--out",
            as_str(&file),
        ]);
        assert_eq!(json(&output)["rows"].as_u64().map(|rows| rows.to_string()).as_deref(), Some(rows));
        std::fs::read_to_string(&file).expect("table")
    };
    for range in ["paper", "bench"] {
        let one = write("one.csv", range, "400", "1");
        assert_eq!(one, write("three.csv", range, "400", "3"));
        assert!(one.starts_with(&write("short.csv", range, "50", "2")));
        assert_eq!(one.lines().count(), 401);
        assert!(one.starts_with("radial_clearance_m,deformation_m,"));
    }
}

#[test]
fn a_small_training_passes_every_command() {
    let directory = tempfile::tempdir().expect("directory");
    let out = as_str(directory.path());
    let trained = json(&model_quant(&[
        "train",
        "--bearing",
        "plastic",
        "--rows",
        "2048",
        "--epochs",
        "2",
        "--grid-epochs",
        "1",
        "--seed",
        "5",
        "--out",
        out,
        "--json",
    ]));
    assert_eq!(trained["epochs"].as_array().map(Vec::len), Some(6));
    assert_eq!(trained["equals_checked_in"], false);
    let checkpoint = directory.path().join("plastic.float");
    let quantised =
        json(&model_quant(&["quantize", "--checkpoint", as_str(&checkpoint), "--out", out, "--json"]));
    assert_eq!(quantised[0]["bearing"], "plastic");
    assert_eq!(quantised[0]["training_id"], trained["training_id"]);
    let image = directory.path().join("plastic.pintle");
    let verified = json(&model_quant(&[
        "verify",
        "--image",
        as_str(&image),
        "--checkpoint",
        as_str(&checkpoint),
        "--json",
    ]));
    assert_eq!(verified[0]["network"], "collision");
    assert_eq!(verified[1]["network"], "friction");
    assert_eq!(verified[0]["image_matches_checkpoint"], true);
    assert_eq!(verified[0]["zero_contact_output"], 0.0);
    let card = std::fs::read_to_string(directory.path().join("plastic.md")).expect("card");
    assert!(card.contains("seed 5"), "{card}");

    assert_eq!(verified[0]["peers"].as_array().map(Vec::len), Some(0), "the peers ran another image");

    let mut bytes = std::fs::read(&image).expect("image");
    bytes[1000] ^= 1;
    std::fs::write(&image, bytes).expect("damaged image");
    let refused = model_quant(&["verify", "--image", as_str(&image)]);
    assert_eq!(refused.status.code(), Some(2));
    let message = text(&refused.stderr);
    assert!(message.contains("plastic.pintle") && message.contains("checksum"), "{message}");
}

#[test]
fn an_interrupted_training_resumes_to_the_same_bytes() {
    let directory = tempfile::tempdir().expect("directory");
    let (uninterrupted, parts) = (directory.path().join("uninterrupted"), directory.path().join("parts"));
    let arguments = |out: &Path| -> Vec<String> {
        let fixed = "train --rows 4096 --epochs 25 --grid-epochs 15 --keep-s 0 --json --out";
        fixed.split(' ').map(str::to_owned).chain([as_str(out).to_owned()]).collect()
    };
    let run = |out: &Path, more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_model-quant"));
        command.args(arguments(out)).args(more).output().expect("model-quant")
    };
    json(&run(&uninterrupted, &[]));
    let mut command = Command::new(env!("CARGO_BIN_EXE_model-quant"));
    command.args(arguments(&parts)).stdout(Stdio::null()).stderr(Stdio::null());
    let mut killed = command.spawn().expect("model-quant");
    let state = parts.join("babbitt-collision.training");
    while !state.exists() {
        assert!(killed.try_wait().expect("status").is_none(), "it ended before a state was kept");
        std::thread::sleep(Duration::from_millis(1));
    }
    killed.kill().expect("kill");
    killed.wait().expect("status");
    assert!(!parts.join("babbitt.float").exists(), "killed before its end");
    let wrong = run(&parts, &["--resume", "--seed", "77"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(text(&wrong.stderr).contains("babbitt-collision.training"), "{}", text(&wrong.stderr));
    json(&run(&parts, &["--resume"]));
    for file in ["babbitt.float", "babbitt.history.json"] {
        let read = |directory: &Path| std::fs::read(directory.join(file)).expect("file");
        assert!(read(&uninterrupted) == read(&parts), "{file}");
    }
    assert_eq!(std::fs::read_dir(&parts).expect("entries").count(), 2, "no states are left");
    // Without a state the training starts again, and says so.
    let again = run(&parts, &["--resume"]);
    assert!(text(&again.stderr).contains("no state of a training in"), "{}", text(&again.stderr));
    json(&again);
}

#[test]
fn wrong_input_exits_with_2_and_names_what_was_expected() {
    let directory = tempfile::tempdir().expect("directory");
    let not_a_model = directory.path().join("x");
    std::fs::write(&not_a_model, b"nothing of the kind").expect("file");
    let out = as_str(directory.path());
    for (arguments, expected) in [
        (vec!["train", "--bearing", "wood", "--out", out], "expected `babbitt` or `plastic`"),
        (vec!["train", "--rows", "3", "--out", out], "expected at least a batch"),
        (vec!["train", "--epochs", "0", "--out", out], "--epochs: found 0"),
        (vec!["train", "--threads", "99999", "--out", out], "99999 is not in 0..=1024"),
        (vec!["dataset", "--rows", "0", "--out", as_str(&not_a_model)], "--rows: found 0"),
        (vec!["dataset", "--range", "moon", "--out", as_str(&not_a_model)], "paper"),
        (vec!["quantize", "--checkpoint", as_str(&not_a_model), "--out", out], "float checkpoint"),
        (vec!["quantize", "--checkpoint", "/nowhere/a.float", "--out", out], "/nowhere/a.float"),
        (vec!["verify", "--image", as_str(&not_a_model)], "model image"),
        (vec!["verify", "--emulated", as_str(&not_a_model)], "file of results"),
        (vec!["quantize", "--mode", "w4a4", "--out", out], "w8a16"),
        (vec!["quantize", "--mode", "w16a16", "--packing", "flash", "--out", out], "one form of storage"),
        (vec!["quantize", "--max-error-n", "NaN", "--out", out], "--max-error-n: found NaN"),
        (vec!["quantize", "--max-error-n", "-1", "--out", out], "--max-error-n: found -1"),
    ] {
        let output = model_quant(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let message = text(&output.stderr);
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
    assert_eq!(std::fs::read_dir(directory.path()).expect("directory").count(), 1, "nothing was written");
}

#[test]
fn sums_of_a_controller_are_compared_bit_for_bit() {
    let directory = tempfile::tempdir().expect("directory");
    // A controller must give the same sums as ONNX Runtime.
    let mut sums = include_bytes!("../peers/onnxruntime.bin").to_vec();
    let file = directory.path().join("sums.bin");
    std::fs::write(&file, &sums).expect("sums");
    let verify = || model_quant(&["verify", "--emulated", as_str(&file), "--json"]);
    let verdicts = json(&verify());
    assert_eq!(verdicts.as_array().map(Vec::len), Some(4));
    for verdict in verdicts.as_array().into_iter().flatten() {
        for name in
            ["bearing", "network", "r2_float", "r2_quantised", "mae_n", "zero_contact_output", "image_crc_ok"]
        {
            assert!(!verdict[name].is_null(), "{name}");
        }
        assert_eq!(verdict["peers"].as_array().map(Vec::len), Some(3));
        assert_eq!(verdict["peers"][2]["different"], 0);
    }

    let last = sums.len() - 4;
    sums[last] ^= 1;
    std::fs::write(&file, &sums).expect("sums");
    let different = verify();
    assert_eq!(different.status.code(), Some(1));
    let message = text(&different.stderr);
    assert!(message.contains("plastic friction") && message.contains("1 of 384 windows"), "{message}");

    sums[64] ^= 1;
    std::fs::write(&file, &sums).expect("sums");
    let refused = verify();
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("sums for another image"), "{}", text(&refused.stderr));
}

#[test]
fn an_image_above_the_error_limit_is_refused_and_nothing_is_written() {
    let directory = tempfile::tempdir().expect("directory");
    let out = as_str(directory.path());
    let quantize = |limit: &str| {
        let common = ["quantize", "--mode", "w8a8", "--max-error-n", limit, "--out", out, "--json"];
        model_quant(&common)
    };
    let refused = quantize("50");
    assert_eq!(refused.status.code(), Some(1));
    let message = text(&refused.stderr);
    assert!(message.contains("babbitt collision: mean absolute difference"), "{message}");
    assert!(message.contains("expected at most 50 N"), "{message}");
    assert_eq!(std::fs::read_dir(directory.path()).expect("directory").count(), 0, "nothing was written");

    let written = json(&quantize("500"));
    assert_eq!(std::fs::read_dir(directory.path()).expect("directory").count(), 4);
    let error = written[0]["mae_quantisation_n"][0].as_f64().expect("figure");
    assert!(error > 50.0 && error < 500.0, "{error}");
    let card = std::fs::read_to_string(directory.path().join("babbitt.md")).expect("card");
    assert!(card.contains("w8a8"), "{card}");
    // The loader recognises the width of the compact image.
    let image = directory.path().join("babbitt.pintle");
    let verified = json(&model_quant(&["verify", "--image", as_str(&image), "--json"]));
    assert_eq!(verified[0]["mae_quantisation_n"].as_f64(), Some(error));
}

#[test]
fn every_command_has_help_with_an_example() {
    for command in ["dataset", "train", "quantize", "import", "export", "verify", "key", "package", "report"]
    {
        let output = model_quant(&[command, "--help"]);
        assert!(output.status.success());
        let help = text(&output.stdout);
        assert!(help.contains("Example") && help.contains(&format!("model-quant {command}")), "{help}");
    }
}

#[test]
fn options_without_effect_on_a_training_are_refused() {
    let directory = tempfile::tempdir().expect("directory");
    let out = directory.path().join("out");
    let refused = |arguments: &[&str]| {
        let output = model_quant(&[&["train", "--bearing", "plastic"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", text(&output.stderr));
        text(&output.stderr)
    };
    let out_of = ["--out", as_str(&out)];
    let rig = |more: &[&str]| refused(&[&["--friction", "rig"], &out_of[..], more].concat());
    assert!(
        rig(&["--resume"]).contains("--resume") && rig(&["--grid-epochs", "3"]).contains("--grid-epochs")
    );
    assert!(rig(&["--range", "bench"]).contains("--range"));
    assert!(rig(&["--rig", "friction-rig-babbitt"]).contains("found a babbitt pair, expected plastic"));
    let law = refused(&[&["--rig", "friction-rig-plastic"], &out_of[..]].concat());
    assert!(law.contains("without --friction rig"), "{law}");
    assert!(refused(&["--check", "--friction", "rig"]).contains("--check"));
    assert!(!out.join("plastic.rig.json").exists() && !out.join("plastic.float").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn an_endless_file_is_refused() {
    let output = model_quant(&["import", "/dev/zero"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("/dev/zero: found more bytes"), "{}", text(&output.stderr));
}

#[test]
fn an_image_of_another_checkpoint_is_reported() {
    let directory = tempfile::tempdir().expect("directory");
    let mut image = inference::shipped(inference::BearingMaterial::Plastic).to_vec();
    let verify = |name: &str, image: &mut [u8]| {
        inference::image::write::seal(image);
        let file = directory.path().join(name);
        std::fs::write(&file, &*image).expect("image");
        let output = model_quant(&["verify", "--image", as_str(&file)]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout).contains("made from another checkpoint")
    };
    assert!(!verify("own", &mut image));
    // A byte of the training id in the header.
    image[16] ^= 1;
    assert!(verify("other", &mut image));
}
