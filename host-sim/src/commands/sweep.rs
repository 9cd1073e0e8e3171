//! `host-sim sweep`: varies the paper's clearances or loads, the damping's speeds, the
//! communication step, or any parameters.

use crate::cli::error::CliError;
use crate::reproduction::report::{self, Content};
use crate::reproduction::runs::Series;
use crate::shard::Shard;
use crate::sweep::options::SweepOptions;
use crate::sweep::{file, latch, step};
use clap::Args;
use std::path::{Path, PathBuf};

/// Arguments of `host-sim sweep`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  host-sim sweep clearance\n  host-sim sweep load --force law --out out/load\n  \
    host-sim sweep latch\n  host-sim sweep step\n  \
    host-sim sweep examples/sweep-clearance-mass.toml --threads 4 --json\n  \
    host-sim sweep examples/sweep-uncertainty.toml --shard 1/2 --out s1\n  \
    host-sim sweep merge examples/sweep-uncertainty.toml s1 s2\n\n\
    A sweep from a file, or a shard of it, resumes after a kill: run the same command again."
)]
pub struct SweepArgs {
    /// `clearance`: .1, .25, .5 and 1 mm at +10 kN (Figs. 16-18). `load`: +10 to -10 kN at 1 mm
    /// (Figs. 19, 20). `latch`: forms of the damping and their speeds, 1 to 200 mm/s. `step`:
    /// communication steps of a held force, 1 to 200 us. Or a file: parameters and their ranges.
    /// `merge`: the results of a file's shards.
    #[arg(value_name = "clearance|load|latch|step|FILE|merge")]
    pub what: String,
    /// For `merge`: the file, then the folder of every shard.
    #[arg(value_name = "FILE SHARD")]
    pub merged: Vec<PathBuf>,
    /// Execute only shard I of N of a file: the runs, numbered from 0, whose number is I - 1 modulo
    /// N. Writes a journal for `merge` and no results.
    #[arg(long, value_name = "I/N")]
    pub shard: Option<Shard>,
    /// Options of the runs.
    #[command(flatten)]
    pub runs: SweepOptions,
    /// Folder for the CSV, the JSON, the pictures and report.html; by default out/sweep-WHAT.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the outcome as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
pub fn run(args: &SweepArgs) -> Result<(), CliError> {
    let folder =
        |name: &str| args.out.clone().unwrap_or_else(|| Path::new("out").join(format!("sweep-{name}")));
    let stem = |path: &Path| {
        let stem = path.file_stem().map_or_else(|| "file".into(), |s| s.to_string_lossy());
        stem.strip_prefix("sweep-").unwrap_or(&stem).to_owned()
    };
    check(args)?;
    match args.what.as_str() {
        "merge" => {
            let Some((path, shards)) = args.merged.split_first() else { return Ok(()) };
            file::merge(&path.to_string_lossy(), &args.runs, shards, &folder(&stem(path)), args.json)
        }
        "clearance" => {
            report::run(&args.runs, Content::Series(Series::Clearance), &folder("clearance"), args.json)
        }
        "load" => report::run(&args.runs, Content::Series(Series::Load), &folder("load"), args.json),
        "latch" => latch::run(&args.runs, &folder("latch"), args.json),
        "step" => step::run(&args.runs, &folder("step"), args.json),
        path => match args.shard {
            Some(shard) => {
                let beside = || folder(&stem(Path::new(path))).join(shard.folder());
                let folder = args.out.clone().unwrap_or_else(beside);
                file::run_shard(path, &args.runs, shard, &folder, args.json)
            }
            None => file::run(path, &args.runs, &folder(&stem(Path::new(path))), args.json),
        },
    }
}

/// Refuses combinations of arguments that mean nothing.
fn check(args: &SweepArgs) -> Result<(), CliError> {
    let is_merge = args.what == "merge";
    let is_named = ["clearance", "load", "latch", "step"].contains(&args.what.as_str());
    let wrong = |found: String, expected: &str| {
        Err(CliError::Input(format!("sweep {}: found {found}; expected {expected}", args.what)))
    };
    match (&args.merged[..], args.shard) {
        ([] | [_], None) if is_merge => {
            wrong("no shard".into(), "the file of the sweep, then the folder of every shard")
        }
        (_, Some(shard)) if is_merge || is_named => {
            wrong(format!("--shard {shard}"), "a file, whose runs are numbered")
        }
        ([more, ..], _) if !is_merge => wrong(more.display().to_string(), "no more arguments"),
        _ => Ok(()),
    }
}
