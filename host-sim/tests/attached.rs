//! The attached controller over a serial port. A software twin on a pseudo-terminal gives the
//! native controller's results bit by bit. A bad line does not change them and does not delay the
//! host.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

mod twin;

use host_sim::controller::{
    AttachedController, Controller, ControllerError, NativeController, RemoteController, Timeouts,
};
use host_sim::run::exchange::{
    ExchangeResult, OnRestart, bit_differences, exchange, exchange_observed, exchange_with_restarts,
};
use link::authentication::LinkKey;
use link::{Command, Refusal, SensorFrame};
use std::path::Path;
use std::time::{Duration, Instant};
use twin::{CONFIGURATION, Plan, Trouble, Twin, frames};

const TIMEOUTS: Timeouts = Timeouts { answer: Duration::from_secs(30), retry: Duration::from_millis(100) };
/// Timeouts of a line without losses: nothing is sent again, however busy the machine.
const UNHURRIED: Timeouts = Timeouts { answer: Duration::from_secs(30), retry: Duration::from_secs(20) };

fn attached_within(port: &Path, bounds: Timeouts) -> RemoteController {
    let mut controller = AttachedController::open_with(port, bounds).unwrap();
    controller.configure(CONFIGURATION).unwrap();
    controller
}

fn attached(port: &Path) -> RemoteController {
    attached_within(port, TIMEOUTS)
}

fn native(frames: &[SensorFrame]) -> ExchangeResult {
    exchange(Box::new(NativeController::start(CONFIGURATION).unwrap()), frames).unwrap()
}

/// A run over a twin with troubles, with the losses that the host counted.
fn disturbed(
    frames: &[SensorFrame],
    plan: Vec<Plan>,
    hello_count: usize,
) -> Result<ExchangeResult, ControllerError> {
    let twin = Twin::start(plan, hello_count);
    exchange(Box::new(attached(&twin.port)), frames)
}

fn assert_same(a: &ExchangeResult, b: &ExchangeResult) {
    assert_eq!(bit_differences(a, b), 0);
    assert_eq!(a.counters.samples, b.counters.samples);
    assert_eq!(a.counters.flagged, b.counters.flagged);
}

#[test]
fn estimates_and_counts_are_those_of_the_native_controller() {
    let frames = frames(3_000, 1);
    let twin = Twin::start(vec![], 1);
    let there = exchange(Box::new(attached_within(&twin.port, UNHURRIED)), &frames).unwrap();
    let here = native(&frames);
    assert_same(&there, &here);
    assert_eq!(there.counters, here.counters);
    assert!(here.estimates.iter().filter(|e| e.normal_force_n > 100.0).count() > 500, "contacts");
    println!("{:.0} exchanges a second", frames.len() as f64 / there.wall_s);
}

#[test]
fn a_repeated_hello_does_not_end_the_run() {
    let frames = frames(50, 2);
    assert_same(&disturbed(&frames, vec![], 3).unwrap(), &native(&frames));
}

#[test]
fn a_lost_or_damaged_sample_is_sent_again_and_changes_nothing() {
    let frames = frames(200, 3);
    for trouble in [Trouble::SampleLost, Trouble::SampleDamaged, Trouble::Noise] {
        // Two in a row, the first, and a single one. The second transmission of a lost sample
        // counts as well.
        let plan = [0, 50, 51, 120].map(|at| Plan { at, bytes: 7, trouble }).to_vec();
        assert_same(&disturbed(&frames, plan, 1).unwrap(), &native(&frames));
    }
}

#[test]
fn a_lost_estimate_ends_the_run_at_once_and_is_named() {
    let plan = vec![Plan { at: 30, bytes: 0, trouble: Trouble::EstimateLost }];
    let started = Instant::now();
    let error = disturbed(&frames(100, 4), plan, 1).unwrap_err();
    assert!(started.elapsed() < TIMEOUTS.answer, "{:?}", started.elapsed());
    assert!(
        matches!(error, ControllerError::Lost { sequence: 30, last_sequence: Some(29), .. }),
        "{error:?}"
    );
}

#[test]
fn other_messages_do_not_extend_the_timeout() {
    let plan = vec![Plan { at: 30, bytes: 3, trouble: Trouble::Raves }];
    let twin = Twin::start(plan, 1);
    let bounds = Timeouts { answer: Duration::from_secs(2), ..TIMEOUTS };
    let started = Instant::now();
    let error = exchange(Box::new(attached_within(&twin.port, bounds)), &frames(100, 5)).unwrap_err();
    assert!(started.elapsed() < 10 * bounds.answer, "{:?}", started.elapsed());
    assert!(matches!(error, ControllerError::TimedOut { last_sequence: Some(29), .. }), "{error:?}");
}

#[test]
fn a_restart_ends_or_continues_the_run_as_requested() {
    let frames = frames(400, 6);
    // The hello of the first restart arrives alone, that of the second after the beginning of an
    // estimate, and that of the third is lost.
    let mut plan =
        [(100, 0), (250, 20), (350, 20)].map(|(at, bytes)| Plan { at, bytes, trouble: Trouble::Restarts });
    plan[2].trouble = Trouble::RestartsUnheard;
    let error = disturbed(&frames, plan.to_vec(), 1).unwrap_err();
    assert!(matches!(error, ControllerError::Restarted { last_sequence: Some(99), .. }), "{error:?}");

    let twin = Twin::start(plan.to_vec(), 1);
    let controller = Box::new(attached(&twin.port));
    let there = exchange_observed(controller, CONFIGURATION, &frames, OnRestart::Continue, None).unwrap();
    // The samples in transit at the first two restarts reach the twin twice.
    assert_eq!(there.restarts, [100, 249, 348]);
    let here = Box::new(NativeController::start(CONFIGURATION).unwrap());
    let here = exchange_with_restarts(here, CONFIGURATION, &frames, &there.restarts).unwrap();
    assert_same(&there, &here);
}

