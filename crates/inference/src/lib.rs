//! Streaming quantised 1-D convolutional networks for the contact force of a clearance bearing.
//!
//! A [`Model`] is an image of two small networks, read in place: the collision network (state of the contact to normal
//! force) and the friction network (normal force and sliding speed to friction). A [`Pair`] runs both, one sample a
//! step, keeping only the few columns that each layer looks at.
//!
//! Pick a model, push a sample, read newtons:
//!
//! ```
//! # use inference::{Bearing, ContactState, Model, Pair, shipped};
//! let state = ContactState { radial_clearance_m: 0.5e-3, deformation_m: 3e-5, ..ContactState::default() };
//! let mut pair: Pair = Pair::new(Model::load(shipped(Bearing::Babbitt))?);
//! let estimate = pair.push(&state);
//! println!("{} N", estimate.normal_force_n());
//! # assert!(estimate.normal_force_n() > 0.0);
//! # Ok::<(), inference::ImageError>(())
//! ```
//!
//! Networks of other shapes are types, too ([`chain`]); so are the ways to run one: [`Streaming`], [`Interleaved`],
//! [`Windowed`]. All give the same sums, whichever [`kernel`] does the products: on the host, on a Cortex-M, in any order.
//!
//! Activations are 16 bits wide (8 in the compact mode), weights 8 bits (16 in the reference mode), sums 32 bits. That no sum
//! can overflow is proven from the actual weights: for the shipped images when this crate is compiled, for others when they are
//! loaded. From a [`Sample`] to an [`Estimate`] everything is whole numbers.
//!
//! No heap, no panics, no I/O, no time; the only unsafe code is the file of the Cortex-M kernels. Not a safety function: outside the training
//! range the estimate is flagged ([`Flags::OUTSIDE_TRAINING`]), not made right.
#![cfg_attr(not(test), no_std)]

pub mod activation;
mod bearing;
pub mod chain;
mod convolution;
mod error;
mod estimate;
pub mod features;
pub mod fixed;
mod flags;
mod head;
pub mod held;
pub mod image;
mod interleaved;
pub mod kernel;
pub mod model;
mod pair;
mod ring;
mod sample;
pub mod storage;
mod streaming;
mod weights;
mod windowed;

pub use bearing::{Bearing, shipped};
pub use convolution::Convolution;
pub use error::ImageError;
pub use estimate::Estimate;
pub use flags::Flags;
pub use head::{Head, Scale};
pub use image::{Header, Range};
pub use interleaved::Interleaved;
pub use model::{Model, Network, WINDOW};
pub use pair::Pair;
pub use sample::{ContactState, Sample};
pub use streaming::Streaming;
pub use weights::{PackedWeights, Stored, Weights16, WeightsOf};
pub use windowed::{Causal, Pad, Padding, Same, Valid, Windowed};
