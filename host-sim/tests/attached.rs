//! The attached controller over a serial port: a software twin on a pseudo-terminal gives what the native controller gives, to the bit, and a bad
//! line neither changes that nor holds the host up.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

mod twin;

use host_sim::controller::{
    AttachedController, Bounds, Controller, ControllerError, NativeController, RemoteController,
};
use host_sim::estimator::{OnRestart, Tracked, bit_differences, track, track_restarting, track_through};
use link::{Command, SensorFrame};
use std::path::Path;
use std::time::{Duration, Instant};
use twin::{CONFIGURATION, Plan, Trouble, Twin, frames};

const BOUNDS: Bounds = Bounds { answer: Duration::from_secs(2), again: Duration::from_millis(100) };

fn attached(port: &Path) -> RemoteController {
    let mut controller = AttachedController::open_within(port, BOUNDS).unwrap();
    controller.configure(CONFIGURATION).unwrap();
    controller
}

fn native(frames: &[SensorFrame]) -> Tracked {
    track(Box::new(NativeController::start(CONFIGURATION).unwrap()), frames).unwrap()
}

/// A run over a twin with troubles, and what the host counted as lost.
fn troubled(frames: &[SensorFrame], plan: Vec<Plan>, greetings: usize) -> Result<Tracked, ControllerError> {
    let twin = Twin::start(plan, greetings);
    track(Box::new(attached(&twin.port)), frames)
}

fn assert_same(a: &Tracked, b: &Tracked) {
    assert_eq!(bit_differences(a, b), 0);
    assert_eq!(a.counters.samples, b.counters.samples);
    assert_eq!(a.counters.flagged, b.counters.flagged);
}

#[test]
fn estimates_and_counts_are_those_of_the_native_controller() {
    let frames = frames(3_000, 1);
    let there = troubled(&frames, vec![], 1).unwrap();
    let here = native(&frames);
    assert_same(&there, &here);
    assert_eq!(there.counters, here.counters);
    assert!(here.estimates.iter().filter(|e| e.normal_force_n > 100.0).count() > 500, "contacts");
    println!("{:.0} exchanges a second", frames.len() as f64 / there.wall_s);
}

#[test]
fn a_greeting_that_comes_twice_does_not_end_the_run() {
    let frames = frames(50, 2);
    assert_same(&troubled(&frames, vec![], 3).unwrap(), &native(&frames));
}

#[test]
fn a_lost_or_damaged_sample_is_sent_again_and_changes_nothing() {
    let frames = frames(200, 3);
    for trouble in [Trouble::SampleLost, Trouble::SampleDamaged, Trouble::Noise] {
        // Two in a row, the first, and one by itself. The second sending of a lost sample counts as well.
        let plan = [0, 50, 51, 120].map(|at| Plan { at, bytes: 7, trouble }).to_vec();
        assert_same(&troubled(&frames, plan, 1).unwrap(), &native(&frames));
    }
}

#[test]
fn a_lost_estimate_ends_the_run_at_once_and_is_named() {
    let plan = vec![Plan { at: 30, bytes: 0, trouble: Trouble::EstimateLost }];
    let started = Instant::now();
    let error = troubled(&frames(100, 4), plan, 1).unwrap_err();
    assert!(started.elapsed() < Duration::from_secs(1), "{:?}", started.elapsed());
    assert!(
        matches!(error, ControllerError::Lost { sequence: 30, last_sequence: Some(29), .. }),
        "{error:?}"
    );
}

#[test]
fn a_controller_that_speaks_of_other_things_only_is_given_up_at_the_bound() {
    let plan = vec![Plan { at: 30, bytes: 3, trouble: Trouble::Raves }];
    let started = Instant::now();
    let error = troubled(&frames(100, 5), plan, 1).unwrap_err();
    assert!(started.elapsed() < Duration::from_secs(4), "{:?}", started.elapsed());
    assert!(matches!(error, ControllerError::TimedOut { last_sequence: Some(29), .. }), "{error:?}");
}

