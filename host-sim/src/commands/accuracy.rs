//! `host-sim accuracy`: how far networks and estimator are from the law, over clearances, loads and bearings.

use super::output;
use super::sweep::step_s;
use super::{accuracy_pictures, accuracy_report};
use crate::accuracy::conditions::{self, Condition};
use crate::accuracy::goals::{Verdict, judge};
use crate::accuracy::summary::bench_loops;
use crate::accuracy::{Accuracy, Settings, measure};
use crate::error::CliError;
use crate::force::DEFAULT_STEP_S;
use crate::options::BearingName;
use crate::progress;
use bench::BearingMaterial;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

/// Arguments of `host-sim accuracy`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  host-sim accuracy\n  host-sim accuracy --bearing plastic --out out/plastic --json\n  \
    host-sim accuracy --step-us 20 --seed 7\n\n\
    A goal that is not met is an outcome, not a failure: the exit code is 0."
)]
pub struct AccuracyArgs {
    /// Only this bearing; both if not given.
    #[arg(long, value_enum)]
    pub bearing: Option<BearingName>,
    /// Communication step of the networks in microseconds: their force is held that long.
    #[arg(long, default_value_t = 1e6 * DEFAULT_STEP_S, value_name = "US", allow_negative_numbers = true)]
    pub step_us: f64,
    /// Seed of the sensors' noise.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads; 0 takes one a core. The outcome does not depend on it.
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub threads: usize,
    /// Folder for accuracy.json, bench-loop.json (what the model cards tell of it), the pictures and report.html.
    #[arg(long, default_value = "out/accuracy", value_name = "DIR")]
    pub out: PathBuf,
    /// Print the outcome as JSON.
    #[arg(long)]
    pub json: bool,
}

/// What is printed and stored.
#[derive(Serialize)]
pub(super) struct Outcome {
    pub(super) step_us: f64,
    pub(super) seed: u64,
    pub(super) goals: Vec<Verdict>,
    /// Runs on which the analytic law errs less than the estimator's networks on the same signals.
    pub(super) law_wins: usize,
    pub(super) runs: Vec<Accuracy>,
}

/// Runs the command.
pub fn run(args: &AccuracyArgs) -> Result<(), CliError> {
    // Doubled once for the comparison, and once more for that one's own error bar.
    let settings = Settings { step_s: step_s(args.step_us)?, seed: args.seed, threads: args.threads };
    output::ready(&args.out)?;
    let bearing = args.bearing.map(BearingMaterial::from);
    let chosen: Vec<Condition> =
        conditions::all().into_iter().filter(|c| bearing.is_none_or(|b| c.bearing == b)).collect();
    let bar = progress::bar(args.json, chosen.len() as u64);
    bar.set_message("conditions");
    let runs = measure(&chosen, settings, || bar.inc(1))?;
    bar.finish_and_clear();
    let law_wins = runs.iter().filter(|a| a.estimate.law_wins()).count();
    let outcome = Outcome { step_us: args.step_us, seed: args.seed, goals: judge(&runs), law_wins, runs };
    let text = output::json(&outcome)?;
    let pictures = accuracy_pictures::draw(&outcome)?;
    let page = accuracy_report::page(&outcome, &pictures);
    let bench_loop = output::json(&bench_loops(&outcome.runs, settings))?;
    output::write(&args.out, "accuracy.json", &format!("{text}\n"))?;
    output::write(&args.out, "bench-loop.json", &format!("{bench_loop}\n"))?;
    pictures.save(&args.out)?;
    output::write(&args.out, "report.html", &page.render())?;
    if args.json {
        say!("{text}");
    } else {
        accuracy_report::print(&outcome);
        say!("\nreport: {}", args.out.join("report.html").display());
    }
    Ok(())
}
