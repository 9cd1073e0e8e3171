//! The attached controller through a probe, a software twin at the other end of the ring buffers: what the native controller gives, to the bit;
//! whatever goes, at whatever moment, has a name and an end.

use crate::memory::probe_at;
use crate::rings::{Board, Rings};
use crate::twin::{CONFIGURATION, Plan, Random, Trouble, Twin, frames};
use host_sim::controller::{
    Bounds, Controller, ControllerError, EmulatedController, NativeController, ProbedController,
    RemoteController,
};
use host_sim::estimator::{OnRestart, Tracked, bit_differences, track, track_restarting, track_through};
use host_sim::flash::board;
use link::SensorFrame;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Long enough for a twin on a busy machine.
pub(crate) const BOUNDS: Bounds =
    Bounds { answer: Duration::from_millis(1_500), again: Duration::from_millis(100) };
/// A sample's wait, the question after it, and room for a busy machine.
const MOST: Duration = Duration::from_secs(6);
const SAMPLES: u32 = 120;
const SEEDS: u64 = 80;
const AT_ONCE: u64 = 8;

fn opened(at: &Arc<Board>) -> Result<RemoteController, ControllerError> {
    let image = EmulatedController::default_elf();
    ProbedController::through(probe_at(Arc::clone(at), true), board("stm32f405").unwrap(), &image, BOUNDS)
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

fn native(frames: &[SensorFrame]) -> Tracked {
    track(Box::new(NativeController::start(CONFIGURATION).unwrap()), frames).unwrap()
}

#[test]
fn a_conversation_is_that_with_the_native_controller() {
    let frames = frames(1_000, 1);
    let (board, _twin) = started(vec![]);
    let there = track(Box::new(configured(&board)), &frames).unwrap();
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
        let there = track(Box::new(configured(&board)), &frames).unwrap();
        assert_eq!(bit_differences(&there, &native(&frames)), 0, "{trouble:?}");
    }
}

#[test]
fn whoever_goes_at_whatever_moment_nothing_hangs_and_the_error_says_where_and_why() {
    std::thread::scope(|scope| {
        for first in 0..AT_ONCE {
            scope.spawn(move || (first..SEEDS).step_by(AT_ONCE as usize).for_each(trial));
        }
    });
}

fn trial(seed: u64) {
    let mut random = Random(seed);
    let mut plan = |trouble| Plan {
        at: random.below(u64::from(SAMPLES)) as u32,
        bytes: random.below(60) as usize,
        trouble,
    };
    match seed % 4 {
        0 => stopped(seed, plan(Trouble::Dies), "may have been unplugged", |error| {
            matches!(error, ControllerError::Ended { .. })
        }),
        1 => stopped(seed, plan(Trouble::FallsSilent), "may be halted", |error| {
            matches!(error, ControllerError::TimedOut { .. })
        }),
        2 => {
            let plan = plan(Trouble::Restarts);
            stopped(seed, plan, "it does not say why", |e| matches!(e, ControllerError::Restarted { .. }));
            gone_on(seed, plan);
        }
        _ => {
            let Plan { at, bytes, .. } = plan(Trouble::Dies);
            host_gone(seed, at as usize, bytes);
        }
    }
}

fn stopped(seed: u64, plan: Plan, cause: &str, is_expected: fn(&ControllerError) -> bool) {
    let (board, _twin) = started(vec![plan]);
    let mut controller = configured(&board);
    let (mut last, mut failure) = (None, None);
    for frame in frames(SAMPLES + 1, seed) {
        let started = Instant::now();
        match controller.exchange(&frame) {
            Ok(estimate) => last = Some(estimate.sequence),
            Err(error) => {
                failure = Some((error, started.elapsed()));
                break;
            }
        }
    }
    let Some((error, took)) = failure else { panic!("seed {seed}, {plan:?}: no error") };
    assert!(took < MOST, "seed {seed}, {plan:?}: {took:?}");
    assert!(is_expected(&error), "seed {seed}, {plan:?}: {error:?}");
    let text = error.to_string();
    let told = last.map_or_else(|| "none".into(), |last: u32| last.to_string());
    assert!(text.contains(&format!("last sequence number answered: {told}")), "seed {seed}: {text}");
    assert!(text.contains(cause), "seed {seed}: {text}");
}

fn gone_on(seed: u64, plan: Plan) {
    let frames = frames(SAMPLES + 1, seed);
    let (board, _twin) = started(vec![plan]);
    let controller = Box::new(configured(&board));
    let there = track_through(controller, CONFIGURATION, &frames, OnRestart::Continue).unwrap();
    assert_eq!(there.restarts.len(), 1, "seed {seed}, {plan:?}");
    let here = Box::new(NativeController::start(CONFIGURATION).unwrap());
    let here = track_restarting(here, CONFIGURATION, &frames, &there.restarts).unwrap();
    assert_eq!(bit_differences(&there, &here), 0, "seed {seed}, {plan:?}");
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
    let there = track(Box::new(configured(&board)), &frames).unwrap();
    assert_eq!(bit_differences(&there, &native(&frames)), 0, "seed {seed}");
}

#[test]
fn what_cannot_be_attached_to_is_told_with_its_likely_cause() {
    let told = |board: Board| opened(&Arc::new(board)).err().unwrap().to_string();
    let mut other = Board::new();
    other.build = b"v0.0.1-other".to_vec();
    other.build.resize(32, 0);
    let text = told(other);
    assert!(
        text.contains("found build v0.0.1-other on the board; expected") && text.contains("--elf"),
        "{text}"
    );
    let mut erased = Board::new();
    erased.build = vec![0xFF; 32];
    assert!(told(erased).contains("found build without a name"));
    let mut nameless = Board::new();
    nameless.name = b"talk\0";
    assert!(told(nameless).contains("no channel `link`"));

    // Nobody serves the buffers.
    let started = Instant::now();
    let text = told(Board::new());
    assert!(text.contains("no answer to its greeting") && text.contains("may be halted"), "{text}");
    assert!(started.elapsed() < MOST, "{:?}", started.elapsed());

    let image = EmulatedController::default_elf();
    let bare = board("stm32f405").unwrap();
    let through = |runs, image: &Path, board| {
        let probe = probe_at(Arc::new(Board::new()), runs);
        ProbedController::through(probe, board, image, BOUNDS).err().unwrap().to_string()
    };
    let text = through(false, &image, bare);
    assert!(text.contains("found the core halted"), "{text}");
    let text = through(true, Path::new(env!("CARGO_BIN_EXE_host-sim")), bare);
    assert!(text.contains("found an image without buffers for a probe"), "{text}");
    let text = through(true, Path::new("/no/such/image"), bare);
    assert!(text.starts_with("/no/such/image: no firmware there"), "{text}");
    let text = through(true, &image, board("mps2-an505").unwrap());
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