#[test]
fn a_restart_ends_the_run_or_is_gone_on_from_as_asked() {
    let frames = frames(400, 6);
    // The greeting of the first comes by itself, that of the second behind the beginning of an estimate, that of the third not at all.
    let mut plan =
        [(100, 0), (250, 20), (350, 20)].map(|(at, bytes)| Plan { at, bytes, trouble: Trouble::Restarts });
    plan[2].trouble = Trouble::RestartsUnheard;
    let error = troubled(&frames, plan.to_vec(), 1).unwrap_err();
    assert!(matches!(error, ControllerError::Restarted { last_sequence: Some(99), .. }), "{error:?}");

    let twin = Twin::start(plan.to_vec(), 1);
    let controller = Box::new(attached(&twin.port));
    let there = track_through(controller, CONFIGURATION, &frames, OnRestart::Continue).unwrap();
    // The samples on the way at the first two come to the twin twice.
    assert_eq!(there.restarts, [100, 249, 348]);
    let here = Box::new(NativeController::start(CONFIGURATION).unwrap());
    let here = track_restarting(here, CONFIGURATION, &frames, &there.restarts).unwrap();
    assert_same(&there, &here);
}

#[test]
fn a_greeting_behind_half_a_frame_is_heard_at_once() {
    let plan = vec![Plan { at: 30, bytes: 20, trouble: Trouble::Restarts }];
    let twin = Twin::start(plan, 1);
    let unhurried = Bounds { answer: Duration::from_secs(30), again: Duration::from_secs(20) };
    let mut controller = AttachedController::open_within(&twin.port, unhurried).unwrap();
    controller.configure(CONFIGURATION).unwrap();
    let started = Instant::now();
    let error = track(Box::new(controller), &frames(100, 10)).unwrap_err();
    assert!(matches!(error, ControllerError::Restarted { last_sequence: Some(29), .. }), "{error:?}");
    assert!(started.elapsed() < unhurried.again, "{:?}", started.elapsed());
}

#[test]
fn a_controller_that_restarts_again_and_again_is_given_up() {
    let plan = (10..40).map(|at| Plan { at, bytes: 0, trouble: Trouble::Restarts }).collect();
    let twin = Twin::start(plan, 1);
    let run =
        track_through(Box::new(attached(&twin.port)), CONFIGURATION, &frames(60, 7), OnRestart::Continue);
    let error = run.unwrap_err();
    assert!(matches!(error, ControllerError::Restarted { last_sequence: Some(9), .. }), "{error:?}");
    assert!(error.to_string().contains("last sequence number answered: 9"), "{error}");
}

#[test]
fn a_host_that_went_in_the_middle_of_a_frame_leaves_nothing_behind() {
    use std::io::Write;
    let frames = frames(120, 8);
    let twin = Twin::start(vec![], 1);
    let mut first = attached(&twin.port);
    for frame in &frames[..50] {
        first.exchange(frame).unwrap();
    }
    drop(first);
    let mut port = std::fs::File::options().write(true).open(&twin.port).unwrap();
    port.write_all(&[9, 1, 2, 3]).unwrap();
    drop(port);
    let started = Instant::now();
    let second = attached(&twin.port);
    assert!(started.elapsed() < Duration::from_secs(1), "{:?}", started.elapsed());
    assert_same(&track(Box::new(second), &frames).unwrap(), &native(&frames));
}

#[test]
fn two_hosts_do_not_take_each_other_for_a_restart_of_the_command_numbers() {
    let twin = Twin::start(vec![], 1);
    let mut first = attached(&twin.port);
    for _ in 0..5 {
        first.order(Command::GetCounters).unwrap();
    }
    drop(first);
    let frames = frames(20, 9);
    assert_same(&track(Box::new(attached(&twin.port)), &frames).unwrap(), &native(&frames));
}

#[test]
fn a_port_that_is_none_is_the_users_error() {
    let file = tempfile::NamedTempFile::new().unwrap();
    for port in [Path::new("/no/such/port"), file.path()] {
        let error = AttachedController::open(port).err().unwrap();
        assert!(matches!(error, ControllerError::Port { .. }), "{error:?}");
        assert!(error.to_string().starts_with(&port.display().to_string()), "{error}");
    }
}
