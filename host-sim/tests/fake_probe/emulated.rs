//! The attached controller through a probe, with the firmware's own image in the emulator. The
//! emulator's test commands read and write the memory while the image runs.

use crate::memory::{Memory, probe_at};
use crate::rings::marks;
use crate::twin::{CONFIGURATION, frames};
use controller::boards::parse as parse_board;
use controller::emulator::MACHINE;
use controller::session::own_estimate_interval;
use host_sim::controller::{
    Controller, ControllerError, EmulatedController, NativeController, ProbedController, RemoteController,
    Timeouts,
};
use host_sim::run::exchange::{bit_differences, exchange};
use link::{Answer, Command, Counters, Decoder, ToHost};
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::{Child, ChildStdout, Command as Process, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Timeouts for a busy machine.
const PATIENT: Timeouts = Timeouts { answer: Duration::from_secs(60), retry: Duration::from_secs(20) };
/// An emulator keeps a core busy even while it waits, so only one runs at a time.
pub(crate) static ALONE: Mutex<()> = Mutex::new(());

/// A board with a probe at it.
struct Board {
    emulator: Child,
    serial: ChildStdout,
    folder: tempfile::TempDir,
    _alone: MutexGuard<'static, ()>,
}

impl Drop for Board {
    fn drop(&mut self) {
        let _ = self.emulator.kill();
        let _ = self.emulator.wait();
    }
}

impl Board {
    fn start() -> Self {
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = tempfile::tempdir().unwrap();
        let mut emulator = Process::new("qemu-system-arm")
            .args(["-M", MACHINE, "-display", "none", "-monitor", "unix:monitor,server=on,wait=off"])
            .args(["-serial", "null"].repeat(5))
            .args(["-serial", "stdio", "-icount", "shift=2,sleep=off"])
            .args(["-qtest", "unix:memory,server=on,wait=off", "-qtest-log", "none"])
            .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
            .arg(std::path::absolute(EmulatedController::default_elf()).unwrap())
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let serial = emulator.stdout.take().unwrap();
        Self { emulator, serial, folder, _alone: alone }
    }

    fn memory(&self) -> Emulated {
        Emulated(BufReader::new(connected(&self.folder.path().join("memory"))))
    }

    fn attached(&self) -> RemoteController {
        let probe = probe_at(self.memory(), true);
        let image = EmulatedController::default_elf();
        ProbedController::through(probe, parse_board("stm32f405").unwrap(), &image, PATIENT).unwrap()
    }
}

/// Connects to a socket of the emulator, which creates it shortly after its process starts.
fn connected(path: &Path) -> UnixStream {
    let until = Instant::now() + Duration::from_secs(60);
    loop {
        match UnixStream::connect(path) {
            Ok(stream) => return stream,
            Err(error) => assert!(Instant::now() < until, "{error}"),
        }
        std::thread::yield_now();
    }
}

/// The emulator's memory.
struct Emulated(BufReader<UnixStream>);

impl Emulated {
    /// Sends a command; returns the text after "OK".
    fn say(&mut self, command: &str) -> Option<String> {
        self.0.get_mut().write_all(command.as_bytes()).ok()?;
        let mut answer = String::new();
        self.0.read_line(&mut answer).ok()?;
        Some(answer.strip_prefix("OK")?.trim().into())
    }
}

impl Memory for Emulated {
    fn read(&mut self, address: u32, bytes: &mut [u8]) -> bool {
        let Some(answer) = self.say(&format!("read {address:#x} {:#x}\n", bytes.len())) else { return false };
        let digits = answer.strip_prefix("0x").unwrap_or_default();
        for (byte, at) in bytes.iter_mut().zip((0..).step_by(2)) {
            *byte = u8::from_str_radix(&digits[at..at + 2], 16).unwrap();
        }
        true
    }

    fn write(&mut self, address: u32, bytes: &[u8]) -> bool {
        let digits: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        self.say(&format!("write {address:#x} {:#x} 0x{digits}\n", bytes.len())).is_some()
    }
}

fn counters(controller: &mut RemoteController) -> Counters {
    match controller.order(Command::GetCounters) {
        Ok(Answer::Counters(counters)) => counters,
        other => panic!("{other:?}"),
    }
}

/// The first message among bytes that begin with a delimiter.
fn first(bytes: &[u8]) -> Option<ToHost> {
    assert_eq!(bytes.first(), Some(&0), "a delimiter before anything else");
    let mut decoder = Decoder::new();
    bytes.iter().find_map(|byte| decoder.push::<ToHost>(*byte)).map(Result::unwrap)
}

#[test]
fn the_image_sends_a_delimiter_before_its_hello_at_the_port_and_at_the_probe() {
    let mut board = Board::start();
    let (mut received, mut buffer) = (Vec::new(), [0; 256]);
    while received.is_empty() || first(&received).is_none() {
        let count = board.serial.read(&mut buffer).unwrap();
        received.extend(&buffer[..count]);
    }
    assert!(matches!(first(&received), Some(ToHost::Hello(hello)) if hello.token == 0), "{received:?}");

    let mut memory = board.memory();
    let word = |memory: &mut Emulated, address| {
        let mut bytes = [0; 4];
        assert!(memory.read(address, &mut bytes));
        u32::from_le_bytes(bytes)
    };
    // The second channel of the control block: its buffer and the write position, which advances
    // after the hello at the port.
    let channel = marks().0 + 24 + 24;
    let buffer = word(&mut memory, channel + 4);
    let until = Instant::now() + PATIENT.answer;
    loop {
        let written = word(&mut memory, channel + 12) as usize;
        if written > 1 {
            let mut received = vec![0; written];
            assert!(memory.read(buffer, &mut received));
            let heard = first(&received);
            assert!(matches!(heard, Some(ToHost::Hello(hello)) if hello.token == 0), "{received:?}");
            break;
        }
        assert!(Instant::now() < until, "no hello");
    }
}

#[test]
fn a_conversation_with_the_image_is_that_with_the_native_controller() {
    let frames = frames(300, 1);
    let board = Board::start();
    let mut controller = board.attached();
    controller.configure(CONFIGURATION).unwrap();
    let there = exchange(Box::new(controller), &frames).unwrap();
    let here = exchange(Box::new(NativeController::start(CONFIGURATION).unwrap()), &frames).unwrap();
    assert_eq!(bit_differences(&there, &here), 0);
    assert_eq!(
        (there.counters.samples, there.counters.flagged),
        (here.counters.samples, here.counters.flagged)
    );
    let Counters { dropped_samples, dropped_estimates, dropped_answers, bad_frames, .. } = there.counters;
    assert_eq!([dropped_samples, dropped_estimates, dropped_answers, bad_frames.total()], [0; 4]);
    println!("{:.0} exchanges a second", 300.0 / there.wall_s);
}

#[test]
fn a_probe_that_does_not_read_delays_nothing_and_its_missed_estimates_are_counted() {
    let board = Board::start();
    let mut controller = board.attached();
    controller.configure(CONFIGURATION).unwrap();
    assert_eq!(
        controller.order(Command::SampleYourself).unwrap(),
        Answer::Sampling { every: own_estimate_interval(100) }
    );
    let mut rounds = 0;
    let found = loop {
        std::thread::sleep(Duration::from_millis(300));
        let found = counters(&mut controller);
        rounds += 1;
        if found.dropped_estimates > 0 || rounds == 100 {
            break found;
        }
    };
    assert!(found.dropped_estimates > 0 && found.samples > 0, "{found:?}");
    assert_eq!((found.sequence_gaps, found.time_faults, found.trips), (0, 0, 0));
    // Room was left for every answer, and no frame was cut.
    // The gap shows in the sequence numbers once a later frame has arrived.
    std::thread::sleep(Duration::from_millis(300));
    counters(&mut controller);
    let losses = controller.link_state().1;
    assert_eq!((losses.damaged, losses.sent_again), (0, 0), "{losses:?}");
    assert!(losses.estimates_missed > 0, "{losses:?}");
}

#[test]
fn a_reset_is_reported_at_once_and_the_end_of_the_link_with_its_cause() {
    let board = Board::start();
    let mut controller = board.attached();
    controller.configure(CONFIGURATION).unwrap();
    let frames = frames(40, 2);
    for frame in &frames[..20] {
        controller.exchange(frame).unwrap();
    }
    let mut monitor = connected(&board.folder.path().join("monitor"));
    let started = Instant::now();
    writeln!(monitor, "system_reset").unwrap();
    // The emulator answers samples until it executes the reset.
    let error = frames[20..].iter().find_map(|frame| controller.exchange(frame).err());
    let error = error.unwrap_or_else(|| controller.exchange(&frames[39]).unwrap_err());
    assert!(matches!(error, ControllerError::Restarted { .. }), "{error:?}");
    assert!(started.elapsed() < PATIENT.retry, "{:?}", started.elapsed());

    controller.configure(CONFIGURATION).unwrap();
    controller.exchange(&frames[0]).unwrap();
    drop(board);
    let started = Instant::now();
    let error = controller.exchange(&frames[1]).unwrap_err();
    assert!(matches!(error, ControllerError::Ended { last_sequence: Some(0), .. }), "{error:?}");
    assert!(error.to_string().contains("lost its power"), "{error}");
    assert!(started.elapsed() < Duration::from_secs(5), "{:?}", started.elapsed());
}
