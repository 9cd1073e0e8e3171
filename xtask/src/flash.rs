//! Building an image and writing it to a board: `host-sim flash` does the latter, with probe-rs built in only when something is written.

use crate::firmware::Board;
use crate::run::{ChoreError, cargo, run};
use clap::Args;

/// What to flash.
#[derive(Args)]
pub(crate) struct FlashArgs {
    /// The board: stm32f405 (any of them), feather-stm32f405, olimex-stm32-h405, netduino-plus-2.
    #[arg(long, value_parser = crate::firmware::board)]
    board: Board,
    /// Check the image and say what would be written; needs no probe.
    #[arg(long)]
    dry_run: bool,
    /// The probe, VID:PID or VID:PID:SERIAL in hexadecimal; by default the only one there is.
    #[arg(long, value_name = "PROBE")]
    probe: Option<String>,
    /// Go on showing the controller's log after writing, until interrupted.
    #[arg(long)]
    follow: bool,
}

/// Builds and writes.
pub(crate) fn flash(args: &FlashArgs) -> Result<(), ChoreError> {
    let image = args.board.build()?;
    let mut command = cargo();
    command.args(["run", "--quiet", "--package", "host-sim"]);
    if !args.dry_run {
        command.args(["--features", "probe"]);
    }
    command.args(["--", "flash", "--board", args.board.name, "--elf"]).arg(image);
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
