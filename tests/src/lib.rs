//! Library of the system tests: campaigns, and the generators of logs and faults.

pub mod faults;
pub mod generator;
pub mod hidden_effects;
pub mod journal;
pub mod random;
pub mod soak;

/// Compiles and runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
