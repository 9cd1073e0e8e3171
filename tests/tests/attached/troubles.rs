//! A board that ends, hangs or restarts, or loses its host: the run ends with the reason, or
//! continues if possible.

use crate::board::{Board, PATIENT, frames, native};
use controller::configuration::BENCH_B;
use host_sim::controller::{Controller, ControllerError, NativeController, TIMEOUTS, Timeouts};
use host_sim::run::exchange::{
    OnRestart, bit_differences, exchange, exchange_observed, exchange_with_restarts,
};
use link::SensorFrame;
use rustix::process::Signal;
use std::thread;
use std::time::{Duration, Instant};

/// Runs until an error; returns the last answered sample, the error, and the duration of the last
/// exchange.
fn until_it_fails(
    controller: &mut dyn Controller,
    frames: &[SensorFrame],
) -> (Option<u32>, ControllerError, Duration) {
    let mut last = None;
    for frame in frames {
        let started = Instant::now();
        match controller.exchange(frame) {
            Ok(estimate) => last = Some(estimate.sequence),
            Err(error) => return (last, error, started.elapsed()),
        }
    }
    panic!("nothing went wrong");
}

/// Runs an action on a board some time after the first sample.
fn after(
    board: &Board,
    bounds: Timeouts,
    delay: Duration,
    what: impl FnOnce(&Board) + Send,
) -> (Option<u32>, ControllerError, Duration) {
    let mut controller = board.attached_within(bounds);
    thread::scope(|scope| {
        scope.spawn(|| {
            thread::sleep(delay);
            what(board);
        });
        until_it_fails(&mut controller, &frames(20_000, 3))
    })
}

fn assert_last_sample(error: &ControllerError, last: Option<u32>) {
    let last = last.map_or_else(|| "none".into(), |last| last.to_string());
    let text = error.to_string();
    assert!(text.contains(&format!("last sequence number answered: {last}")), "{text}");
}

#[test]
fn a_killed_board_is_an_error_at_once() {
    for delay_ms in [37, 151, 402] {
        let board = Board::start();
        let (last, error, took) =
            after(&board, PATIENT, Duration::from_millis(delay_ms), |board| board.signal(Signal::KILL));
        assert!(matches!(error, ControllerError::Ended { .. }), "{error:?}");
        assert!(took < Duration::from_secs(2), "{took:?}");
        assert_last_sample(&error, last);
    }
}

#[test]
fn a_board_that_hangs_times_out() {
    let board = Board::start();
    let (last, error, took) =
        after(&board, TIMEOUTS, Duration::from_millis(220), |board| board.signal(Signal::STOP));
    assert!(matches!(error, ControllerError::TimedOut { waiting_for: "a sample", .. }), "{error:?}");
    assert!(took < Duration::from_secs(8), "{took:?}");
    assert_last_sample(&error, last);
}

#[test]
fn a_reset_board_is_an_error_or_the_run_continues_on_request() {
    let board = Board::start();
    let (last, error, took) =
        after(&board, PATIENT, Duration::from_millis(250), |board| board.monitor("system_reset"));
    assert!(matches!(error, ControllerError::Restarted { .. }), "{error:?}");
    assert!(took < Duration::from_secs(20), "{took:?}");
    assert_last_sample(&error, last);

    let frames = frames(1_500, 4);
    let controller = Box::new(board.attached());
    let there = thread::scope(|scope| {
        scope.spawn(|| {
            thread::sleep(Duration::from_millis(300));
            board.monitor("system_reset");
        });
        exchange_observed(controller, BENCH_B, &frames, OnRestart::Continue, None).unwrap()
    });
    assert_eq!(there.restarts.len(), 1);
    let here = Box::new(NativeController::start(BENCH_B).unwrap());
    assert_eq!(
        bit_differences(&there, &exchange_with_restarts(here, BENCH_B, &frames, &there.restarts).unwrap()),
        0
    );
}

#[test]
fn a_board_serves_the_next_host_after_one_that_left() {
    use std::io::Write;
    let board = Board::start();
    let frames = frames(200, 5);
    for went_after in [1, 60] {
        let mut first = board.attached();
        for frame in &frames[..went_after] {
            first.exchange(frame).unwrap();
        }
        drop(first);
        let mut port = std::fs::File::options().write(true).open(&board.port).unwrap();
        port.write_all(&[30, 1, 2]).unwrap();
        drop(port);
        assert_eq!(
            bit_differences(&exchange(Box::new(board.attached()), &frames).unwrap(), &native(&frames)),
            0
        );
    }
}
