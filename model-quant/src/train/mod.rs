//! Direct training of a network of any shape: Adam on the mean squared error.
//!
//! [`Trainer`] takes batches; [`Training`] goes over epochs of a [`Source`] by a [`Recipe`], first with free weights,
//! then while they are put on the 8-bit grid, and can be stopped and taken up again between two epochs. The bytes of the
//! result depend on the recipe alone, its [`InstructionSet`] among it, and not on the number of threads.

mod block;
mod exact;
#[cfg(test)]
mod gradients;
mod lanes;
mod layout;
mod optimiser;
mod passes;
mod room;
mod state;
mod trainer;
mod training;
mod visits;

pub use lanes::InstructionSet;
pub use optimiser::cosine_rate;
pub use state::StateError;
pub use trainer::{CHUNK, Errors, Loss, Trainer, Windows};
pub use training::{Progress, Source, Training};

use crate::network::Network;

/// The two results of a training.
#[derive(Clone, Debug, PartialEq)]
pub struct Trained {
    /// Free weights.
    pub float: Network,
    /// Weights trained on further so that their rounding costs little.
    pub tuned: Network,
}
