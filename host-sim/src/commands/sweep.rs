//! `host-sim sweep`: varies the paper's clearances or loads, the damping's speeds, the
//! communication step, or any parameters.

use crate::cli::error::CliError;
use crate::reproduction::report::{self, Content};
use crate::reproduction::runs::Series;
use crate::sweep::options::SweepOptions;
use crate::sweep::{file, latch, step};
use clap::Args;
use std::path::{Path, PathBuf};

/// Arguments of `host-sim sweep`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  host-sim sweep clearance\n  host-sim sweep load --force law --out out/load\n  \
    host-sim sweep latch\n  host-sim sweep step\n  \
    host-sim sweep examples/sweep-clearance-mass.toml --threads 4 --json\n\n\
    A sweep from a file resumes after a kill: run the same command again."
)]
pub struct SweepArgs {
    /// `clearance`: .1, .25, .5 and 1 mm at +10 kN (Figs. 16-18). `load`: +10 to -10 kN at 1 mm
    /// (Figs. 19, 20). `latch`: forms of the damping and their speeds, 1 to 200 mm/s. `step`:
    /// communication steps of a held force, 1 to 200 us. Or a file: parameters and their ranges.
    #[arg(value_name = "clearance|load|latch|step|FILE")]
    pub what: String,
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
    match args.what.as_str() {
        "clearance" => {
            report::run(&args.runs, Content::Series(Series::Clearance), &folder("clearance"), args.json)
        }
        "load" => report::run(&args.runs, Content::Series(Series::Load), &folder("load"), args.json),
        "latch" => latch::run(&args.runs, &folder("latch"), args.json),
        "step" => step::run(&args.runs, &folder("step"), args.json),
        path => {
            let stem = Path::new(path).file_stem().map_or_else(|| "file".into(), |s| s.to_string_lossy());
            let name = stem.strip_prefix("sweep-").unwrap_or(&stem).to_owned();
            file::run(path, &args.runs, &folder(&name), args.json)
        }
    }
}
