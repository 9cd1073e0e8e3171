//! The attached controller through a probe, with a software twin at the other end of the ring
//! buffers. The results equal the native controller's bit by bit. Every failure, at any moment,
//! ends the run in time with a named cause.

use crate::memory::probe_at;
use crate::rings::{Board, Rings};
use crate::trial::{MAX_DURATION, SAMPLES, continued, stopped};
use crate::twin::{CONFIGURATION, Plan, Random, Trouble, Twin, frames};
use controller::boards::parse as parse_board;
use host_sim::controller::{
    Controller, ControllerError, EmulatedController, NativeController, ProbedController, RemoteController,
    Timeouts,
};
use host_sim::run::exchange::{ExchangeResult, bit_differences, exchange};
use link::SensorFrame;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Long enough for a twin on a busy machine.
pub(crate) const TIMEOUTS: Timeouts =
    Timeouts { answer: Duration::from_millis(1_500), retry: Duration::from_millis(100) };
/// Likely causes that the errors name.
const UNPLUGGED: &str = "may have been unplugged";
const HALTED: &str = "may be halted";
const RESTARTED: &str = "reason not reported";
const SEEDS: u64 = 80;
const AT_ONCE: u64 = 8;

fn opened(at: &Arc<Board>) -> Result<RemoteController, ControllerError> {
    let image = EmulatedController::default_elf();
    ProbedController::through(
        probe_at(Arc::clone(at), true),
        parse_board("stm32f405").unwrap(),
        &image,
        TIMEOUTS,
    )
}

fn configured(at: &Arc<Board>) -> RemoteController {
    let mut controller = opened(at).unwrap();
    controller.configure(CONFIGURATION).unwrap();
    controller
}

fn started(plan: Vec<Plan>) -> (Arc<Board>, Twin) {
    let board = Arc::new(Board::new());
    let twin = Twin::at(Rings(Arc::clone(&board)), plan, 1);
    (board, twin)
}

fn native(frames: &[SensorFrame]) -> ExchangeResult {
    exchange(Box::new(NativeController::start(CONFIGURATION).unwrap()), frames).unwrap()
}

#[test]
fn a_conversation_is_that_with_the_native_controller() {
    let frames = frames(1_000, 1);
    let (board, _twin) = started(vec![]);
    let there = exchange(Box::new(configured(&board)), &frames).unwrap();
    let here = native(&frames);
    assert_eq!(bit_differences(&there, &here), 0);
    assert_eq!(there.counters, here.counters);
    assert!(here.estimates.iter().filter(|e| e.normal_force_n > 100.0).count() > 100, "contacts");
}

#[test]
fn a_lost_or_damaged_sample_is_sent_again_and_changes_nothing() {
    let frames = frames(200, 3);
    for trouble in [Trouble::SampleLost, Trouble::SampleDamaged, Trouble::Noise] {
        let plan = [0, 50, 51, 120].map(|at| Plan { at, bytes: 7, trouble }).to_vec();
        let (board, _twin) = started(plan);
        let there = exchange(Box::new(configured(&board)), &frames).unwrap();
        assert_eq!(bit_differences(&there, &native(&frames)), 0, "{trouble:?}");
    }
}

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
    let mut plan = |trouble| Plan {
        at: random.below(u64::from(SAMPLES)) as u32,
        bytes: random.below(60) as usize,
        trouble,
    };
    match seed % 4 {
        0 => {
            let plan = plan(Trouble::Dies);
            let (board, _twin) = started(vec![plan]);
            stopped(
                configured(&board),
                seed,
                plan,
                |e| matches!(e, ControllerError::Ended { .. }),
                UNPLUGGED,
            );
        }
        1 => {
            let plan = plan(Trouble::FallsSilent);
            let (board, _twin) = started(vec![plan]);
            stopped(
                configured(&board),
                seed,
                plan,
                |e| matches!(e, ControllerError::TimedOut { .. }),
                HALTED,
            );
        }
        2 => {
            let plan = plan(Trouble::Restarts);
            let (board, _twin) = started(vec![plan]);
            stopped(
                configured(&board),
                seed,
                plan,
                |e| matches!(e, ControllerError::Restarted { .. }),
                RESTARTED,
            );
            let (board, _twin) = started(vec![plan]);
            continued(configured(&board), seed, plan);
        }
        _ => {
            let Plan { at, bytes, .. } = plan(Trouble::Dies);
            host_gone(seed, at as usize, bytes);
        }
    }
}

fn host_gone(seed: u64, samples: usize, bytes: usize) {
    let frames = frames(SAMPLES, seed);
    let (board, _twin) = started(vec![]);
    let mut first = configured(&board);
    for frame in &frames[..samples] {
        first.exchange(frame).unwrap();
    }
    drop(first);
    board.leave(&vec![0x21; bytes]);
    let there = exchange(Box::new(configured(&board)), &frames).unwrap();
    assert_eq!(bit_differences(&there, &native(&frames)), 0, "seed {seed}");
}

#[test]
fn a_failed_attachment_is_reported_with_its_likely_cause() {
    let error = |board: Board| opened(&Arc::new(board)).err().unwrap().to_string();
    let mut other = Board::new();
    other.build = b"v0.0.1-other".to_vec();
    other.build.resize(32, 0);
    let text = error(other);
    assert!(
        text.contains("found build v0.0.1-other on the board; expected") && text.contains("--elf"),
        "{text}"
    );
    let mut erased = Board::new();
    erased.build = vec![0xFF; 32];
    assert!(error(erased).contains("found build without a name"));
    let mut nameless = Board::new();
    nameless.name = b"talk\0";
    assert!(error(nameless).contains("no channel `link`"));

    // No controller serves the buffers.
    let started = Instant::now();
    let text = error(Board::new());
    assert!(text.contains("no answer to its hello") && text.contains("may be halted"), "{text}");
    assert!(started.elapsed() < MAX_DURATION, "{:?}", started.elapsed());

    let image = EmulatedController::default_elf();
    let bare = parse_board("stm32f405").unwrap();
    let failure = |runs, image: &Path, board| {
        let probe = probe_at(Arc::new(Board::new()), runs);
        ProbedController::through(probe, board, image, TIMEOUTS).err().unwrap().to_string()
    };
    let text = failure(false, &image, bare);
    assert!(text.contains("found the core halted"), "{text}");
    let text = failure(true, Path::new(env!("CARGO_BIN_EXE_host-sim")), bare);
    assert!(text.contains("found an image without buffers for a probe"), "{text}");
    let text = failure(true, Path::new("/no/such/image"), bare);
    assert!(text.starts_with("/no/such/image: no firmware there"), "{text}");
    let text = failure(true, &image, parse_board("mps2-an505").unwrap());
    assert!(text.starts_with("mps2-an505: a board of the emulator"), "{text}");

    let absent = std::process::Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .args(["link", "--controller", "attached", "--probe", "0001:0002", "--elf"])
        .arg(&image)
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&absent.stderr);
    assert_eq!(absent.status.code(), Some(1), "{text}");
    assert!(text.contains("opening the probe (another program may hold it"), "{text}");

    let (at, twin) = self::started(vec![]);
    drop(twin);
    let text = opened(&at).err().unwrap().to_string();
    assert!(text.starts_with("attaching to the chip (it may have no power"), "{text}");
}
