//! `host-sim claims`: judges the paper's claims as run, settled, and over a parameter box.

use crate::cli::error::CliError;
use crate::cli::options::thread_count;
use crate::reproduction::campaign::report::{self, Options};
use crate::sweep::options::open_published;
use clap::Args;
use std::path::PathBuf;

/// Maximum number of draws.
const MAX_RUNS: u64 = 100_000;

/// Parser of the number of draws.
fn number_of_runs() -> clap::builder::RangedU64ValueParser<u64> {
    clap::value_parser!(u64).range(1..=MAX_RUNS)
}

/// Arguments of `host-sim claims`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  host-sim claims --runs 200\n  host-sim claims --runs 2000 --seed 2 --out \
                  out/claims --json\n\nA campaign resumes after a kill, and can be extended: run the same \
                  command again."
)]
pub struct ClaimsArgs {
    /// Preset or bench description whose unstated parameters are drawn.
    #[arg(long, default_value = "bench-b", value_name = "NAME|FILE")]
    pub bench: String,
    /// Draws of the parameter box; each has eighteen runs of five cycles.
    #[arg(long, default_value_t = 2000, value_name = "N", value_parser = number_of_runs())]
    pub runs: u64,
    /// Seed of the draws.
    #[arg(long, default_value_t = 1, value_name = "N")]
    pub seed: u64,
    /// Threads; 0 uses one per core. The result does not depend on it.
    #[arg(long, default_value_t = 0, value_name = "N", value_parser = thread_count())]
    pub threads: usize,
    /// Folder for the journal, the CSV and JSON files, the pictures (SVG) and report.html.
    #[arg(long, default_value = "out/claims", value_name = "DIR")]
    pub out: PathBuf,
    /// Print the result as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
pub fn run(args: &ClaimsArgs) -> Result<(), CliError> {
    let options = Options {
        base: open_published(&args.bench)?,
        runs: args.runs as usize,
        seed: args.seed,
        threads: args.threads,
    };
    report::run(&options, &args.out, args.json)
}
