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

/// Parses the command line and runs the command.
pub fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}

/// Runs a command.
fn run(arguments: &Arguments) -> Result<(), CliError> {
    rayon::ThreadPoolBuilder::new().num_threads(arguments.threads.into()).build_global()?;
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
