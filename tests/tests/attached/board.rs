//! The emulated board on a pseudo-terminal, with the emulator's monitor.

use controller::configuration::BENCH_B;
use controller::emulator::MACHINE;
use host_sim::controller::{
    AttachedController, Controller, EmulatedController, NativeController, RemoteController, Timeouts,
};
use host_sim::run::exchange::{ExchangeResult, exchange};
use link::{Command as LinkCommand, SensorFrame};
use rustix::process::{Pid, Signal, kill_process};
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Timeouts for a busy machine.
pub(crate) const PATIENT: Timeouts =
    Timeouts { answer: Duration::from_secs(40), retry: Duration::from_secs(4) };

/// An idle emulator keeps a core busy, so only one board runs at a time.
static ALONE: Mutex<()> = Mutex::new(());

/// A running board.
pub(crate) struct Board {
    pub(crate) port: PathBuf,
    pub(crate) folder: tempfile::TempDir,
    emulator: Child,
    _alone: MutexGuard<'static, ()>,
}

impl Drop for Board {
    fn drop(&mut self) {
        let _ = self.emulator.kill();
        let _ = self.emulator.wait();
    }
}

impl Board {
    /// Starts a board. An instruction takes 4 ns, so that a tick takes a third of its period.
    pub(crate) fn start() -> Self {
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        // Without the link's pipes in its folder, the image uses the serial port.
        let folder = tempfile::tempdir().unwrap();
        let mut emulator = Command::new("qemu-system-arm")
            .args(["-M", MACHINE, "-display", "none", "-monitor", "unix:monitor,server=on,wait=off"])
            .args(["-serial", "null"].repeat(5))
            .args(["-serial", "pty", "-icount", "shift=2,sleep=off"])
            .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
            .arg(std::path::absolute(EmulatedController::default_elf()).unwrap())
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        // "char device redirected to /dev/pts/3 (label serial5)"
        let mut received = String::new();
        BufReader::new(emulator.stdout.take().unwrap()).read_line(&mut received).unwrap();
        let port = received.split_whitespace().find(|word| word.starts_with("/dev/")).unwrap().into();
        Self { port, folder, emulator, _alone: alone }
    }

    pub(crate) fn signal(&self, signal: Signal) {
        kill_process(Pid::from_child(&self.emulator), signal).unwrap();
    }

    /// Runs a command of the emulator's monitor to its end.
    pub(crate) fn monitor(&self, command: &str) {
        let mut monitor = UnixStream::connect(self.folder.path().join("monitor")).unwrap();
        monitor.set_read_timeout(Some(Duration::from_millis(50))).unwrap();
        writeln!(monitor, "{command}").unwrap();
        // The prompt appears once after connecting and once after the command.
        let (mut received, mut buffer, deadline) =
            (Vec::new(), [0; 1024], Instant::now() + Duration::from_secs(10));
        while received.windows(6).filter(|window| window == b"(qemu)").count() < 2 {
            assert!(Instant::now() < deadline, "{}", String::from_utf8_lossy(&received));
            if let Ok(count) = monitor.read(&mut buffer) {
                received.extend(&buffer[..count]);
            }
        }
    }

    /// Returns the host's controller, configured. For every byte, the emulator switches between
    /// threads, which is slow on a busy machine.
    pub(crate) fn attached(&self) -> RemoteController {
        self.attached_within(PATIENT)
    }

    /// The same with other timeouts.
    pub(crate) fn attached_within(&self, timeouts: Timeouts) -> RemoteController {
        let mut controller = AttachedController::open_with(&self.port, timeouts).unwrap();
        controller.order(LinkCommand::Configure(BENCH_B)).unwrap();
        controller
    }
}

pub(crate) fn native(frames: &[SensorFrame]) -> ExchangeResult {
    exchange(Box::new(NativeController::start(BENCH_B).unwrap()), frames).unwrap()
}

/// Returns samples of a journal that swings along the clearance circle and in and out of contact,
/// with some jumps and lost samples.
pub(crate) fn frames(count: u32, seed: u32) -> Vec<SensorFrame> {
    let mut state = seed.wrapping_mul(0x9E37_79B9) | 1;
    let mut noise = move || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        f64::from(state % 801) - 400.0
    };
    let frame = |index: u32| {
        let sequence = index + index / 700;
        let t = f64::from(sequence) * 1e-4;
        let distance_nm = 515_000.0 + 30_000.0 * (207.0 * t).sin();
        let swing = (283.0 * t).sin() - 1.5;
        SensorFrame {
            sequence,
            time_us: sequence * 100,
            journal_y_nm: (distance_nm * swing.cos() + noise()) as i32
                + if index % 900 == 899 { 200_000 } else { 0 },
            journal_z_nm: (distance_nm * swing.sin() + noise()) as i32,
            shaft_angle_nrad: (5e7 * (9.0 * t).sin() + 40.0 * noise()) as i32,
            load_force_mn: 10_000_000,
        }
    };
    (0..count).map(frame).collect()
}
