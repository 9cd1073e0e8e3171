//! Training of both networks of a bearing, with state files.

use crate::data::file_io::{WriteError, write_atomically};
use crate::network::NetworkKind;
use crate::network::checkpoint::{Checkpoint, Trained};
use crate::network::recipe::Recipe;
use crate::train::sources::Sources;
use crate::train::{Loss, Progress, StateError, Training};
use inference::BearingMaterial;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Files that hold the state of a running training.
#[derive(Clone, Debug)]
pub struct StateFiles {
    /// Directory of the state files.
    pub directory: PathBuf,
    /// Minimum time between two states of a network; the state after the last epoch is always
    /// written.
    pub interval: Duration,
    /// Resume from existing states.
    pub resume: bool,
}

impl StateFiles {
    /// Path of the state file of a network.
    pub(crate) fn file(&self, bearing: BearingMaterial, network: NetworkKind) -> PathBuf {
        self.directory.join(format!("{}-{}.training", bearing.name(), network.name()))
    }
}

/// Reason why a training failed.
#[derive(Debug, thiserror::Error)]
pub enum TrainError {
    /// A state file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A state file is damaged or belongs to another training.
    #[error("{}: {source}", path.display())]
    State {
        /// The file.
        path: PathBuf,
        /// Error in its content.
        source: StateError,
    },
    /// A state file could not be written.
    #[error("{0}")]
    Write(#[from] WriteError),
    /// The receiver of the reports ended the training.
    #[error("training: ended before its last epoch")]
    Ended,
    /// The state could not be encoded.
    #[error("training state: {0}")]
    Json(#[from] serde_json::Error),
}

/// A checkpoint and the histories of both networks, collision first.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Trained networks.
    pub checkpoint: Checkpoint,
    /// All epochs of both networks.
    pub histories: [Vec<Progress>; 2],
}

fn read_state(path: &Path) -> Result<Option<Vec<u8>>, TrainError> {
    match std::fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(source) => Err(TrainError::Read { path: path.to_owned(), source }),
    }
}

/// Trains both networks. `report` is called after every epoch and for the epochs of a resumed
/// state; `Break` ends the training.
///
/// # Errors
///
/// State files cannot be read, belong to another training, or cannot be written; `report` ended the
/// training.
pub fn train_both(
    bearing: BearingMaterial,
    recipe: &Recipe,
    states: Option<&StateFiles>,
    report: &mut dyn FnMut(NetworkKind, Progress) -> ControlFlow<()>,
) -> Result<Outcome, TrainError> {
    let sources = Sources::new(bearing, recipe);
    let mut one = |network: NetworkKind| -> Result<(Trained, Vec<Progress>), TrainError> {
        let (rows, validation) = sources.parts_for(network);
        let mut training =
            Training::new(recipe, network.shape(), (&rows, &validation), Loss::Clamped, network as u64);
        if let Some(states) = states.filter(|states| states.resume) {
            let path = states.file(bearing, network);
            if let Some(bytes) = read_state(&path)? {
                training.resume_from(&bytes).map_err(|source| TrainError::State { path, source })?;
            }
        }
        if training.history().iter().any(|progress| report(network, *progress).is_break()) {
            return Err(TrainError::Ended);
        }
        let mut saved_at = Instant::now();
        while !training.is_done() {
            let progress = training.epoch();
            if let Some(states) = states
                && (saved_at.elapsed() >= states.interval || training.is_done())
            {
                write_atomically(&states.file(bearing, network), &training.to_bytes()?)?;
                saved_at = Instant::now();
            }
            if report(network, progress).is_break() {
                return Err(TrainError::Ended);
            }
        }
        Ok((training.finish(), training.history().to_vec()))
    };
    let (collision, first) = one(NetworkKind::Collision)?;
    let (friction, second) = one(NetworkKind::Friction)?;
    let checkpoint = Checkpoint { recipe: recipe.clone(), bearing, collision, friction };
    Ok(Outcome { checkpoint, histories: [first, second] })
}