#[test]
fn a_hello_after_half_a_frame_is_received_at_once() {
    let plan = vec![Plan { at: 30, bytes: 20, trouble: Trouble::Restarts }];
    let twin = Twin::start(plan, 1);
    let controller = attached_within(&twin.port, UNHURRIED);
    let started = Instant::now();
    let error = exchange(Box::new(controller), &frames(100, 10)).unwrap_err();
    assert!(matches!(error, ControllerError::Restarted { last_sequence: Some(29), .. }), "{error:?}");
    assert!(started.elapsed() < UNHURRIED.retry, "{:?}", started.elapsed());
}

#[test]
fn a_controller_that_keeps_restarting_ends_the_run() {
    let plan = (10..40).map(|at| Plan { at, bytes: 0, trouble: Trouble::Restarts }).collect();
    let twin = Twin::start(plan, 1);
    let run = exchange_observed(
        Box::new(attached(&twin.port)),
        CONFIGURATION,
        &frames(60, 7),
        OnRestart::Continue,
        None,
    );
    let error = run.unwrap_err();
    assert!(matches!(error, ControllerError::Restarted { last_sequence: Some(9), .. }), "{error:?}");
    assert!(error.to_string().contains("last sequence number answered: 9"), "{error}");
}

#[test]
fn a_host_that_ended_in_the_middle_of_a_frame_does_not_disturb_the_next() {
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
    let second = attached_within(&twin.port, UNHURRIED);
    assert!(started.elapsed() < UNHURRIED.retry, "{:?}", started.elapsed());
    assert_same(&exchange(Box::new(second), &frames).unwrap(), &native(&frames));
}

#[test]
fn command_numbers_of_an_earlier_host_are_not_taken_for_a_restart() {
    let twin = Twin::start(vec![], 1);
    let mut first = attached(&twin.port);
    for _ in 0..5 {
        first.order(Command::GetCounters).unwrap();
    }
    drop(first);
    let frames = frames(20, 9);
    assert_same(&exchange(Box::new(attached(&twin.port)), &frames).unwrap(), &native(&frames));
}

#[test]
fn a_missing_or_wrong_port_is_an_input_error() {
    let file = tempfile::NamedTempFile::new().unwrap();
    for port in [Path::new("/no/such/port"), file.path()] {
        let error = AttachedController::open(port).err().unwrap();
        assert!(matches!(error, ControllerError::Port { .. }), "{error:?}");
        assert!(error.to_string().starts_with(&port.display().to_string()), "{error}");
    }
}

const KEY: LinkKey = LinkKey::new([3; 32]);

#[test]
fn a_controller_with_a_key_serves_the_host_that_has_it_also_after_restarts() {
    let frames = frames(400, 6);
    let plan = vec![
        Plan { at: 100, bytes: 0, trouble: Trouble::Restarts },
        Plan { at: 200, bytes: 0, trouble: Trouble::RestartsUnheard },
    ];
    let run = |key| {
        let twin = Twin::start_with_key(key, plan.clone(), 1);
        let mut host = AttachedController::open_with(&twin.port, TIMEOUTS).unwrap().with_key(key);
        host.configure(CONFIGURATION).unwrap();
        exchange_observed(Box::new(host), CONFIGURATION, &frames, OnRestart::Continue, None).unwrap()
    };
    let (with_key, without) = (run(Some(KEY)), run(None));
    assert_eq!(with_key.restarts.len(), 2);
    assert_same(&with_key, &without);
}

#[test]
fn without_its_key_a_controller_can_be_asked_but_not_commanded() {
    let twin = Twin::start_with_key(Some(KEY), vec![], 1);
    for key in [None, Some(LinkKey::new([4; 32]))] {
        let mut host = AttachedController::open_with(&twin.port, TIMEOUTS).unwrap().with_key(key);
        let error = host.configure(CONFIGURATION).unwrap_err();
        let is_expected = match key {
            None => matches!(error, ControllerError::Refused(Refusal::NotAuthenticated)),
            Some(_) => matches!(error, ControllerError::WrongKey),
        };
        assert!(is_expected, "{error:?}");
        if key.is_none() {
            assert!(error.to_string().contains("--link-key"), "{error}");
            host.order(Command::GetCounters).unwrap();
        }
    }
    let mut host = AttachedController::open_with(&twin.port, TIMEOUTS).unwrap().with_key(Some(KEY));
    host.configure(CONFIGURATION).unwrap();
}

#[test]
fn a_key_for_a_controller_that_requires_none_is_refused_before_a_command_is_sent() {
    let twin = Twin::start(vec![], 1);
    let mut host = AttachedController::open_with(&twin.port, TIMEOUTS).unwrap().with_key(Some(KEY));
    let error = host.configure(CONFIGURATION).unwrap_err();
    assert!(matches!(error, ControllerError::NeedlessKey), "{error:?}");
    assert!(error.to_string().contains("--link-key"), "{error}");
    host.order(Command::GetCounters).unwrap();
}
