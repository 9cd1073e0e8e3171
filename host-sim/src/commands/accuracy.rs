//! `host-sim accuracy`: errors of networks and estimator against the law, over clearances, loads
//! and bearings; with `--worlds`, of the estimators in worlds that differ from the description.

use crate::accuracy::conditions::{self, Condition};
use crate::accuracy::goals::evaluate_goals;
use crate::accuracy::summary::bench_loops;
use crate::accuracy::{Outcome, Settings, measure, pictures, report, worlds};
use crate::cli::error::CliError;
use crate::cli::options::{bearing_material, thread_count};
use crate::cli::output::{self, Files};
use crate::cli::progress;
use crate::run::arguments::communication_step_s;
use crate::run::force::DEFAULT_STEP_S;
use bench::BearingMaterial;
use bench::description::TransmissionBench;
use clap::Args;
use std::path::PathBuf;

/// Maximum number of drawn worlds of an operating point: some hours on two cores.
const MAX_WORLDS: i64 = 10_000;

/// Arguments of `host-sim accuracy`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim accuracy\n  \
    host-sim accuracy --bearing plastic --out out/plastic --json\n  \
    host-sim accuracy --step-us 20 --seed 7\n  \
    host-sim accuracy --worlds 20 --out out/worlds\n\n\
    A goal that is not met is an outcome, not a failure: the exit code is 0.")]
pub struct AccuracyArgs {
    /// Only this bearing; both if not given.
    #[arg(long, value_name = "BEARING", value_parser = bearing_material())]
    pub bearing: Option<BearingMaterial>,
    /// Communication step of the networks in microseconds: their force is held constant over it.
    #[arg(long, default_value_t = 1e6 * DEFAULT_STEP_S, value_name = "US", allow_negative_numbers = true,
        conflicts_with = "worlds")]
    pub step_us: f64,
    /// Measure the estimators in an independent simulator instead: in the described bench, in N
    /// benches drawn from its declared uncertainty at each of eight operating points, with each
    /// parameter alone off, and with effects that no description contains.
    #[arg(long, value_name = "N", allow_negative_numbers = true,
        value_parser = clap::value_parser!(u32).range(1..=MAX_WORLDS))]
    pub worlds: Option<u32>,
    /// Seed of the sensors' noise and of drawn worlds.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads; 0 uses one per core. The result does not depend on it.
    #[arg(long, default_value_t = 0, value_name = "N", value_parser = thread_count())]
    pub threads: usize,
    /// Folder for accuracy.json, bench-loop.json (input of the model cards), the pictures and
    /// report.html; with --worlds for worlds.json, its pictures and worlds.html.
    #[arg(long, default_value = "out/accuracy", value_name = "DIR")]
    pub out: PathBuf,
    /// Print the result as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
pub fn run(args: &AccuracyArgs) -> Result<(), CliError> {
    if let Some(draws) = args.worlds {
        let settings = worlds::Settings { draws, seed: args.seed, threads: args.threads };
        return worlds::run(args.bearing, settings, &args.out, args.json);
    }
    // The step is doubled for the comparison, and twice more for the error bars.
    let settings =
        Settings { step_s: communication_step_s(args.step_us)?, seed: args.seed, threads: args.threads };
    output::check_folder(&args.out)?;
    let bearing = args.bearing;
    let chosen: Vec<Condition> =
        conditions::all().into_iter().filter(|c| bearing.is_none_or(|b| c.bearing == b)).collect();
    let bar = progress::bar(chosen.len() as u64);
    bar.set_message("conditions");
    let runs = measure(&chosen, settings, || bar.inc(1))?;
    bar.finish_and_clear();
    let law_wins = runs.iter().filter(|a| a.estimate.law_wins()).count();
    let outcome =
        Outcome { step_us: args.step_us, seed: args.seed, goals: evaluate_goals(&runs), law_wins, runs };
    let pictures = pictures::draw(&outcome)?;
    let page = report::page(&outcome, &pictures, &TransmissionBench::open(conditions::BENCH)?);
    let bench_loop = output::json(&bench_loops(&outcome.runs, settings))?;
    let mut files = Files::new(&args.out);
    let text = files.add_result("accuracy.json", &outcome)?;
    files.add("bench-loop.json", &format!("{bench_loop}\n"))?;
    pictures.add_to(&mut files)?;
    files.add_page("report.html", page)?;
    files.publish()?;
    if args.json {
        print_result!("{text}");
    } else {
        report::print(&outcome);
        print_line!("\nreport: {}", args.out.join("report.html").display());
    }
    Ok(())
}
