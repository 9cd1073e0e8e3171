//! The commands and what they share.

mod dataset;
mod export;
mod import;
mod key;
mod package;
mod quantize;
mod report;
mod train;
mod verify;

use clap::{Parser, Subcommand};
use inference::{Bearing, ImageError};
use model_quant::bench_loop::BenchLoopError;
use model_quant::checkpoint::{Checkpoint, CheckpointError, bearing_named};
use model_quant::dataset::bench_runs::RunError;
use model_quant::dataset::friction_source::FrictionError;
use model_quant::dataset::picture::PictureError;
use model_quant::float_pair::{LoadError, read_checkpoint, shipped};
use model_quant::key::KeyError;
use model_quant::package::PackageError;
use model_quant::peers::{ResultsError, WindowsError};
use model_quant::pipeline::TrainError;
use model_quant::quantise::QuantiseError;
use model_quant::training_report::{FileError, ReportError};
use model_quant::write::WriteError;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Data sets, training, quantisation and verification of the contact networks.
#[derive(Debug, Parser)]
#[command(version, about)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// Worker threads; 0 takes one per core. The result does not depend on it.
    #[arg(long, global = true, default_value_t = 0, value_name = "N")]
    threads: usize,
}

#[derive(Debug, Subcommand)]
enum Command {
    Dataset(dataset::Arguments),
    Train(train::Arguments),
    Quantize(quantize::Arguments),
    Import(import::Arguments),
    Export(export::Arguments),
    Verify(verify::Arguments),
    Report(report::Arguments),
    Key(key::Arguments),
    Package(package::Arguments),
}

/// Why a command ended without its result.
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
    Windows(#[from] WindowsError),
    #[error("{0}: found {1}, expected {2}")]
    Argument(&'static str, String, &'static str),
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
    BenchLoop(#[from] BenchLoopError),
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
    /// 2 for wrong input, 1 for failed work.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Load(_)
            | Self::Read { .. }
            | Self::Image { .. }
            | Self::Results { .. }
            | Self::Import(_)
            | Self::Key { .. }
            | Self::Package { .. }
            | Self::File(_)
            | Self::Report(ReportError::File(_))
            | Self::BenchLoop(_)
            | Self::Train(TrainError::State { .. })
            | Self::Argument(..) => 2,
            Self::Friction(error) if error.is_wrong_input() => 2,
            _ => 1,
        }
    }
}

/// Runs a command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    rayon::ThreadPoolBuilder::new().num_threads(arguments.threads).build_global()?;
    match &arguments.command {
        Command::Dataset(arguments) => dataset::run(arguments),
        Command::Train(arguments) => train::run(arguments),
        Command::Quantize(arguments) => quantize::run(arguments),
        Command::Import(arguments) => import::run(arguments),
        Command::Export(arguments) => export::run(arguments),
        Command::Verify(arguments) => verify::run(arguments),
        Command::Key(arguments) => key::run(arguments),
        Command::Package(arguments) => package::run(arguments),
        Command::Report(arguments) => report::run(arguments),
    }
}

/// Reads a bearing's name.
fn parse_bearing(name: &str) -> Result<Bearing, String> {
    bearing_named(name).ok_or_else(|| format!("found `{name}`, expected `babbitt` or `plastic`"))
}

/// The bearings asked for: one, or both.
fn bearings(chosen: Option<Bearing>) -> Vec<Bearing> {
    chosen.map_or_else(|| Bearing::ALL.to_vec(), |bearing| vec![bearing])
}

/// A checkpoint and its training id: from a file, or the checked-in one of a bearing.
fn checkpoint(file: Option<&Path>, bearing: Bearing) -> Result<(Checkpoint, u64), CliError> {
    let (checkpoint, bytes) = match file {
        Some(path) => read_checkpoint(path)?,
        None => (Checkpoint::from_bytes(shipped(bearing))?, shipped(bearing).to_vec()),
    };
    Ok((checkpoint, Checkpoint::training_id(&bytes)))
}

fn print_json(value: &impl serde::Serialize) -> Result<(), CliError> {
    print(format_args!("{}", serde_json::to_string_pretty(value)?))
}

/// Prints a line; a reader that has gone away is no error.
fn print(line: std::fmt::Arguments<'_>) -> Result<(), CliError> {
    match writeln!(std::io::stdout(), "{line}") {
        Err(source) if source.kind() != std::io::ErrorKind::BrokenPipe => Err(CliError::Output(source)),
        _ => Ok(()),
    }
}
