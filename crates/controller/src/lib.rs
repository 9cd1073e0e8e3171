//! The controller without its board: sensor samples in, contact forces out.
//!
//! A tick runs from the outside in: `service::SharedSession::tick`, [`Session`], [`Monitor`]
//! (faults, safe state), [`Estimator`] (plausibility, filter), the networks
//! (`inference::Pair`). [`Session`] also conducts the conversation with the host. Both are free of
//! I/O, heap and panics. They run in the host's process and on the controller and give the same
//! bits on both: integers, and f32 with `+ - * /` and routines written in Rust (libm, micromath).
//!
//! Only the firmware's boards access registers. [`clock`] separates their start-up decisions from
//! the registers, so that the host can test them.
//!
//! Not a safety function: an estimate that cannot be trusted is flagged ([`flags`]) and replaced by
//! the last trusted one; after the configured number of samples its forces are 0.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]
#![warn(clippy::indexing_slicing)]

pub mod boards;
pub mod buffers;
pub mod clock;
pub mod configuration;
pub mod emulator;
pub mod estimator;
// Its vectors and matrices have sizes that are types, and every index is a constant or the counter
// of a loop over such a size.
#[allow(clippy::indexing_slicing)]
pub mod filter;
pub mod flags;
pub mod impacts;
mod integrity;
pub mod monitor;
pub mod sensors;
pub mod service;
pub mod session;
pub mod store;
pub mod supervisor;

pub use estimator::Estimator;
pub use monitor::Monitor;
pub use session::{Identity, NoTicks, Session, TickSource};

/// Compiles the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
