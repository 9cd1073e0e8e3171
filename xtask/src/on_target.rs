//! Tests that run on a board, through a probe or on the emulator.

use crate::firmware::{DEFAULT, Firmware};
use crate::run::{ChoreError, output_of, run_with_timeout, succeeds};
use crate::setup::EMULATOR;
use clap::Args;
use controller::emulator::MACHINE;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Program that writes an image, shows its log and returns its result.
const RUNNER: &str = "probe-rs";
/// Timeout; the tests take a few seconds.
const TIMEOUT: Duration = Duration::from_secs(120);

/// Arguments of `cargo xtask on-target`.
#[derive(Args)]
pub(crate) struct OnTargetArgs {
    /// Name of the board, as in `docs/firmware.md`.
    #[arg(long, value_parser = crate::firmware::parse_board, default_value = "stm32f405")]
    board: Firmware,
    /// Run on the emulator: without tests of what it does not model.
    #[arg(long, conflicts_with_all = ["board", "probe"])]
    emulated: bool,
    /// Probe as VID:PID or VID:PID:SERIAL in hexadecimal; by default the only one connected.
    #[arg(long, value_name = "PROBE")]
    probe: Option<String>,
}

/// Builds the tests and runs them; without a probe only says so.
pub(crate) fn on_target(args: &OnTargetArgs) -> Result<(), ChoreError> {
    if args.emulated {
        return emulated();
    }
    let Some(chip) = args.board.0.microcontroller.probe_name else {
        return Err(ChoreError::ByHand(format!("{}: it exists in the emulator only", args.board.0.name)));
    };
    let image = args.board.build_tests()?;
    if let Err(reason) = probe() {
        println!("built {}; skipped: {reason}", image.display());
        return Ok(());
    }
    let mut command = Command::new(RUNNER);
    command.args(["run", "--chip", chip]).stdout(Stdio::piped());
    if let Some(probe) = &args.probe {
        command.args(["--probe", probe]);
    }
    run_with_timeout(command.arg(image), TIMEOUT).map(|log| print!("{log}"))
}

/// Runs the tests on the emulator.
pub(crate) fn emulated() -> Result<(), ChoreError> {
    run_image(&DEFAULT.build_tests()?)
}

fn run_image(image: &Path) -> Result<(), ChoreError> {
    let mut command = Command::new(EMULATOR);
    command
        .args(["-M", MACHINE, "-display", "none", "-serial", "null", "-monitor", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-icount", "shift=6,sleep=off", "-kernel"])
        .arg(image)
        .stdin(Stdio::null())
        .stdout(Stdio::piped());
    run_with_timeout(&mut command, TIMEOUT).map(|_| println!("all tests passed on the emulator"))
}

/// Looks for a probe; the reason if there is none.
fn probe() -> Result<(), &'static str> {
    if !succeeds(Command::new(RUNNER).arg("--version")) {
        return Err("probe-rs is not installed (https://probe.rs)");
    }
    let listed = output_of(Command::new(RUNNER).arg("list")).unwrap_or_default();
    if listed.contains("No debug probes") { Err("no probe is connected") } else { Ok(()) }
}
