//! `host-sim sweep`: the paper's clearances or loads, floors of the latched approach speed, communication steps, or a file's parameters.

use super::{sweep_file, sweep_latch, sweep_paper, sweep_step};
use crate::error::CliError;
use crate::force::{DEFAULT_STEP_S, ForceSource};
use crate::paper::Series;
use bench::Bench;
use bench::description::TransmissionBench;
use clap::Args;
use std::path::{Path, PathBuf};

/// Communication steps that the loop with networks can take, s.
const STEP_RANGE_S: (f64, f64) = (1e-7, 1e-3);

/// Arguments of `host-sim sweep`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  host-sim sweep clearance\n  host-sim sweep load --force law --out out/load\n  \
    host-sim sweep latch\n  host-sim sweep step\n  host-sim sweep examples/sweep-clearance-mass.toml --threads 4 --json\n\n\
    A sweep from a file resumes after a kill: run the same command again."
)]
pub struct SweepArgs {
    /// `clearance`: .1, .25, .5 and 1 mm at +10 kN (Figs. 16-18). `load`: +10 to -10 kN at 1 mm (Figs. 19, 20).
    /// `latch`: forms of the damping and their speeds, 1 to 200 mm/s. `step`: communication steps of a held force, 1 to 200 us. Or a file:
    /// parameters and their ranges.
    #[arg(value_name = "clearance|load|latch|step|FILE")]
    pub what: String,
    /// How the runs are done.
    #[command(flatten)]
    pub runs: RunOptions,
    /// Folder for the CSV, the JSON, the pictures and report.html; by default out/sweep-WHAT.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the outcome as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Options of many runs.
#[derive(Args, Clone, Debug)]
pub struct RunOptions {
    /// Preset or bench description that the runs vary; a file of a sweep names its own.
    #[arg(long, value_name = "NAME|FILE")]
    pub bench: Option<String>,
    /// Source of the bearing force: by default the quantised networks, or what the sweep's file says.
    #[arg(long, value_enum)]
    pub force: Option<ForceSource>,
    /// Communication step of the networks in microseconds: their force is held that long.
    #[arg(long, default_value_t = 1e6 * DEFAULT_STEP_S, value_name = "US", allow_negative_numbers = true)]
    pub step_us: f64,
    /// Threads; 0 takes one a core. The outcome does not depend on it.
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub threads: usize,
}

impl RunOptions {
    /// The communication step, checked.
    pub fn step_s(&self) -> Result<f64, CliError> {
        step_s(self.step_us)
    }

    /// The bench that the runs vary.
    pub fn base(&self) -> Result<TransmissionBench, CliError> {
        let name = self.bench.as_deref().unwrap_or("bench-b");
        match Bench::open(name)? {
            Bench::Transmission(bench) => Ok(*bench),
            Bench::FrictionRig(_) => Err(CliError::Input(format!(
                "{name}: found plant `friction-rig`; expected `transmission-bench`"
            ))),
        }
    }
}

/// A communication step in s from microseconds, checked.
pub(super) fn step_s(step_us: f64) -> Result<f64, CliError> {
    let step_s = step_us * 1e-6;
    if (STEP_RANGE_S.0..=STEP_RANGE_S.1).contains(&step_s) {
        Ok(step_s)
    } else {
        Err(CliError::Input(format!("--step-us: found {step_us}; expected 0.1 to 1000")))
    }
}

/// Runs the command.
pub fn run(args: &SweepArgs) -> Result<(), CliError> {
    let folder =
        |name: &str| args.out.clone().unwrap_or_else(|| Path::new("out").join(format!("sweep-{name}")));
    match args.what.as_str() {
        "clearance" => sweep_paper::run(&args.runs, &[Series::Clearance], &folder("clearance"), args.json),
        "load" => sweep_paper::run(&args.runs, &[Series::Load], &folder("load"), args.json),
        "latch" => sweep_latch::run(&args.runs, &folder("latch"), args.json),
        "step" => sweep_step::run(&args.runs, &folder("step"), args.json),
        file => {
            let stem = Path::new(file).file_stem().map_or_else(|| "file".into(), |s| s.to_string_lossy());
            let name = stem.strip_prefix("sweep-").unwrap_or(&stem).to_owned();
            sweep_file::run(file, &args.runs, &folder(&name), args.json)
        }
    }
}
