//! The board goes, hangs, restarts, or loses its host: the run ends with the reason, or goes on where it can.

use crate::board::{Board, PATIENT, frames, native};
use firmware::configuration::BENCH_B;
use host_sim::controller::{BOUNDS, Bounds, Controller, ControllerError, NativeController};
use host_sim::estimator::{OnRestart, bit_differences, track, track_restarting, track_through};
use link::SensorFrame;
use rustix::process::Signal;
use std::thread;
use std::time::{Duration, Instant};

/// Runs until something goes wrong; the last sample that was answered, the error, and how long the last exchange took.
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

/// Does something to a board some time after the first sample.
fn after(
    board: &Board,
    bounds: Bounds,
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

fn tells(error: &ControllerError, last: Option<u32>) {
    let told = last.map_or_else(|| "none".into(), |last| last.to_string());
    let text = error.to_string();
    assert!(text.contains(&format!("last sequence number answered: {told}")), "{text}");
}

#[test]
fn a_killed_board_is_noticed_at_once() {
    for delay_ms in [37, 151, 402] {
        let board = Board::start();
        let (last, error, took) =
            after(&board, PATIENT, Duration::from_millis(delay_ms), |board| board.signal(Signal::KILL));
        assert!(matches!(error, ControllerError::Ended { .. }), "{error:?}");
        assert!(took < Duration::from_secs(2), "{took:?}");
        tells(&error, last);
    }
}

#[test]
fn a_board_that_hangs_is_given_up_at_the_bound() {
    let board = Board::start();
    let (last, error, took) =
        after(&board, BOUNDS, Duration::from_millis(220), |board| board.signal(Signal::STOP));
    assert!(matches!(error, ControllerError::TimedOut { waiting_for: "a sample", .. }), "{error:?}");
    assert!(took < Duration::from_secs(8), "{took:?}");
    tells(&error, last);
}

#[test]
fn a_reset_board_is_noticed_and_gone_on_with_if_asked() {
    let board = Board::start();
    let (last, error, took) =
        after(&board, PATIENT, Duration::from_millis(250), |board| board.monitor("system_reset"));
    assert!(matches!(error, ControllerError::Restarted { .. }), "{error:?}");
    assert!(took < Duration::from_secs(20), "{took:?}");
    tells(&error, last);

    let frames = frames(1_500, 4);
    let controller = Box::new(board.attached());
    let there = thread::scope(|scope| {
        scope.spawn(|| {
            thread::sleep(Duration::from_millis(300));
            board.monitor("system_reset");
        });
        track_through(controller, BENCH_B, &frames, OnRestart::Continue).unwrap()
    });
    assert_eq!(there.restarts.len(), 1);
    let here = Box::new(NativeController::start(BENCH_B).unwrap());
    assert_eq!(
        bit_differences(&there, &track_restarting(here, BENCH_B, &frames, &there.restarts).unwrap()),
        0
    );
}

#[test]
fn a_host_that_went_leaves_the_board_to_the_next_one() {
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
            bit_differences(&track(Box::new(board.attached()), &frames).unwrap(), &native(&frames)),
            0
        );
    }
}
