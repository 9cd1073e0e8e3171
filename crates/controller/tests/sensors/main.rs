//! The drivers against scripted buses and models of the hardware: what goes over the wire, and what
//! is made of every answer.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod absolute;
mod converter;
mod incremental;
mod sampler;
mod script;
mod sequence;
