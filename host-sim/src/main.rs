//! `host-sim`: runs, records, diagnoses and validates the test bench.

use clap::{Parser, Subcommand};
use host_sim::commands::{
    accuracy, diagnose, figures, flash, laws, link, record, replay, run, sweep, update, validate,
};
use std::process::ExitCode;

/// Simulates a rudder drive's test bench with the controller's own inference code in the loop, and finds what the
/// simulation gets wrong in measured logs.
///
/// Without a command it does the main job: one cycle of bench B (Babbitt, 0.5 mm, +10 kN) with the quantised networks
/// as the bearing force and the estimator following it, a summary, a log and a report in `out/run`.
#[derive(Parser)]
#[command(
    version,
    after_help = "Examples:\n  host-sim\n  host-sim run --bearing plastic --clearance-mm 1 --out out/plastic\n  \
    host-sim record --cycles 5 --seed 7 --out log.csv\n  host-sim diagnose log.csv --out out/diagnosis\n  host-sim sweep clearance\n  host-sim figures --out out/figures\n\n\
    Exit codes: 0 done, 1 the work failed, 2 the input is wrong."
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Run the bench with the networks or the law, and the estimator beside it.
    Run(run::RunArgs),
    /// Write a log of the bench as its sensors would take it.
    Record(record::RecordArgs),
    /// Say a recorded conversation to a controller again, or give it the samples of a measured log.
    Replay(replay::ReplayArgs),
    /// Say what a simulation gets wrong in measured logs, name the cause, measure the gain.
    Diagnose(diagnose::DiagnoseArgs),
    /// Vary clearance, load, floor of the approach speed or any parameters; judge the paper's claims.
    Sweep(sweep::SweepArgs),
    /// Run the paper's Figs. 16-20 again, with the table of its claims.
    Figures(figures::FiguresArgs),
    /// Measure how far networks and estimator are from the law, over clearances, loads and bearings.
    Accuracy(accuracy::AccuracyArgs),
    /// Write the firmware to a board, or check what would be written.
    Flash(flash::FlashArgs),
    /// List the contact and friction laws that a bench description may name.
    Laws(laws::LawsArgs),
    /// Say who a controller is, how it started and what it counted; configure it.
    Link(link::LinkArgs),
    /// Bring a signed model package to a controller.
    Update(update::UpdateArgs),
    /// Compare the models with published known answers.
    Validate(validate::ValidateArgs),
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    let result = match cli.command {
        None => run::run(&run::RunArgs::default_job()),
        Some(Command::Run(args)) => run::run(&args),
        Some(Command::Record(args)) => record::run(&args),
        Some(Command::Replay(args)) => replay::run(&args),
        Some(Command::Diagnose(args)) => diagnose::run(&args),
        Some(Command::Sweep(args)) => sweep::run(&args),
        Some(Command::Figures(args)) => figures::run(&args),
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
