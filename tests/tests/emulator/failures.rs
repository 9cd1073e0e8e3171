//! Failures of a controller: each has a named error and a timeout, and the error states the last
//! answered sample.

use crate::frames::{configuration, disturbed_frames};
use host_sim::controller::{Controller, ControllerError, EmulatedController, RemoteController};
use inference::BearingMaterial;
use link::track::SensorStatus;
use link::{
    BadFrames, Counters, Fault, Field, FrameError, MAX_FRAME, OutOfRange, Refusal, SensorFrame, ToController,
    ToHost, encode,
};
use object::{Object, ObjectSection, ObjectSymbol};
use rustix::process::{Pid, Signal, kill_process};
use std::path::Path;
use std::time::{Duration, Instant};

fn start() -> RemoteController {
    EmulatedController::start(configuration(BearingMaterial::Babbitt), &EmulatedController::default_elf())
        .unwrap()
}

fn frames() -> Vec<SensorFrame> {
    disturbed_frames(&configuration(BearingMaterial::Babbitt), 200, 9)
}

fn process(controller: &RemoteController) -> Pid {
    Pid::from_raw(controller.process_id().unwrap().try_into().unwrap()).unwrap()
}

/// Sends a signal and waits until every thread of the emulator has reached the state (T stopped, Z
/// gone): a thread within an instruction may still reply.
fn signal(controller: &RemoteController, signal: Signal, state: &str) {
    let id = controller.process_id().unwrap();
    kill_process(process(controller), signal).unwrap();
    let reached = || {
        let threads = std::fs::read_dir(format!("/proc/{id}/task")).unwrap();
        // The state follows the name in brackets. A thread that has ended has no state.
        threads
            .filter_map(|thread| std::fs::read_to_string(thread.ok()?.path().join("stat")).ok())
            .all(|stat| stat.rsplit_once(") ").is_some_and(|(_, rest)| rest.starts_with(state)))
    };
    let deadline = Instant::now() + Duration::from_secs(5);
    while !reached() {
        assert!(Instant::now() < deadline, "the emulator did not take {signal:?}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Returns the error of a start, and its duration.
fn refused_start(elf: &Path) -> (ControllerError, Duration) {
    let started = Instant::now();
    let error = EmulatedController::start(configuration(BearingMaterial::Babbitt), elf).err().unwrap();
    (error, started.elapsed())
}

#[test]
fn corrupted_bytes_are_answered_and_counted_and_change_no_estimate() {
    let frames = frames();
    let mut undisturbed = start();
    let mut disturbed = start();
    let mut damaged = [0; MAX_FRAME];
    let length = encode(&ToController::Sensor(frames[50], SensorStatus::GOOD), &mut damaged).unwrap().len();
    let damaged = &mut damaged[..length];
    damaged[5] ^= 0x10;
    let mut foreign = [0; MAX_FRAME];
    let foreign = encode(&ToHost::Fault(Fault::NotConfigured { sequence: 7 }), &mut foreign).unwrap();
    // Valid stuffing: every 1 stands for a zero.
    let mut overlong = [1; 3 * MAX_FRAME];
    overlong[3 * MAX_FRAME - 1] = 0;
    let disturbances: [(&[u8], FrameError); 4] = [
        (damaged, FrameError::Crc),
        (&[200, 1, 2, 3, 0], FrameError::Cobs),
        (foreign, FrameError::Unknown),
        (&overlong, FrameError::Overlong),
    ];
    for (index, frame) in frames.iter().enumerate() {
        if let (0, Some((bytes, error))) = (index % 50, disturbances.get(index / 50)) {
            let answer = disturbed.disturb(bytes).unwrap();
            assert_eq!(answer, ToHost::Fault(Fault::BadFrame(*error)), "{error}");
        }
        let expected = undisturbed.exchange(frame).unwrap();
        assert!(disturbed.exchange(frame).unwrap().same_bits(&expected), "sample {index}");
    }
    let expected = Box::new(undisturbed).finish().unwrap();
    let counters = Box::new(disturbed).finish().unwrap();
    assert_eq!(expected.bad_frames.total(), 0);
    assert_eq!(counters.bad_frames, BadFrames { cobs: 1, crc: 1, overlong: 1, unknown: 1 });
    assert_eq!(counters, Counters { bad_frames: counters.bad_frames, ..expected });
}

#[test]
fn a_killed_emulator_is_an_error_at_once_that_states_the_last_sample() {
    let mut controller = start();
    let frames = frames();
    for frame in &frames[..100] {
        controller.exchange(frame).unwrap();
    }
    signal(&controller, Signal::KILL, "Z");
    let started = Instant::now();
    let error = controller.exchange(&frames[100]).unwrap_err();
    assert!(started.elapsed() < Duration::from_secs(3), "{:?}", started.elapsed());
    let last = frames[99].sequence;
    match &error {
        ControllerError::Ended { last_sequence, status, .. } => {
            assert_eq!(*last_sequence, Some(last));
            assert!(status.contains("signal: 9"), "{status}");
        }
        other => panic!("{other:?}"),
    }
    assert!(error.to_string().contains(&format!("last sequence number answered: {last}")), "{error}");
    // The error repeats, because the controller does not return.
    assert!(matches!(controller.exchange(&frames[101]), Err(ControllerError::Ended { .. })));
}

#[test]
fn a_silent_controller_times_out_and_the_error_states_the_last_sample() {
    let mut controller = start();
    let frames = frames();
    for frame in &frames[..10] {
        controller.exchange(frame).unwrap();
    }
    signal(&controller, Signal::STOP, "T");
    let started = Instant::now();
    let error = controller.exchange(&frames[10]).unwrap_err();
    let took = started.elapsed();
    assert!(took >= Duration::from_secs(5) && took < Duration::from_secs(7), "{took:?}");
    match &error {
        ControllerError::TimedOut { last_sequence, timeout_s, waiting_for, .. } => {
            assert_eq!((*last_sequence, *timeout_s, *waiting_for), (Some(frames[9].sequence), 5, "a sample"));
        }
        other => panic!("{other:?}"),
    }
    // A stopped process is ended, too.
    let gone = Path::new("/proc").join(controller.process_id().unwrap().to_string());
    assert!(gone.exists());
    drop(controller);
    assert!(!gone.exists());
}

#[test]
fn a_late_reply_is_not_taken_for_the_next_one() {
    let mut controller = start();
    let frames = frames();
    controller.exchange(&frames[0]).unwrap();
    signal(&controller, Signal::STOP, "T");
    assert!(matches!(controller.exchange(&frames[1]), Err(ControllerError::TimedOut { .. })));
    kill_process(process(&controller), Signal::CONT).unwrap();
    assert!(matches!(controller.exchange(&frames[2]), Err(ControllerError::Unexpected { .. })));
}

#[test]
fn a_missing_image_is_an_error_with_its_path() {
    let (error, took) = refused_start(Path::new("/nowhere/estimator"));
    assert!(matches!(error, ControllerError::FirmwareMissing { .. }), "{error:?}");
    let text = error.to_string();
    assert!(text.contains("/nowhere/estimator") && text.contains("cargo xtask firmware"), "{text}");
    assert!(took < Duration::from_secs(1), "{took:?}");
}

#[test]
fn a_file_that_is_not_the_firmware_is_refused_within_the_timeout() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let text = file("text", b"not an image\n");
    let empty = file("empty", b"");
    let image = std::fs::read(EmulatedController::default_elf()).unwrap();
    let short = file("short", &image[..image.len() / 100]);
    let host = std::env::current_exe().unwrap();
    for (elf, found) in [
        (text.as_path(), "no ELF image for ARM"),
        (&empty, "no ELF image for ARM"),
        (&host, "no ELF image for ARM"),
        (folder.path(), "Is a directory"),
        (&short, "ended before its hello"),
    ] {
        let (error, took) = refused_start(elf);
        assert!(matches!(error, ControllerError::NotFirmware { .. }), "{error:?}");
        let message = error.to_string();
        let expected = format!("{}: found ", elf.canonicalize().unwrap().display());
        assert!(message.starts_with(&expected) && message.contains(found), "{message}");
        assert!(message.lines().count() == 1 && message.contains("cargo xtask firmware"), "{message}");
        assert!(took < Duration::from_secs(22), "{}: {took:?}", elf.display());
    }
}

#[test]
fn an_image_without_a_hello_frame_times_out() {
    // The firmware image with a branch to itself as the first instruction of the reset handler.
    let mut image = std::fs::read(EmulatedController::default_elf()).unwrap();
    let reset = offset_of_reset(&image);
    image[reset..reset + 2].copy_from_slice(&[0xFE, 0xE7]);
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), &image).unwrap();
    let (error, took) = refused_start(file.path());
    assert!(
        matches!(error, ControllerError::TimedOut { waiting_for: "its hello", last_sequence: None, .. }),
        "{error:?}"
    );
    assert!(took < Duration::from_secs(22), "{took:?}");
}

