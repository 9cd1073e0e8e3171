//! `host-sim claims`: judges the paper's claims as run, settled, and over a parameter box.

use crate::cli::error::CliError;
use crate::cli::options::thread_count;
use crate::reproduction::campaign::report::{self, Options};
use crate::shard::Shard;
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
#[command(after_help = "Examples:\n  host-sim claims --runs 200\n  \
    host-sim claims --runs 2000 --seed 2 --out out/claims --json\n  \
    host-sim claims --runs 2000 --shard 1/2 --out s1\n  \
    host-sim claims merge s1 s2 --runs 2000\n\n\
    A campaign or a shard resumes after a kill, and can be extended: run the same command again.")]
pub struct ClaimsArgs {
    /// `merge` and the folder of every shard: the results of the shards, with the same --runs,
    /// --seed and --bench.
    #[arg(value_name = "merge SHARD")]
    pub merged: Vec<PathBuf>,
    /// Judge only shard I of N: the draws, numbered from 0, whose number is I - 1 modulo N. Writes
    /// a journal for `merge` and no results.
    #[arg(long, value_name = "I/N", conflicts_with = "merged")]
    pub shard: Option<Shard>,
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
    let shards: &[PathBuf] = match args.merged.split_first() {
        None => &[],
        Some((word, shards)) if word.as_os_str() == "merge" && !shards.is_empty() => shards,
        Some((word, _)) => {
            let found = word.display();
            return Err(CliError::Input(format!(
                "claims: found {found}; expected `merge` and the folder of every shard"
            )));
        }
    };
    match args.shard {
        Some(shard) => report::run_shard(&options, shard, &args.out, args.json),
        None => report::run(&options, shards, &args.out, args.json),
    }
}
