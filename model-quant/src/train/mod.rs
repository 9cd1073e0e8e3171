//! Training of networks of any supported shape: Adam on the mean squared error.
//!
//! [`Trainer`] processes batches. [`Training`] runs the epochs of a [`Source`] by a recipe
//! ([`crate::network::recipe`]): first with free weights, then while they are moved to the 8-bit
//! grid. It can be saved and resumed between two epochs. The bytes of the result depend on the
//! recipe alone and not on the number of threads.

mod block;
mod fixed_point_forward;
pub(crate) mod freezer;
#[cfg(test)]
mod gradient_tests;
pub mod history;
mod lanes;
mod layout;
mod optimiser;
mod passes;
pub mod pipeline;
pub mod rig;
pub mod sources;
mod state;
mod trainer;
mod training;
mod visits;
mod workspace;

pub(crate) use optimiser::cosine_rate;
pub use state::StateError;
pub use trainer::{CHUNK, ErrorSums, Loss, Trainer, Windows};
pub use training::{Progress, Source, Training};
