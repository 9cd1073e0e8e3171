//! `host-sim flash`: writes the firmware's image to a board, or with `--dry-run` prints what would
//! be written.

use crate::cli::error::CliError;
use crate::controller::choice;
use crate::flash::Plan;
use clap::Args;
use controller::boards::{Board, parse as parse_board};
use std::path::PathBuf;

/// Arguments of `host-sim flash`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim flash --board feather-stm32f405 --dry-run\n  \
    cargo run --release -p host-sim --features probe -- flash --board feather-stm32f405 --follow\n\n\
    Without a probe: see docs/firmware.md for flashing over USB (DFU).")]
pub struct FlashArgs {
    /// The board: stm32f405 (any of them), feather-stm32f405, olimex-stm32-h405, netduino-plus-2,
    /// nucleo-h743zi2.
    #[arg(long, value_parser = parse_board)]
    pub board: Board,
    /// The image; by default the output of `cargo xtask firmware --board` for this board.
    #[arg(long, value_name = "FILE")]
    pub elf: Option<PathBuf>,
    /// Check the image and print what would be written; requires no probe.
    #[arg(long)]
    pub dry_run: bool,
    /// The probe, VID:PID or VID:PID:SERIAL in hexadecimal; by default the only one.
    #[arg(long, value_name = "PROBE")]
    pub probe: Option<String>,
    /// Show the controller's log after writing, until interrupted.
    #[arg(long)]
    pub follow: bool,
    /// Print the plan as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Checks the image and writes it, unless only the plan was requested.
pub fn run(args: &FlashArgs) -> Result<(), CliError> {
    let image = choice::image_for(args.board, args.elf.as_deref());
    let plan = Plan::for_board(args.board, &image)?;
    if args.json {
        print_result!("{}", serde_json::json!(plan));
    } else {
        print_line!("{} ({}): {} bytes of {}", plan.board, plan.chip, plan.bytes, plan.image);
        for segment in &plan.segments {
            print_line!("  {:#010x}  {:>7} bytes  crc {}", segment.address, segment.bytes, segment.crc32);
        }
        print_line!("  erases {} sectors; starts at {:#010x}", plan.sectors.len(), plan.entry);
    }
    if args.dry_run {
        return Ok(());
    }
    write(args, &plan, &image)
}

#[cfg(feature = "probe")]
fn write(args: &FlashArgs, plan: &Plan, image: &std::path::Path) -> Result<(), CliError> {
    let mut session = crate::flash::probe::write(plan, image, args.probe.as_deref())?;
    eprintln!("written and verified; the controller has started");
    if args.follow {
        crate::flash::probe::follow(&mut session, image, |line| print_line!("{line}"))?;
    }
    Ok(())
}

#[cfg(not(feature = "probe"))]
fn write(_: &FlashArgs, _: &Plan, _: &std::path::Path) -> Result<(), CliError> {
    Err(choice::without_probes("flash ..., or --dry-run"))
}
