//! `host-sim claims` on the command line: files, resuming, threads, exit codes, and the first draws
//! of the published campaign.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// Verdicts of the published campaign, one line a draw.
const GOLDEN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/golden/claims.csv");
/// Draws that are judged again.
const CHECKED: usize = 40;

fn claims(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_host-sim"));
    command.current_dir(folder).arg("claims").args(arguments).output().unwrap()
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn the_first_draws_have_the_verdicts_of_the_published_campaign() {
    let directory = tempfile::tempdir().unwrap();
    let runs = CHECKED.to_string();
    let output = claims(directory.path(), &["--runs", &runs, "--json", "--out", "c"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found = read(directory.path(), "c/verdicts.csv");
    let golden = std::fs::read_to_string(GOLDEN).unwrap();
    for (found, golden) in found.lines().zip(golden.lines()) {
        assert_eq!(found, golden);
    }
    assert_eq!(found.lines().count(), CHECKED + 1);

    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = json.get("claims").and_then(Value::as_array).unwrap();
    assert_eq!(rows.len(), 15);
    for row in rows {
        let id = row.get("id").and_then(Value::as_u64).unwrap();
        let has = |pointer: &str| row.pointer(pointer).is_some_and(|value| !value.is_null());
        assert!(has("/nominal/as_run") && has("/threshold"), "{row}");
        assert_eq!(has("/nominal/settled"), id <= 11, "{row}");
        assert_eq!(has("/nominal/networks"), (12..=14).contains(&id), "{row}");
        assert_eq!(has("/mapped/operations/0/holds/low"), id <= 14, "{row}");
        assert_eq!(has("/mapped/operations/1/holds/low"), id <= 11, "{row}");
    }
    for (id, expected) in [(4, "assumed"), (12, "assumed"), (13, "assumed"), (14, "assumed")] {
        let row = rows.iter().find(|row| row.get("id").and_then(Value::as_u64) == Some(id)).unwrap();
        assert_eq!(row.pointer("/nominal/as_run").and_then(Value::as_str), Some(expected));
    }
    let csv = read(directory.path(), "c/draws.csv");
    assert_eq!(csv.lines().count(), CHECKED + 1);
    assert!(csv.starts_with("draw,contact.latch_floor_m_s,"), "{csv}");
    let page = read(directory.path(), "c/report.html");
    assert!(page.contains("Which parameter decides") && page.matches("<svg").count() >= 2);
    assert!(directory.path().join("c/claims-map-from-rest.svg").exists());
}

#[test]
fn a_campaign_resumes_and_does_not_depend_on_threads_or_interruption() {
    let directory = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        let output = claims(directory.path(), arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    run(&["--runs", "1", "--seed", "5", "--threads", "1", "--out", "resumed"]);
    run(&["--runs", "3", "--seed", "5", "--threads", "1", "--out", "resumed"]);
    run(&["--runs", "3", "--seed", "5", "--threads", "2", "--out", "at-once"]);
    for name in ["verdicts.csv", "draws.csv", "claims.json", "claims.md", "report.html"] {
        let path = |folder: &str| format!("{folder}/{name}");
        assert_eq!(
            read(directory.path(), &path("resumed")),
            read(directory.path(), &path("at-once")),
            "{name}"
        );
    }
    let other = claims(directory.path(), &["--runs", "3", "--seed", "6", "--out", "resumed"]);
    assert_eq!(other.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&other.stderr).contains("seed: found 5, expected 6"));
    assert_eq!(claims(directory.path(), &["--runs", "0"]).status.code(), Some(2));
    let rig = claims(directory.path(), &["--bench", "slider-crank", "--out", "rig"]);
    assert_eq!(rig.status.code(), Some(2), "{}", String::from_utf8_lossy(&rig.stderr));
}

#[test]
fn merged_shards_give_the_bytes_of_one_machine() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let done = |arguments: &[&str]| {
        let output = claims(folder, arguments);
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        output
    };
    done(&["--runs", "3", "--out", "one"]);
    let shard = done(&["--runs", "3", "--shard", "1/2", "--out", "s1", "--json"]);
    let shard: Value = serde_json::from_slice(&shard.stdout).unwrap();
    assert_eq!((&shard["runs"], &shard["campaign_runs"]), (&2.into(), &3.into()));
    done(&["--runs", "3", "--shard", "2/2", "--out", "s2"]);
    done(&["merge", "s2", "s1", "--runs", "3", "--out", "merged"]);
    for name in ["claims.json", "claims.md", "draws.csv", "verdicts.csv", "report.html"] {
        assert_eq!(read(folder, &format!("one/{name}")), read(folder, &format!("merged/{name}")), "{name}");
    }
    done(&["--runs", "2", "--shard", "1/2", "--seed", "9", "--out", "other"]);
    for (arguments, expected) in [
        (&["merge", "s1", "s2", "--runs", "3", "--out", "other"][..], "it belongs to other work: seed"),
        (&["merge", "s1", "--runs", "3"][..], "found 2 of 3 runs; missing: 1"),
        (&["merge", "s1", "s2", "--runs", "3", "--seed", "2"], "it belongs to other work: seed"),
        (&["merge"], "claims: found merge; expected `merge` and the folder of every shard"),
        (&["s1", "s2"], "claims: found s1; expected `merge`"),
    ] {
        let output = claims(folder, arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
}
