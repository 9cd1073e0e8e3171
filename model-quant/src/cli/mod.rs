//! Commands of the program `model-quant` and their shared parts.
//!
//! Exit status: 0 done; 1 the work failed or a check found a difference; 2 the input is wrong.

mod checkpoint;
mod dataset;
mod error;
mod export;
mod generate;
mod import;
mod key;
mod output;
mod package;
mod quantize;
mod report;
mod shell;
mod train;
mod verify;

use clap::{CommandFactory, Parser, Subcommand};
use error::CliError;
use std::ffi::OsString;
use std::process::ExitCode;

/// Maximum number of worker threads.
const MAX_THREADS: i64 = 1024;

/// Data sets, training, quantisation and verification of the contact networks.
#[derive(Debug, Parser)]
#[command(version, about, max_term_width = 100)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// Number of worker threads; 0: one for each core. It does not change any result
    #[arg(
        long,
        global = true,
        default_value_t = 0,
        value_name = "N",
        value_parser = clap::value_parser!(u16).range(..=MAX_THREADS)
    )]
    threads: u16,
}

#[derive(Debug, Subcommand)]
enum Command {
    Dataset(dataset::Arguments),
    Train(train::Arguments),
    Quantize(quantize::Arguments),
    Import(import::Arguments),
    Export(export::Arguments),
    Generate(generate::Arguments),
    Verify(verify::Arguments),
    Report(report::Arguments),
    Key(key::Arguments),
    Package(package::Arguments),
    Completions(shell::CompletionsArguments),
    Man(shell::ManualArguments),
}

/// Returns the definition of the command line.
pub fn definition() -> clap::Command {
    Arguments::command()
}

/// Runs the program with the process's arguments and returns its exit code.
pub fn main() -> ExitCode {
    ExitCode::from(run_with(std::env::args_os().collect()))
}

/// Runs the program with arguments, the first of which is its name. Prints an error and returns the
/// exit code.
pub fn run_with(arguments: Vec<OsString>) -> u8 {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(usage) => {
            // Nothing is left to do if the terminal is gone.
            let _ = usage.print();
            return u8::try_from(usage.exit_code()).unwrap_or(u8::MAX);
        }
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(arguments.threads.into()).build();
    match pool.map_err(CliError::from).and_then(|pool| pool.install(|| run(&arguments))) {
        Ok(()) => 0,
        Err(error) => {
            eprintln!("error: {error}");
            error.exit_code()
        }
    }
}

/// Runs a command.
fn run(arguments: &Arguments) -> Result<(), CliError> {
    match &arguments.command {
        Command::Dataset(arguments) => dataset::run(arguments),
        Command::Train(arguments) => train::run(arguments),
        Command::Quantize(arguments) => quantize::run(arguments),
        Command::Import(arguments) => import::run(arguments),
        Command::Export(arguments) => export::run(arguments),
        Command::Generate(arguments) => generate::run(arguments),
        Command::Verify(arguments) => verify::run(arguments),
        Command::Key(arguments) => key::run(arguments),
        Command::Package(arguments) => package::run(arguments),
        Command::Report(arguments) => report::run(arguments),
        Command::Completions(arguments) => shell::completions(arguments, definition()),
        Command::Man(arguments) => shell::manual(arguments, definition()),
    }
}
