//! `host-sim figures`: reproduces the paper's pictures on one page and evaluates its claims.

use crate::cli::error::CliError;
use crate::reproduction::report::{self, Content};
use crate::sweep::options::SweepOptions;
use clap::Args;
use std::path::PathBuf;

/// Arguments of `host-sim figures`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  host-sim figures --out out/figures\n  host-sim figures --force law --json"
)]
pub struct FiguresArgs {
    /// Options of the runs.
    #[command(flatten)]
    pub runs: SweepOptions,
    /// Folder for the pictures (SVG), the CSV, the JSON and report.html.
    #[arg(long, default_value = "out/figures", value_name = "DIR")]
    pub out: PathBuf,
    /// Print the result as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
pub fn run(args: &FiguresArgs) -> Result<(), CliError> {
    report::run(&args.runs, Content::Paper, &args.out, args.json)
}
