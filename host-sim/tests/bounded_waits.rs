//! Either side goes at a random moment, 200 times: nothing hangs, the error tells the last sample that was answered and why there are no more, and
//! whoever comes next finds things in order.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

#[path = "twin/trial.rs"]
mod trial;
mod twin;

use host_sim::controller::{
    AttachedController, Bounds, Controller, ControllerError, NativeController, RemoteController,
};
use host_sim::estimator::{bit_differences, track};
use rustix::process::{Pid, Signal, kill_process};
use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use trial::{SAMPLES, gone_on, stopped};
use twin::{CONFIGURATION, Plan, Random, Trouble, Twin, frames};

const SEEDS: u64 = 200;
/// Seeds at once; most of a trial is waiting.
const AT_ONCE: u64 = 10;
/// Long enough for a twin on a busy machine.
const BOUNDS: Bounds = Bounds { answer: Duration::from_millis(1_500), again: Duration::from_millis(100) };
/// Likely causes that the errors name.
const UNPLUGGED: &str = "may have been unplugged";
const SILENT: &str = "may be wrong, or the firmware hang";
const RESTARTED: &str = "it does not say why";

#[test]
fn whoever_goes_at_whatever_moment_nothing_hangs_and_the_error_says_where_and_why() {
    std::thread::scope(|scope| {
        for first in 0..AT_ONCE {
            scope.spawn(move || (first..SEEDS).step_by(AT_ONCE as usize).for_each(try_seed));
        }
    });
}

fn try_seed(seed: u64) {
    let mut random = Random(seed);
    // The samples after the trouble too: an answer of 54 bytes, so many of which still come.
    let plan = |random: &mut Random, trouble| Plan {
        at: random.below(u64::from(SAMPLES)) as u32,
        bytes: random.below(60) as usize,
        trouble,
    };
    match random.below(4) {
        0 => {
            let plan = plan(&mut random, Trouble::Dies);
            let (controller, _twin) = started(plan);
            stopped(controller, seed, plan, |e| matches!(e, ControllerError::Ended { .. }), UNPLUGGED);
        }
        1 => {
            let plan = plan(&mut random, Trouble::FallsSilent);
            let (controller, _twin) = started(plan);
            stopped(controller, seed, plan, |e| matches!(e, ControllerError::TimedOut { .. }), SILENT);
        }
        2 => {
            let plan = plan(&mut random, Trouble::Restarts);
            let (controller, _twin) = started(plan);
            stopped(controller, seed, plan, |e| matches!(e, ControllerError::Restarted { .. }), RESTARTED);
            let (controller, _twin) = started(plan);
            gone_on(controller, seed, plan);
        }
        _ => host_gone(seed, random.below(u64::from(SAMPLES)) as usize, random.below(40) as usize),
    }
}

/// A twin with a plan, and the controller configured at it.
fn started(plan: Plan) -> (RemoteController, Twin) {
    let twin = Twin::start(vec![plan], 1);
    let mut controller = AttachedController::open_within(&twin.port, BOUNDS).unwrap();
    controller.configure(CONFIGURATION).unwrap();
    (controller, twin)
}

/// The host goes after some samples and some bytes of the next; the next host's run is as any other.
fn host_gone(seed: u64, samples: usize, bytes: usize) {
    let frames = frames(SAMPLES, seed);
    let twin = Twin::start(vec![], 1);
    let mut first = AttachedController::open_within(&twin.port, BOUNDS).unwrap();
    first.configure(CONFIGURATION).unwrap();
    for frame in &frames[..samples] {
        first.exchange(frame).unwrap();
    }
    drop(first);
    let mut port = std::fs::File::options().write(true).open(&twin.port).unwrap();
    port.write_all(&vec![0x21; bytes]).unwrap();
    drop(port);
    let mut second = AttachedController::open_within(&twin.port, BOUNDS).unwrap();
    second.configure(CONFIGURATION).unwrap();
    let there = track(Box::new(second), &frames).unwrap();
    let here = track(Box::new(NativeController::start(CONFIGURATION).unwrap()), &frames).unwrap();
    assert_eq!(bit_differences(&there, &here), 0, "seed {seed}");
}

fn host_sim(folder: &Path, port: &Path, more: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .current_dir(folder)
        .args(["run", "--force", "law", "--controller", "attached", "--record", "out/run/link.rec", "--json"])
        .arg("--port")
        .arg(port)
        .args(more)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

#[test]
fn a_killed_host_leaves_whole_files_or_none_and_the_next_one_runs_as_ever() {
    let folder = tempfile::tempdir().unwrap();
    let twin = Twin::start(vec![], 1);
    let mut random = Random(99);
    for _ in 0..4 {
        let mut host = host_sim(folder.path(), &twin.port, &[]);
        // Somewhere between its start and its end.
        let samples = twin.samples.load(Ordering::Relaxed) + random.below(9_000) as u32;
        let started = Instant::now();
        while twin.samples.load(Ordering::Relaxed) < samples && started.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_micros(200));
        }
        kill_process(Pid::from_child(&host), Signal::KILL).unwrap();
        host.wait().unwrap();
        assert!(!folder.path().join("out").exists(), "left something behind");
    }
    let output = host_sim(folder.path(), &twin.port, &[]).wait_with_output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let estimator = summary.get("estimator").unwrap();
    let number = |name: &str| estimator.get(name).and_then(serde_json::Value::as_u64);
    assert_eq!(number("ticks"), Some(10_000));
    assert_eq!(number("native_attached_bit_differences"), Some(0));
    assert_eq!(number("restarts"), Some(0));
    for name in ["run.json", "log.csv", "report.html", "link.rec"] {
        assert!(folder.path().join("out/run").join(name).exists(), "{name}");
    }
}

#[test]
fn a_controller_that_goes_or_restarts_in_the_middle_ends_the_command_with_1_and_no_files() {
    for (trouble, expected) in
        [(Trouble::Dies, "the port is closed"), (Trouble::Restarts, "the controller restarted")]
    {
        let folder = tempfile::tempdir().unwrap();
        let twin = Twin::start(vec![Plan { at: 5_000, bytes: 10, trouble }], 1);
        let output = host_sim(folder.path(), &twin.port, &[]).wait_with_output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{text}");
        assert!(text.contains(expected) && text.contains("last sequence number answered: 4999"), "{text}");
        assert!(!folder.path().join("out").exists(), "left something behind");
    }
    let folder = tempfile::tempdir().unwrap();
    let twin = Twin::start(vec![Plan { at: 5_000, bytes: 10, trouble: Trouble::Restarts }], 1);
    let output =
        host_sim(folder.path(), &twin.port, &["--on-restart", "continue"]).wait_with_output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let number =
        |name: &str| summary.pointer(&format!("/estimator/{name}")).and_then(serde_json::Value::as_u64);
    assert_eq!((number("restarts"), number("native_attached_bit_differences")), (Some(1), Some(0)));
}
