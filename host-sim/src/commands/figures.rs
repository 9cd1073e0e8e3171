//! `host-sim figures`: the paper's Figs. 16-20 and its claims in one go.

use super::sweep::RunOptions;
use super::sweep_paper;
use crate::error::CliError;
use crate::paper::Series;
use clap::Args;
use std::path::PathBuf;

/// Arguments of `host-sim figures`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  host-sim figures --out out/figures\n  host-sim figures --force law --json"
)]
pub struct FiguresArgs {
    /// How the runs are done.
    #[command(flatten)]
    pub runs: RunOptions,
    /// Folder for the pictures (SVG), the CSV, the JSON and report.html.
    #[arg(long, default_value = "out/figures", value_name = "DIR")]
    pub out: PathBuf,
    /// Print the outcome as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
pub fn run(args: &FiguresArgs) -> Result<(), CliError> {
    sweep_paper::run(&args.runs, &[Series::Clearance, Series::Load], &args.out, args.json)
}
