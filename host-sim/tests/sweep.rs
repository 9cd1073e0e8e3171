//! Sweeps on the command line: stable names and messages, and the same bytes for any number of
//! threads and after a kill.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output, Stdio};

const PROGRAM: &str = env!("CARGO_BIN_EXE_host-sim");
/// 24 runs, some of them long enough to be interrupted.
const SWEEP: &str = r#"
bearings = ["babbitt", "plastic"]
[[parameters]]
path = "bearing.radial_clearance_m"
range = { from = 1e-4, to = 1e-3, count = 4, scale = "log" }
[[parameters]]
path = "shaft.mass_kg"
values = [120.0, 150.0, 180.0]
"#;
/// Files that must not depend on the clock.
const DETERMINISTIC: [&str; 3] = ["runs.csv", "sweep.json", "report.html"];

fn host_sim(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(PROGRAM).current_dir(directory).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn done(directory: &Path, arguments: &[&str]) -> Output {
    let output = host_sim(directory, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    output
}

fn files(folder: &Path) -> Vec<Vec<u8>> {
    DETERMINISTIC.iter().map(|name| std::fs::read(folder.join(name)).unwrap()).collect()
}

fn sweep_in(directory: &Path) {
    std::fs::write(directory.join("sweep.toml"), SWEEP).unwrap();
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let directory = tempfile::tempdir().unwrap();
    sweep_in(directory.path());
    for (out, threads) in [("one", "1"), ("two", "2"), ("five", "5")] {
        done(directory.path(), &["sweep", "sweep.toml", "--threads", threads, "--out", out]);
    }
    let one = files(&directory.path().join("one"));
    assert_eq!(one, files(&directory.path().join("two")));
    assert_eq!(one, files(&directory.path().join("five")));
    let csv = text(&one[0]);
    assert_eq!(csv.lines().count(), 25);
    assert!(
        csv.starts_with("index,parameters.bearing.radial_clearance_m,parameters.shaft.mass_kg,bearing,"),
        "{csv}"
    );
    assert!(!csv.contains("wall"), "the clock has no place in it");
    let timing = std::fs::read_to_string(directory.path().join("one/timing.csv")).unwrap();
    assert_eq!(timing.lines().count(), 25);
}

#[test]
fn a_resumed_sweep_gives_the_same_bytes_and_executes_only_missing_runs() {
    let directory = tempfile::tempdir().unwrap();
    sweep_in(directory.path());
    done(directory.path(), &["sweep", "sweep.toml", "--out", "whole"]);
    let journal = std::fs::read_to_string(directory.path().join("whole/journal.jsonl")).unwrap();
    let lines: Vec<&str> = journal.lines().collect();
    assert_eq!(lines.len(), 25);
    // Killed after ten runs, while it wrote the eleventh.
    let torn = format!("{}\n{}", lines[..11].join("\n"), &lines[11][..40]);
    let resumed = directory.path().join("resumed");
    std::fs::create_dir(&resumed).unwrap();
    std::fs::write(resumed.join("journal.jsonl"), torn).unwrap();
    let output = done(directory.path(), &["sweep", "sweep.toml", "--out", "resumed"]);
    assert!(
        text(&output.stdout).contains("10 of 24 runs were already in the journal"),
        "{}",
        text(&output.stdout)
    );
    assert_eq!(files(&directory.path().join("whole")), files(&resumed));
    let after = std::fs::read_to_string(resumed.join("journal.jsonl")).unwrap();
    assert_eq!(after.lines().count(), 25);
    assert!(after.starts_with(&lines[..11].join("\n")), "finished runs are kept as they are");
}

#[test]
fn a_killed_sweep_resumes_after_its_last_complete_run() {
    let directory = tempfile::tempdir().unwrap();
    // Slow enough to be killed between its runs: the networks take some hundred times as long as
    // the law.
    std::fs::write(directory.path().join("slow.toml"), format!("force = \"float-net\"\n{SWEEP}")).unwrap();
    let mut child = Command::new(PROGRAM)
        .current_dir(directory.path())
        .args(["sweep", "slow.toml", "--threads", "1", "--out", "killed"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let journal = directory.path().join("killed/journal.jsonl");
    let lines = || std::fs::read_to_string(&journal).map_or(0, |t| t.lines().count());
    while lines() < 4 && child.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
    child.kill().unwrap();
    assert!(!child.wait().unwrap().success(), "it was killed before its end");
    let before = lines();
    assert!((4..25).contains(&before), "{before} lines");
    assert!(!directory.path().join("killed/runs.csv").exists(), "nothing half-written");
    done(directory.path(), &["sweep", "slow.toml", "--threads", "2", "--out", "killed"]);
    done(directory.path(), &["sweep", "slow.toml", "--threads", "2", "--out", "whole"]);
    assert_eq!(files(&directory.path().join("killed")), files(&directory.path().join("whole")));
}

#[test]
fn a_journal_of_another_sweep_is_refused_and_not_changed() {
    let directory = tempfile::tempdir().unwrap();
    sweep_in(directory.path());
    done(directory.path(), &["sweep", "sweep.toml", "--out", "out"]);
    let journal = directory.path().join("out/journal.jsonl");
    let before = std::fs::read(&journal).unwrap();
    let refused = |arguments: &[&str], expected: &str| {
        let output = host_sim(directory.path(), arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(expected), "{message}");
    };
    let force = ["sweep", "sweep.toml", "--force", "float-net", "--out", "out"];
    refused(&force, "it belongs to other work: networks.babbitt: found null, expected");
    std::fs::write(directory.path().join("sweep.toml"), SWEEP.replace("150.0", "151.0")).unwrap();
    refused(&["sweep", "sweep.toml", "--out", "out"], "other work: specification.parameters");
    assert_eq!(before, std::fs::read(&journal).unwrap());
    // A damaged line in the middle of the journal is not an incomplete last line.
    sweep_in(directory.path());
    let damaged = text(&before).replacen("{\"index\"", "{\"indx\"", 3);
    std::fs::write(&journal, damaged).unwrap();
    refused(&["sweep", "sweep.toml", "--out", "out"], "line 2: found no result");
}

#[test]
fn wrong_input_exits_with_2_and_names_the_field() {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str, content: &str| std::fs::write(directory.path().join(name), content).unwrap();
    file("colour.toml", "colour = 3\n[[parameters]]\npath = \"shaft.mass_kg\"\nvalues = [1]");
    file("path.toml", "[[parameters]]\npath = \"shaft.colour\"\nvalues = [1]");
    file("range.toml", "[[parameters]]\npath = \"bearing.radial_clearance_m\"\nvalues = [1e-4, -1]");
    file("none.toml", "[[parameters]]\npath = \"shaft.mass_kg\"");
    file("rig.toml", "bench = \"friction-rig\"\n[[parameters]]\npath = \"axis.inertia\"\nvalues = [1]");
    file("base.toml", "bench = \"missing.toml\"\n[[parameters]]\npath = \"shaft.mass_kg\"\nvalues = [1]");
    for (arguments, expected) in [
        (&["sweep", "colour.toml"][..], "colour.toml: TOML parse error at line 1, column 1"),
        (&["sweep", "path.toml"], "path.toml: parameters.shaft.colour: found no such parameter; expected"),
        (&["sweep", "range.toml"], "range.toml: run 1: bearing.radial_clearance_m is -1; expected"),
        (
            &["sweep", "none.toml"],
            "parameters.shaft.mass_kg: found neither values nor range; expected one of them",
        ),
        (
            &["sweep", "rig.toml"],
            "rig.toml: bench: found plant `friction-rig`; expected `transmission-bench`",
        ),
        (&["sweep", "base.toml"], "missing.toml (neither a preset"),
        (&["sweep", "no-such.toml"], "no-such.toml (neither clearance, load, latch, step nor a file)"),
        (&["sweep", "path.toml", "--bench", "bench-a"], "--bench: found bench-a; expected none"),
        (&["sweep", "clearance", "--step-us", "0"], "--step-us: found 0; expected 0.1 to 1000"),
        (&["sweep", "clearance", "--bench", "friction-rig"], "expected `transmission-bench`"),
        (&["sweep", "latch", "--force", "float-net"], "--force: found float-net; expected law"),
        (&["sweep"], "Usage"),
    ] {
        let output = host_sim(directory.path(), arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(expected), "{arguments:?}: {message}");
        assert!(!directory.path().join("out").exists(), "{arguments:?} left output");
    }
}

#[test]
fn a_failed_run_is_recorded_and_the_others_are_executed() {
    let directory = tempfile::tempdir().unwrap();
    // With almost no clearance, Johnson's law ends far below the load.
    let bench = include_str!("../../crates/bench/presets/bench-b.toml");
    let johnson = bench.replace("\"hybrid-as-printed\"", "\"johnson\"");
    std::fs::write(directory.path().join("johnson.toml"), johnson).unwrap();
    std::fs::write(
        directory.path().join("s.toml"),
        "bench = \"johnson.toml\"\n[[parameters]]\npath = \"bearing.radial_clearance_m\"\n\
         values = [5e-4, 1e-7]",
    )
    .unwrap();
    let output = host_sim(directory.path(), &["sweep", "s.toml", "--out", "out"]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("1 of 2 runs failed; the column `error`"),
        "{}",
        text(&output.stderr)
    );
    let csv = std::fs::read_to_string(directory.path().join("out/runs.csv")).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert!(lines[0].ends_with(",error"), "{csv}");
    assert!(lines[1].ends_with(",") && !lines[2].ends_with(","), "{csv}");
}

#[test]
fn a_bench_in_two_planes_runs_with_the_law_and_refuses_the_networks() {
    let directory = tempfile::tempdir().unwrap();
    let preset = include_str!("../../crates/bench/presets/bench-b.toml");
    let tilted =
        format!("{preset}\n[two_plane]\nmisalignment_y_rad = 1e-3\nsupport_stiffness_nm_rad = 1e6\n");
    std::fs::write(directory.path().join("tilted.toml"), tilted).unwrap();
    let refused = host_sim(directory.path(), &["run", "--bench", "tilted.toml"]);
    assert_eq!(refused.status.code(), Some(2), "{}", text(&refused.stderr));
    assert!(text(&refused.stderr).contains("[two_plane]; expected law"), "{}", text(&refused.stderr));
    let output =
        done(directory.path(), &["run", "--bench", "tilted.toml", "--force", "law", "--json", "--out", "t"]);
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(json.pointer("/tilt/largest_edge_ratio").and_then(Value::as_f64).unwrap() > 1.0, "{json}");
    let report = std::fs::read_to_string(directory.path().join("t/report.html")).unwrap();
    assert!(report.contains("the shaft tilts but does not bend"));
}

#[test]
fn the_papers_sweeps_have_the_stable_names_and_all_claims() {
    let directory = tempfile::tempdir().unwrap();
    for (what, runs) in [("clearance", 8), ("load", 12)] {
        let output = done(directory.path(), &["sweep", what, "--force", "law", "--json", "--out", what]);
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        let list = json.get("runs").and_then(Value::as_array).unwrap();
        assert_eq!(list.len(), runs);
        for name in [
            "bearing",
            "clearance_mm",
            "load_kn",
            "force",
            "peak_contact_force_n",
            "peak_force_y_n",
            "peak_force_z_n",
            "peak_friction_torque_nm",
            "max_deformation_m",
            "oscillation_rms_n",
            "contacts",
            "energy_residual_rel",
            "outside_training_share",
        ] {
            assert!(list.iter().all(|run| run.get(name).is_some()), "{name}");
        }
        let claims = json.get("claims").and_then(Value::as_array).unwrap();
        let ids: Vec<u64> = claims.iter().filter_map(|c| c.get("id")?.as_u64()).collect();
        assert_eq!(ids, (1..=15).collect::<Vec<u64>>());
        for claim in claims {
            let verdict = claim.get("verdict").and_then(Value::as_str).unwrap();
            assert!(["holds", "assumed", "partly", "does not hold"].contains(&verdict), "{claim}");
            let id = claim.get("id").and_then(Value::as_u64).unwrap();
            assert_eq!(claim.pointer("/settled/verdict").is_some(), id <= 11, "{claim}");
            assert_eq!(claim.pointer("/networks/verdict").is_some(), (12..=14).contains(&id), "{claim}");
            assert!(claim.get("why").and_then(Value::as_str).is_some_and(|why| !why.is_empty()), "{claim}");
            assert!(claim.get("claim").is_some(), "{claim}");
        }
        let csv = std::fs::read_to_string(directory.path().join(what).join("runs.csv")).unwrap();
        assert_eq!(csv.lines().count(), runs + 1);
        let header: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
        let column = header.iter().position(|name| *name == "peak_times_s.peak_contact_force_n").unwrap();
        for row in csv.lines().skip(1) {
            let time_s: f64 = row.split(',').nth(column).unwrap().parse().unwrap();
            assert!((0.05..=1.0).contains(&time_s), "after the ramp, within the cycle: {row}");
        }
        let report = std::fs::read_to_string(directory.path().join(what).join("report.html")).unwrap();
        assert!(report.contains("What the model leaves out") && report.contains("does not hold"));
        assert!(report.matches("<svg").count() >= 13);
    }
}

#[test]
fn figures_writes_every_picture_of_both_series() {
    let directory = tempfile::tempdir().unwrap();
    done(directory.path(), &["figures", "--force", "law", "--out", "f"]);
    for series in ["clearance", "load"] {
        for picture in ["shaft-speed", "joint-acceleration"] {
            assert!(
                directory.path().join(format!("f/{series}-{picture}.svg")).exists(),
                "{series} {picture}"
            );
        }
        for bearing in ["babbitt", "plastic"] {
            for quantity in ["impact-force", "force-y", "force-z", "friction-torque", "zoom", "difference"] {
                for (operation, time) in [("", "time, s"), ("-settled", "time in the fifth cycle, s")] {
                    let name = format!("f/{series}-{bearing}-{quantity}{operation}.svg");
                    let svg = std::fs::read_to_string(directory.path().join(&name)).unwrap();
                    assert!(svg.starts_with("<svg") && svg.contains(time), "{name}");
                    let has_start = operation.is_empty() && !["zoom", "difference"].contains(&quantity);
                    assert_eq!(svg.contains("start: ramp of the load"), has_start, "{name}");
                }
            }
        }
    }
    for picture in
        ["swing-over-clearance", "swing-over-modulus", "load-peak-force", "friction-torque-over-speed"]
    {
        assert!(directory.path().join(format!("f/{picture}.svg")).exists(), "{picture}");
    }
    let page = std::fs::read_to_string(directory.path().join("f/report.html")).unwrap();
    for number in [2, 3, 6, 7, 8, 10, 12, 13, 16, 17, 18, 19, 20] {
        assert!(page.contains(&format!("Fig. {number}")), "Fig. {number}");
    }
    assert!(page.contains("Fig. 11: predicted and measured friction, not drawn"));
    for (number, letters) in [(3, "ab"), (6, "abcd"), (12, "ab"), (13, "ab"), (17, "abcd"), (20, "abcd")] {
        for letter in letters.chars() {
            assert!(page.contains(&format!("Fig. {number} ({letter})")), "Fig. {number} ({letter})");
        }
    }
}

#[test]
fn the_latch_sweep_shows_the_effect_of_the_floor_and_that_a_bound_limits_it() {
    let directory = tempfile::tempdir().unwrap();
    let output = done(directory.path(), &["sweep", "latch", "--json", "--out", "latch"]);
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let runs = json.get("runs").and_then(Value::as_array).unwrap();
    assert_eq!(runs.len(), 2 * 4 * 3 * 5);
    let number = |run: &Value, name: &str| run.get(name).and_then(Value::as_f64).unwrap();
    let of = |damping: &str| -> Vec<f64> {
        let same = |r: &&Value| r.get("damping").and_then(Value::as_str) == Some(damping);
        runs.iter().filter(same).map(|r| number(r, "peak_change")).collect()
    };
    let latched = of("latched");
    assert!(latched.iter().any(|c| *c < -0.1) && latched.iter().any(|c| *c > 0.3), "{latched:?}");
    assert_eq!((of("bounded").len(), of("reference").len()), (40, 40));
    assert!(runs.iter().all(|r| number(r, "landing_speed_mm_s") > 1.0 && number(r, "speed_mm_s") > 0.0));
    assert!(directory.path().join("latch/latch-plastic-reference.svg").exists());
}

#[test]
fn the_examples_are_sweeps() {
    let directory = tempfile::tempdir().unwrap();
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    for (name, runs) in [("sweep-clearance-mass.toml", 72), ("sweep-uncertainty.toml", 200)] {
        let file = examples.join(name);
        let output = done(directory.path(), &["sweep", &file.to_string_lossy(), "--json", "--out", name]);
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(json.get("runs").and_then(Value::as_array).map(Vec::len), Some(runs), "{name}");
    }
}

#[test]
fn merged_shards_give_the_bytes_of_one_machine_and_a_killed_shard_resumes() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let sweep = SWEEP.replace("count = 4", "count = 2");
    std::fs::write(folder.join("slow.toml"), format!("force = \"float-net\"\n{sweep}")).unwrap();
    done(folder, &["sweep", "slow.toml", "--out", "one"]);
    let shard = |shard: &str, out: &str| {
        let mut command = Command::new(PROGRAM);
        command.current_dir(folder).args(["sweep", "slow.toml", "--threads", "1", "--shard", shard]);
        command.args(["--out", out]).stdout(Stdio::piped()).stderr(Stdio::piped());
        command.spawn().unwrap()
    };
    // Two workers at the same time; one is killed after its first runs.
    let (first, mut second) = (shard("1/2", "s1"), shard("2/2", "s2"));
    let lines = |name: &str| {
        std::fs::read_to_string(folder.join(name).join("journal.jsonl")).map_or(0, |t| t.lines().count())
    };
    while lines("s2") < 3 && second.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
    second.kill().unwrap();
    assert!(!second.wait().unwrap().success(), "it was killed before its end");
    assert!((3..7).contains(&lines("s2")), "{}", lines("s2"));
    let first = first.wait_with_output().unwrap();
    assert!(first.status.success(), "{}", text(&first.stderr));
    assert!(text(&first.stdout).starts_with("shard 1/2: 6 of 12 runs, 0 failed"), "{}", text(&first.stdout));
    assert!(!folder.join("s1/runs.csv").exists(), "a shard has no results");
    let merge = ["sweep", "merge", "slow.toml", "s1", "s2", "--out", "merged"];
    let early = host_sim(folder, &merge);
    assert_eq!(early.status.code(), Some(2));
    assert!(text(&early.stderr).contains(" of 12 runs; missing: "), "{}", text(&early.stderr));
    assert!(!folder.join("merged/runs.csv").exists());

    assert!(shard("2/2", "s2").wait().unwrap().success());
    done(folder, &merge);
    assert_eq!(files(&folder.join("one")), files(&folder.join("merged")));
    // Every run of a shard has its remainder.
    let journal = std::fs::read_to_string(folder.join("s2/journal.jsonl")).unwrap();
    let indices = journal.lines().skip(1).map(|line| {
        serde_json::from_str::<Value>(line).unwrap().get("index").and_then(Value::as_u64).unwrap()
    });
    assert!(indices.map(|index| index % 2).eq([1; 6]));
}

#[test]
fn shards_of_other_sweeps_and_meaningless_arguments_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    sweep_in(folder);
    done(folder, &["sweep", "sweep.toml", "--shard", "1/2", "--out", "s1"]);
    done(folder, &["sweep", "sweep.toml", "--shard", "2/2", "--out", "s2", "--step-us", "50"]);
    let refused = |arguments: &[&str], expected: &str| {
        let output = host_sim(folder, arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(expected), "{arguments:?}: {message}");
    };
    refused(
        &["sweep", "merge", "sweep.toml", "s1", "s2"],
        "s2/journal.jsonl, line 1: it belongs to other work",
    );
    refused(
        &["sweep", "merge", "sweep.toml", "s1", "s1"],
        "found it in s1/journal.jsonl and in s1/journal.jsonl; expected it once",
    );
    refused(
        &["sweep", "merge", "sweep.toml", "s1", "--out", "s2"],
        "s2/journal.jsonl, line 1: it belongs to other work",
    );
    refused(&["sweep", "merge", "sweep.toml", "s1", "s3"], "s3/journal.jsonl: found no journal");
    refused(&["sweep", "merge", "sweep.toml"], "found no shard");
    refused(&["sweep", "merge"], "found no shard");
    refused(&["sweep", "sweep.toml", "s1"], "found s1; expected no more arguments");
    refused(&["sweep", "latch", "--shard", "1/2"], "found --shard 1/2; expected a file");
    refused(&["sweep", "merge", "sweep.toml", "s1", "--shard", "1/2"], "found --shard 1/2");
    refused(&["sweep", "sweep.toml", "--shard", "3/2"], "found `3/2`; expected I/N");
}
