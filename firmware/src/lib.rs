//! The controller: sensor samples in, contact forces out.
//!
//! [`Estimator`] is the work of one tick: conditioning, onset latch, the two networks, force components. [`Session`] is the
//! conversation with the host around it. Both are free of I/O, heap and panics, run in the host's process as they run on the
//! controller, and give the same bits there: only `+ - * /` and `sqrt` in f32, integers everywhere else, and
//! [`libm::atan2f`], which is plain arithmetic too.
//!
//! `boards` (built for the controller's target only) is the one place that touches registers; [`clock`] holds its
//! start-up decisions apart from the registers, so that they are tested on the host.
//!
//! Not a safety function: an estimate that cannot be trusted is flagged ([`flags`]), not made right.
#![cfg_attr(not(test), no_std)]
#![deny(unsafe_code)]
#![warn(clippy::indexing_slicing)]

pub mod boards;
pub mod clock;
pub mod configuration;
mod constants;
pub mod estimator;
pub mod flags;
pub mod monitor;
pub mod sensors;
pub mod session;
pub mod store;
pub mod supervisor;
pub mod tracking;

pub use estimator::Estimator;
pub use monitor::Monitor;
pub use session::{Identity, NoTicks, Session, TickSource};
