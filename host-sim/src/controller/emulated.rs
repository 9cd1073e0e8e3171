//! The emulated controller: the firmware's own image in QEMU, linked through two named pipes by
//! semihosting.
//!
//! One write and one read per frame. The emulated time stops while the controller waits for a frame
//! (`-icount`), so its instruction counts are reproducible.

use super::line::{Line, Process, Timeouts};
use super::one_core::OneCore;
use super::stream::Stream;
use super::{ControllerError, RemoteController, system};
use controller::emulator::MACHINE;
use link::ControllerConfiguration;
use rustix::fs::{CWD, FileType, Mode, mknodat};
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// Timeout of the emulator's start, up to its hello.
const START_TIMEOUT: Duration = Duration::from_secs(20);
/// Timeouts of all other answers. The pipes lose nothing, so nothing is repeated earlier.
const TIMEOUTS: Timeouts = Timeouts { answer: Duration::from_secs(5), retry: Duration::from_secs(5) };

/// The firmware in cargo's target folder.
const BUILT: &str = "thumbv7em-none-eabihf/firmware/estimator";
/// The firmware in a release archive.
const INSTALLED: &str = "share/pintle/firmware/estimator";
const BOARD: &[&str] =
    &["-M", MACHINE, "-display", "none", "-serial", "null", "-monitor", "none", "-no-reboot"];
const COUNTING: &[&str] = &["-semihosting-config", "enable=on,target=native", "-icount", "shift=6,sleep=off"];

/// Starts emulated controllers.
#[derive(Debug)]
pub struct EmulatedController;

impl EmulatedController {
    /// Path of the firmware: where `cargo xtask firmware` puts it in cargo's target folder below
    /// the current directory, else beside this program, in a target folder or a release archive.
    pub fn default_elf() -> PathBuf {
        let target = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
        let here = Path::new(&target).join(BUILT);
        let program = std::env::current_exe().unwrap_or_default();
        let beside = || {
            let folders = program.ancestors().skip(1);
            folders.flat_map(|folder| [BUILT, INSTALLED].map(|tail| folder.join(tail))).find(|p| p.exists())
        };
        if here.exists() { here } else { beside().unwrap_or(here) }
    }

    /// Starts the emulator with an image, waits for its hello and configures it.
    pub fn start(
        configuration: ControllerConfiguration,
        elf: &Path,
    ) -> Result<RemoteController, ControllerError> {
        let mut controller = Self::open(elf)?;
        controller.configure(configuration)?;
        Ok(controller)
    }

    /// Starts the emulator with an image and waits for its hello.
    pub fn open(elf: &Path) -> Result<RemoteController, ControllerError> {
        let elf = elf.canonicalize().map_err(|_| ControllerError::FirmwareMissing { path: elf.into() })?;
        is_for_arm(&elf)?;
        let folder =
            tempfile::Builder::new().prefix("pintle-").tempdir().map_err(system("a folder for the link"))?;
        let [to_controller, to_host] = ["to-controller", "to-host"].map(|name| folder.path().join(name));
        for pipe in [&to_controller, &to_host] {
            mknodat(CWD, pipe, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0)
                .map_err(|e| system("a pipe for the link")(e.into()))?;
        }
        // Non-blocking: opening must not wait for an emulator that never starts. Opened in both
        // directions, the first pipe exists for its reader until it is closed here.
        let nonblocking = rustix::fs::OFlags::NONBLOCK.bits() as i32;
        let mut options = OpenOptions::new();
        options.read(true).custom_flags(nonblocking);
        let to_host = options.open(&to_host).map_err(system("the pipe from the controller"))?;
        let to_controller =
            options.write(true).open(&to_controller).map_err(system("the pipe to the controller"))?;
        let errors = File::create(folder.path().join("stderr"))
            .map_err(system("a file for the emulator's messages"))?;
        // The emulator inherits the core.
        let core = OneCore::stay();
        let child = Command::new("qemu-system-arm")
            .args(BOARD)
            .args(COUNTING)
            .arg("-kernel")
            .arg(&elf)
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(errors)
            .spawn()
            .map_err(|source| match source.kind() {
                ErrorKind::NotFound => ControllerError::EmulatorMissing,
                _ => ControllerError::System { what: "qemu-system-arm", source },
            })?;
        let stream = Stream::Pipes { to_controller, to_host };
        let line = Line::new(stream, Some(Process { child, folder, _core: core }), TIMEOUTS);
        let cause = "The image may not be this project's firmware, or may have crashed at its start.";
        RemoteController::await_hello("emulated", line, START_TIMEOUT, cause).map_err(|error| match error {
            ControllerError::Ended { status, message, .. } => ControllerError::NotFirmware {
                path: elf.clone(),
                found: format!("an image that ended before its hello ({status}: {message})"),
            },
            other => other,
        })
    }
}

/// Checks for an ELF file of a 32-bit ARM core. The emulator would run anything else as raw machine
/// code.
fn is_for_arm(path: &Path) -> Result<(), ControllerError> {
    /// `e_machine`, little endian.
    const ARM: [u8; 2] = [40, 0];
    let mut start = [0; 20];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut start));
    let found = match read {
        Err(error) if error.kind() != ErrorKind::UnexpectedEof => error.to_string(),
        Ok(()) if start.starts_with(b"\x7fELF\x01\x01") && start.ends_with(&ARM) => return Ok(()),
        _ => "no ELF image for ARM".into(),
    };
    Err(ControllerError::NotFirmware { path: path.into(), found })
}
