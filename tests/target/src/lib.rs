//! Test code that runs unchanged on a controller and on the host, generic over the engine.
//!
//! [`agreement`] digests the outputs of layers of many shapes, [`filter`] those of the Kalman
//! filter, [`ticks`] those of whole ticks. [`network`] contains the reference network of the
//! published instruction counts, and random parameters for both.
#![no_std]

pub mod agreement;
#[cfg(feature = "filter")]
pub mod filter;
pub mod network;
pub mod noise;
#[cfg(feature = "filter")]
pub mod ticks;

/// Compiles and runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
