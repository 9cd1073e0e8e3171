//! Host or controller ends at a random moment, 200 times: nothing hangs, the error names the last
//! answered sample and the cause, and the next host or controller works normally.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

#[path = "twin/trial.rs"]
mod trial;
mod twin;

use host_sim::controller::{
    AttachedController, Controller, ControllerError, NativeController, RemoteController, Timeouts,
};
use host_sim::run::exchange::{bit_differences, exchange};
use rustix::process::{Pid, Signal, kill_process};
use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use trial::{SAMPLES, continued, stopped};
use twin::{CONFIGURATION, Plan, Random, Trouble, Twin, frames};

const SEEDS: u64 = 200;
/// Number of seeds tried in parallel; a trial mostly waits.
const AT_ONCE: u64 = 10;
/// Long enough for a twin on a busy machine.
const TIMEOUTS: Timeouts = Timeouts { answer: Duration::from_secs(4), retry: Duration::from_millis(100) };
/// Likely causes that the errors name.
const UNPLUGGED: &str = "may have been unplugged";
const SILENT: &str = "may be wrong, or the firmware may hang";
const RESTARTED: &str = "reason not reported";

#[test]
fn a_fault_at_any_moment_ends_in_time_with_the_place_and_the_cause() {
    std::thread::scope(|scope| {
        for first in 0..AT_ONCE {
            scope.spawn(move || (first..SEEDS).step_by(AT_ONCE as usize).for_each(try_seed));
        }
    });
}

fn try_seed(seed: u64) {
    let mut random = Random(seed);
    // An answer has 54 bytes; the trouble occurs after a random number of them.
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
            continued(controller, seed, plan);
        }
        _ => host_gone(seed, random.below(u64::from(SAMPLES)) as usize, random.below(40) as usize),
    }
}

/// Starts a twin with a plan and configures the controller attached to it.
fn started(plan: Plan) -> (RemoteController, Twin) {
    let twin = Twin::start(vec![plan], 1);
    let mut controller = AttachedController::open_with(&twin.port, TIMEOUTS).unwrap();
    controller.configure(CONFIGURATION).unwrap();
    (controller, twin)
}

/// The host ends after some samples and some bytes of the next one; the run of the next host is
/// normal.
fn host_gone(seed: u64, samples: usize, bytes: usize) {
    let frames = frames(SAMPLES, seed);
    let twin = Twin::start(vec![], 1);
    let mut first = AttachedController::open_with(&twin.port, TIMEOUTS).unwrap();
    first.configure(CONFIGURATION).unwrap();
    for frame in &frames[..samples] {
        first.exchange(frame).unwrap();
    }
    drop(first);
    let mut port = std::fs::File::options().write(true).open(&twin.port).unwrap();
    port.write_all(&vec![0x21; bytes]).unwrap();
    drop(port);
    let mut second = AttachedController::open_with(&twin.port, TIMEOUTS).unwrap();
    second.configure(CONFIGURATION).unwrap();
    let there = exchange(Box::new(second), &frames).unwrap();
    let here = exchange(Box::new(NativeController::start(CONFIGURATION).unwrap()), &frames).unwrap();
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
fn a_killed_host_leaves_complete_files_or_none_and_the_next_host_works() {
    let folder = tempfile::tempdir().unwrap();
    let twin = Twin::start(vec![], 1);
    let mut random = Random(99);
    for _ in 0..4 {
        let mut host = host_sim(folder.path(), &twin.port, &[]);
        // A random moment between the start and the end of the run.
        let samples = twin.samples.load(Ordering::Relaxed) + random.below(9_000) as u32;
        let started = Instant::now();
        while twin.samples.load(Ordering::Relaxed) < samples && started.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_micros(200));
        }
        kill_process(Pid::from_child(&host), Signal::KILL).unwrap();
        host.wait().unwrap();
        assert!(!folder.path().join("out").exists(), "left output");
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
fn a_controller_that_ends_or_restarts_gives_exit_code_1_and_no_files() {
    for (trouble, expected) in
        [(Trouble::Dies, "the port is closed"), (Trouble::Restarts, "the controller restarted")]
    {
        let folder = tempfile::tempdir().unwrap();
        let twin = Twin::start(vec![Plan { at: 5_000, bytes: 10, trouble }], 1);
        let output = host_sim(folder.path(), &twin.port, &[]).wait_with_output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{text}");
        assert!(text.contains(expected) && text.contains("last sequence number answered: 4999"), "{text}");
        assert!(!folder.path().join("out").exists(), "left output");
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
