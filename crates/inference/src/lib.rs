//! Streaming quantised 1-D convolutional networks for the contact force of a clearance bearing.
//!
//! A [`Model`] is an image of two small networks, read in place: the collision network (state of the contact to normal
//! force) and the friction network (normal force and sliding speed to friction). A [`Pair`] runs both, one sample a
//! step, keeping only the few columns that each layer looks at. Activations are 16 bits wide, weights 8 bits,
//! accumulators 32 bits; the result equals the evaluation of the whole window at every position, bit for bit, on the
//! host and on the controller.
//!
//! ```
//! use inference::{Bearing, ContactState, Model, Pair, shipped};
//! let model = Model::load(shipped(Bearing::Babbitt))?;
//! let mut pair = Pair::new(model);
//! let state = ContactState { radial_clearance_m: 0.5e-3, deformation_m: 3e-5, ..ContactState::default() };
//! let estimate = pair.step(&state);
//! assert!(estimate.normal_force_n > 0.0);
//! # Ok::<(), inference::ImageError>(())
//! ```
//!
//! No heap, no unsafe code, no panics, no I/O, no time. Not a safety function: outside the training range the
//! estimate is flagged ([`Flags::OUTSIDE_TRAINING`]), not made right.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

mod bearing;
pub mod encode;
mod error;
pub mod features;
mod flags;
mod header;
mod layer;
pub mod layout;
mod model;
mod network;
mod pair;
mod read;
pub mod reference;
mod state;

pub use bearing::{Bearing, shipped};
pub use error::{ImageError, LayerName};
pub use flags::Flags;
pub use header::{Header, Range};
pub use layer::{Convolution, Head};
pub use model::Model;
pub use network::{Network, Stream};
pub use pair::Pair;
pub use state::{ContactState, Estimate};