/// Returns the file offset of the reset handler.
fn offset_of_reset(image: &[u8]) -> usize {
    let file = object::File::parse(image).unwrap();
    let reset = file.symbols().find(|symbol| symbol.name() == Ok("Reset")).unwrap();
    // The lowest bit of a code address marks Thumb code.
    let address = reset.address() & !1;
    let section = file.section_by_index(reset.section_index().unwrap()).unwrap();
    let (start, _) = section.file_range().unwrap();
    usize::try_from(start + address - section.address()).unwrap()
}

#[test]
fn a_refused_configuration_lists_the_wrong_fields() {
    let mut bad = configuration(BearingMaterial::Plastic);
    bad.bench.sample_period_us = 10;
    bad.limits.stuck_samples = 1;
    let error = EmulatedController::start(bad, &EmulatedController::default_elf()).err().unwrap();
    let ControllerError::Refused(Refusal::Configuration(reasons)) = &error else { panic!("{error:?}") };
    let fields: Vec<_> = reasons.iter().copied().collect();
    let period = OutOfRange { field: Field::SamplePeriod, found: 10, min: 50, max: 1_000 };
    let stuck = OutOfRange { field: Field::StuckSamples, found: 1, min: 10, max: 10_000 };
    assert_eq!(fields, [period, stuck]);
    let text = error.to_string();
    assert!(text.contains("SamplePeriod: found 10, expected 50 to 1000"), "{text}");
}
