//! The training of both networks of a bearing, as the command line runs it.

use crate::checkpoint::Checkpoint;
use crate::recipe::Recipe;
use crate::shapes;
use crate::sources::Sources;
use crate::train::{Loss, Progress, StateError, Trained, Training};
use crate::write::{WriteError, write_whole};
use inference::Bearing;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// One of the two networks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Network {
    /// State of the contact to normal force.
    Collision,
    /// Normal force and sliding speed to friction.
    Friction,
}

impl Network {
    /// Both, in the order of a checkpoint.
    pub const ALL: [Self; 2] = [Self::Collision, Self::Friction];

    /// Lower-case name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Collision => "collision",
            Self::Friction => "friction",
        }
    }
}

/// Where a training is kept while it runs.
#[derive(Clone, Debug)]
pub struct Keep {
    /// Directory of the state files.
    pub directory: PathBuf,
    /// Least time between two states of a network; the last epoch's is always kept.
    pub every: Duration,
    /// Whether to go on from the states that are there.
    pub resume: bool,
}

impl Keep {
    /// The state file of a network.
    pub fn file(&self, bearing: Bearing, network: Network) -> PathBuf {
        self.directory.join(format!("{}-{}.training", bearing.name(), network.name()))
    }
}

/// Why a training could not go on.
#[derive(Debug, thiserror::Error)]
pub enum TrainError {
    /// A state file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A state file does not fit.
    #[error("{}: {source}", path.display())]
    State {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: StateError,
    },
    /// A state file could not be written.
    #[error("{0}")]
    Write(#[from] WriteError),
    /// Notes could not be written.
    #[error("training state: {0}")]
    Json(#[from] serde_json::Error),
}

/// A checkpoint and the histories of its two trainings, collision first.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The networks.
    pub checkpoint: Checkpoint,
    /// Every epoch of both trainings.
    pub histories: [Vec<Progress>; 2],
}

fn saved(path: &Path) -> Result<Option<Vec<u8>>, TrainError> {
    match std::fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(source) => Err(TrainError::Read { path: path.to_owned(), source }),
    }
}

/// Trains both networks; `report` is called after every epoch, and for those that were done before.
///
/// # Errors
///
/// State files that cannot be read, do not fit, or cannot be written.
pub fn train_both(
    bearing: Bearing,
    recipe: &Recipe,
    keep: Option<&Keep>,
    report: &mut dyn FnMut(Network, Progress),
) -> Result<Outcome, TrainError> {
    let sources = Sources::new(bearing, recipe);
    let mut one = |network: Network| -> Result<(Trained, Vec<Progress>), TrainError> {
        let shape = match network {
            Network::Collision => shapes::collision(),
            Network::Friction => shapes::friction(),
        };
        let (rows, validation) = sources.of(network);
        let mut training = Training::new(recipe, shape, (&rows, &validation), Loss::Clamped, network as u64);
        if let Some(keep) = keep.filter(|keep| keep.resume) {
            let path = keep.file(bearing, network);
            if let Some(bytes) = saved(&path)? {
                training.take_up(&bytes).map_err(|source| TrainError::State { path, source })?;
            }
        }
        training.history().iter().for_each(|progress| report(network, *progress));
        let mut kept = Instant::now();
        while !training.is_done() {
            let progress = training.epoch();
            if let Some(keep) = keep
                && (kept.elapsed() >= keep.every || training.is_done())
            {
                write_whole(&keep.file(bearing, network), &training.to_bytes()?)?;
                kept = Instant::now();
            }
            report(network, progress);
        }
        Ok((training.finish(), training.history().to_vec()))
    };
    let (collision, first) = one(Network::Collision)?;
    let (friction, second) = one(Network::Friction)?;
    let checkpoint = Checkpoint { recipe: recipe.clone(), bearing, collision, friction };
    Ok(Outcome { checkpoint, histories: [first, second] })
}
