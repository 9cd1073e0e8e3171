//! Commands of the program `model-quant` and their shared parts.
//!
//! Exit status: 0 done; 1 the work failed or a check found a difference; 2 the input is wrong.

mod dataset;
mod export;
mod generate;
mod import;
mod key;
mod package;
mod quantize;
mod report;
mod shell;
mod train;
mod verify;

use crate::data::bench_runs::RunError;
use crate::data::cleaning_chart::PictureError;
use crate::data::file_io::{FileError, WriteError};
use crate::data::friction_source::FrictionError;
use crate::evaluate::peers::{ResultsError, WindowsError};
use crate::exchange::c_package::LibrariesError;
use crate::exchange::key::KeyError;
use crate::exchange::package::PackageError;
use crate::network::checkpoint::{Checkpoint, CheckpointError, LoadError, read_checkpoint};
use crate::network::shipped::shipped_checkpoint;
use crate::quantise::QuantiseError;
use crate::report::training::ReportError;
use crate::train::pipeline::TrainError;
use clap::{CommandFactory, Parser, Subcommand};
use inference::{BearingMaterial, ImageError};
use std::io::Write;
use std::path::{Path, PathBuf};
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

/// Reason why a command failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CliError {
    #[error("{0}")]
    Load(#[from] LoadError),
    #[error("shipped {0}")]
    Shipped(#[from] CheckpointError),
    #[error("{}: {source}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error("{}: {source}", path.display())]
    Image { path: PathBuf, source: ImageError },
    #[error("{}: {source}", path.display())]
    Key { path: PathBuf, source: KeyError },
    #[error("{}: {source}", path.display())]
    Package { path: PathBuf, source: PackageError },
    #[error("random numbers: {0}")]
    Random(getrandom::Error),
    #[error("{}: {source}", path.display())]
    Results { path: PathBuf, source: ResultsError },
    #[error("{0}")]
    Libraries(#[from] LibrariesError),
    #[error("{0}")]
    Windows(#[from] WindowsError),
    #[error("{0}: found {1}, expected {2}")]
    Argument(&'static str, String, &'static str),
    #[error("{}: shape of the network: found {found}; expected {expected}", file.display())]
    Shape { file: PathBuf, found: String, expected: String },
    #[error("{0}")]
    Quantise(#[from] QuantiseError),
    #[error("{0}")]
    Write(#[from] WriteError),
    #[error("{0}")]
    Train(#[from] TrainError),
    #[error("{0}")]
    Run(#[from] RunError),
    #[error("{0}")]
    Friction(#[from] FrictionError),
    #[error("{0}")]
    Picture(#[from] PictureError),
    #[error("{0}")]
    Report(#[from] ReportError),
    #[error("{0}")]
    File(#[from] FileError),
    #[error("{0}")]
    Import(#[from] import::ImportError),
    #[error("safetensors: {0}")]
    Safetensors(#[from] safetensors::SafeTensorError),
    #[error("standard output: {0}")]
    Output(std::io::Error),
    #[error("json: {0}")]
    Json(#[from] serde_json::Error),
    #[error("worker threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    #[error("{0}")]
    Differs(String),
    #[error("{0}")]
    Refused(String),
}

impl CliError {
    /// Exit code: 2 for wrong input, 1 for failed work.
    fn exit_code(&self) -> u8 {
        match self {
            Self::Load(_)
            | Self::Read { .. }
            | Self::Image { .. }
            | Self::Results { .. }
            | Self::Libraries(_)
            | Self::Import(_)
            | Self::Key { .. }
            | Self::Package { .. }
            | Self::File(_)
            | Self::Report(ReportError::File(_))
            | Self::Train(TrainError::Read { .. } | TrainError::State { .. })
            | Self::Argument(..)
            | Self::Shape { .. } => 2,
            Self::Friction(error) if error.is_wrong_input() => 2,
            _ => 1,
        }
    }
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
        Command::Completions(arguments) => shell::completions(arguments, Arguments::command()),
        Command::Man(arguments) => shell::manual(arguments, Arguments::command()),
    }
}

/// Parses the name of a bearing material.
fn parse_bearing(name: &str) -> Result<BearingMaterial, String> {
    let names = || BearingMaterial::ALL.map(|material| format!("`{}`", material.name())).join(" or ");
    BearingMaterial::from_name(name).ok_or_else(|| format!("found `{name}`, expected {}", names()))
}

/// The chosen bearing, or both.
fn bearings(chosen: Option<BearingMaterial>) -> Vec<BearingMaterial> {
    chosen.map_or_else(|| BearingMaterial::ALL.to_vec(), |bearing| vec![bearing])
}

/// Loads a checkpoint and its training id from a file, or the shipped one of a bearing.
fn checkpoint(file: Option<&Path>, bearing: BearingMaterial) -> Result<(Checkpoint, u64), CliError> {
    let (checkpoint, bytes) = match file {
        Some(path) => read_checkpoint(path)?,
        None => (Checkpoint::from_bytes(shipped_checkpoint(bearing))?, shipped_checkpoint(bearing).to_vec()),
    };
    Ok((checkpoint, Checkpoint::training_id(&bytes)))
}

fn print_json(value: &impl serde::Serialize) -> Result<(), CliError> {
    print(format_args!("{}", serde_json::to_string_pretty(value)?))
}

/// Prints a line; a closed pipe is not an error.
fn print(line: std::fmt::Arguments<'_>) -> Result<(), CliError> {
    match writeln!(std::io::stdout(), "{line}") {
        Err(source) if source.kind() != std::io::ErrorKind::BrokenPipe => Err(CliError::Output(source)),
        _ => Ok(()),
    }
}
