//! Errors of the commands and their exit codes.

use crate::data::bench_runs::RunError;
use crate::data::cleaning_chart::PictureError;
use crate::data::file_io::{FileError, WriteError};
use crate::data::friction_source::FrictionError;
use crate::evaluate::peers::{ResultsError, WindowsError};
use crate::exchange::c_package::LibrariesError;
use crate::exchange::error::OnnxError;
use crate::exchange::key::KeyError;
use crate::exchange::package::PackageError;
use crate::exchange::samples::SamplesError;
use crate::network::checkpoint::{CheckpointError, LoadError};
use crate::quantise::QuantiseError;
use crate::report::training::ReportError;
use crate::train::pipeline::TrainError;
use inference::ImageError;
use std::path::PathBuf;

/// Maximum size of an ONNX or safetensors file in bytes.
pub(super) const MAX_FILE_BYTES: u64 = 64 << 20;

/// Input file that was refused.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ImportError {
    #[error("{}: {source}", path.display())]
    Onnx { path: PathBuf, source: Box<OnnxError> },
    #[error("{}: {source}", path.display())]
    Samples { path: PathBuf, source: SamplesError },
    #[error("{}: found more bytes, expected at most {MAX_FILE_BYTES}", .0.display())]
    Length(PathBuf),
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
    Import(#[from] ImportError),
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
    pub(super) fn exit_code(&self) -> u8 {
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
