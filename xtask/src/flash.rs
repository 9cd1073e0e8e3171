//! Building an image and writing it to a board. `host-sim flash` writes it; probe-rs is only built
//! in if something is written.

use crate::firmware::Firmware;
use crate::run::{ChoreError, cargo, run};
use clap::Args;

/// Arguments of `cargo xtask flash`.
#[derive(Args)]
pub(crate) struct FlashArgs {
    /// Name of the board, as in `docs/firmware.md`; `stm32f405` fits every board with that
    /// microcontroller.
    #[arg(long, value_parser = crate::firmware::parse_board)]
    board: Firmware,
    /// Check the image and print what would be written; requires no probe.
    #[arg(long)]
    dry_run: bool,
    /// Probe as VID:PID or VID:PID:SERIAL in hexadecimal; by default the only one connected.
    #[arg(long, value_name = "PROBE")]
    probe: Option<String>,
    /// Show the controller's log after writing, until interrupted.
    #[arg(long)]
    follow: bool,
}

/// Builds the image and writes it.
pub(crate) fn flash(args: &FlashArgs) -> Result<(), ChoreError> {
    let image = args.board.build()?;
    let mut command = cargo();
    command.args(["run", "--quiet", "--package", "host-sim"]);
    if !args.dry_run {
        command.args(["--features", "probe"]);
    }
    command.args(["--", "flash", "--board", args.board.0.name, "--elf"]).arg(image);
    for (given, option) in [(args.dry_run, "--dry-run"), (args.follow, "--follow")] {
        if given {
            command.arg(option);
        }
    }
    if let Some(probe) = &args.probe {
        command.args(["--probe", probe]);
    }
    run(&mut command)
}
