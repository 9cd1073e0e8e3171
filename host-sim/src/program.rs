//! The program: its commands and their dispatch.

use crate::cli::console::ConsoleOptions;
use crate::cli::error::CliError;
use crate::cli::{progress, provenance};
use crate::commands::{
    accuracy, check, claims, compare, completions, describe, diagnose, evaluate, export_fmu, figures, flash,
    laws, life, link, log, manual, record, replay, run, schema, sweep, update, validate,
};
use crate::run::RunArgs;
use clap::{CommandFactory, Parser, Subcommand};
use std::ffi::OsString;
use std::process::ExitCode;
use std::time::Instant;

/// Simulates a rudder drive's test bench with the controller's own inference code in the loop, and
/// finds what the simulation gets wrong in measured logs.
///
/// Without a command it does the main job: one cycle of bench B (Babbitt, 0.5 mm, +10 kN) with the
/// quantised networks as the bearing force and the estimator following it, a summary, a log and a
/// report in `out/run`.
#[derive(Parser)]
#[command(
    version,
    max_term_width = 100,
    after_help = "Examples:\n  host-sim\n  \
    host-sim run --bearing plastic --clearance-mm 1 --out out/plastic\n  \
    host-sim record --cycles 5 --seed 7 --out log.csv\n  host-sim describe log.csv --out my-bench.toml\n  \
    host-sim check log.csv --bench my-bench.toml\n  \
    host-sim evaluate log.csv --bench my-bench.toml\n  \
    host-sim diagnose log.csv --bench my-bench.toml --out out/diagnosis\n  \
    host-sim sweep clearance\n  host-sim figures --out out/figures\n\n\
    Exit codes: 0 done, 1 the work failed, 2 the input is wrong."
)]
struct Program {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    console: ConsoleOptions,
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
    /// Show the content of a log file, or convert it to another format.
    Log(log::LogArgs),
    /// Judge logs and description: data quality, units, parameters that the motion does not show.
    Check(check::CheckArgs),
    /// Simulate a described bench under the inputs of logs and compare; fit nothing.
    Evaluate(evaluate::EvaluateArgs),
    /// Compare runs: figures side by side, logs as curves with their differences.
    Compare(compare::CompareArgs),
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
    /// Wear the bearing over its life; predict its clearance and track it with the controller.
    Life(life::LifeArgs),
    /// Write a functional mock-up unit (FMU): contact, bench or mechanism for other simulators.
    ExportFmu(export_fmu::ExportFmuArgs),
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
    /// Commands about the program itself.
    #[command(flatten)]
    Own(OwnCommand),
}

/// Commands about the program itself.
#[derive(Subcommand)]
enum OwnCommand {
    /// Print the completions of the command line for a shell.
    Completions(completions::CompletionsArgs),
    /// Print the JSON schema of a result.
    Schema(schema::SchemaArgs),
    /// Write the manual pages, one for each command.
    Man(manual::ManualArgs),
}

/// Returns the definition of the command line.
#[must_use]
pub fn definition() -> clap::Command {
    Program::command()
}

/// Runs the program with the process's arguments and returns its exit code.
#[must_use]
pub fn main() -> ExitCode {
    ExitCode::from(run_with(std::env::args_os().collect()))
}

/// Runs the program with arguments, the first of which is its name. Prints an error and returns the
/// exit code.
#[must_use]
pub fn run_with(arguments: Vec<OsString>) -> u8 {
    let program = match Program::try_parse_from(&arguments) {
        Ok(program) => program,
        Err(usage) => {
            // Nothing is left to do if the terminal is gone.
            let _ = usage.print();
            return u8::try_from(usage.exit_code()).unwrap_or(u8::MAX);
        }
    };
    let start = Instant::now();
    let result = start_command(program, arguments);
    progress::print_duration(start);
    match result {
        Ok(()) => 0,
        Err(error) => {
            anstream::eprintln!("\u{1b}[1;31merror:\u{1b}[0m {error}");
            error.exit_code()
        }
    }
}

/// Runs a command for another program, as [`run_with`] does, and returns its output, or its error.
/// Calls do not overlap: the options for the terminal are those of the process.
///
/// # Errors
///
/// Those of the command; wrong arguments are wrong input.
pub fn call(arguments: Vec<OsString>) -> Result<String, CliError> {
    match Program::try_parse_from(&arguments) {
        Ok(program) => {
            let (result, output) = crate::say::keeping(|| start_command(program, arguments));
            result.map(|()| output)
        }
        Err(asked) if asked.exit_code() == 0 => Ok(asked.to_string()),
        Err(usage) => Err(CliError::Input(usage.to_string().trim_end().to_owned())),
    }
}

/// Makes the options those of the process, and runs the command.
fn start_command(program: Program, arguments: Vec<OsString>) -> Result<(), CliError> {
    program.console.apply();
    provenance::note_start(arguments)?;
    dispatch(program.command.unwrap_or_else(|| Command::Run(RunArgs::default_job())))
}

fn dispatch(command: Command) -> Result<(), CliError> {
    match command {
        Command::Run(args) => run::run(&args),
        Command::Record(args) => record::run(&args),
        Command::Replay(args) => replay::run(&args),
        Command::Describe(args) => describe::run(&args),
        Command::Log(args) => log::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Evaluate(args) => evaluate::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Diagnose(args) => diagnose::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Figures(args) => figures::run(&args),
        Command::Claims(args) => claims::run(&args),
        Command::Accuracy(args) => accuracy::run(&args),
        Command::Life(args) => life::run(&args),
        Command::ExportFmu(args) => export_fmu::run(&args),
        Command::Flash(args) => flash::run(&args),
        Command::Laws(args) => laws::run(&args),
        Command::Link(args) => link::run(&args),
        Command::Update(args) => update::run(&args),
        Command::Validate(args) => validate::run(&args),
        Command::Own(command) => dispatch_own(command),
    }
}

fn dispatch_own(command: OwnCommand) -> Result<(), CliError> {
    match command {
        OwnCommand::Completions(args) => completions::run(&args, definition()),
        OwnCommand::Schema(args) => schema::run(&args),
        OwnCommand::Man(args) => manual::run(&args, definition()),
    }
}
