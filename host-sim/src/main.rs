//! `host-sim`: runs, records, diagnoses and validates the test bench.

use clap::{Parser, Subcommand};
use host_sim::commands::{
    accuracy, check, claims, describe, diagnose, evaluate, figures, flash, laws, link, record, replay, run,
    sweep, update, validate,
};
use host_sim::run::RunArgs;
use std::process::ExitCode;

/// Simulates a rudder drive's test bench with the controller's own inference code in the loop, and
/// finds what the simulation gets wrong in measured logs.
///
/// Without a command it does the main job: one cycle of bench B (Babbitt, 0.5 mm, +10 kN) with the
/// quantised networks as the bearing force and the estimator following it, a summary, a log and a
/// report in `out/run`.
#[derive(Parser)]
#[command(
    version,
    after_help = "Examples:\n  host-sim\n  \
    host-sim run --bearing plastic --clearance-mm 1 --out out/plastic\n  \
    host-sim record --cycles 5 --seed 7 --out log.csv\n  host-sim describe log.csv --out my-bench.toml\n  \
    host-sim check log.csv --bench my-bench.toml\n  \
    host-sim evaluate log.csv --bench my-bench.toml\n  \
    host-sim diagnose log.csv --bench my-bench.toml --out out/diagnosis\n  \
    host-sim sweep clearance\n  host-sim figures --out out/figures\n\n\
    Exit codes: 0 done, 1 the work failed, 2 the input is wrong."
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Run the bench with the networks or the law as bearing force, with the estimator in lockstep.
    Run(RunArgs),
    /// Simulate a log as the bench's sensors would record it.
    Record(record::RecordArgs),
    /// Replay a recorded link session or a measured log on a controller.
    Replay(replay::ReplayArgs),
    /// Write a commented description template for a log.
    Describe(describe::DescribeArgs),
    /// Judge logs and description: data quality, units, parameters that the motion does not show.
    Check(check::CheckArgs),
    /// Simulate a described bench under the inputs of logs and compare; fit nothing.
    Evaluate(evaluate::EvaluateArgs),
    /// Find what a simulation gets wrong in measured logs, name the cause, measure the gain.
    Diagnose(diagnose::DiagnoseArgs),
    /// Vary clearance, load, damping speed, communication step or any parameters; evaluate the
    /// paper's claims.
    Sweep(sweep::SweepArgs),
    /// Reproduce the paper's pictures on one page, with its claims as run and settled.
    Figures(figures::FiguresArgs),
    /// Judge the paper's claims as run, settled, and over the parameters that the paper leaves out.
    Claims(claims::ClaimsArgs),
    /// Measure the errors of networks and estimator against the law, over clearances, loads and
    /// bearings.
    Accuracy(accuracy::AccuracyArgs),
    /// Write the firmware to a board, or check what would be written.
    Flash(flash::FlashArgs),
    /// List the contact and friction laws that a bench description may name.
    Laws(laws::LawsArgs),
    /// Print a controller's device info (identity, last start, counters); configure it.
    Link(link::LinkArgs),
    /// Transfer a signed model package to a controller.
    Update(update::UpdateArgs),
    /// Compare the models with published known answers.
    Validate(validate::ValidateArgs),
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    let result = match cli.command {
        None => run::run(&RunArgs::default_job()),
        Some(Command::Run(args)) => run::run(&args),
        Some(Command::Record(args)) => record::run(&args),
        Some(Command::Replay(args)) => replay::run(&args),
        Some(Command::Describe(args)) => describe::run(&args),
        Some(Command::Check(args)) => check::run(&args),
        Some(Command::Evaluate(args)) => evaluate::run(&args),
        Some(Command::Diagnose(args)) => diagnose::run(&args),
        Some(Command::Sweep(args)) => sweep::run(&args),
        Some(Command::Figures(args)) => figures::run(&args),
        Some(Command::Claims(args)) => claims::run(&args),
        Some(Command::Accuracy(args)) => accuracy::run(&args),
        Some(Command::Flash(args)) => flash::run(&args),
        Some(Command::Laws(args)) => laws::run(&args),
        Some(Command::Link(args)) => link::run(&args),
        Some(Command::Update(args)) => update::run(&args),
        Some(Command::Validate(args)) => validate::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}
