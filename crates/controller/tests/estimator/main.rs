//! The estimator from outside: sensor frames of known orbits in, forces held against the laws of
//! `contact`.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod accuracy;
mod anything;
mod cycle;
mod flags;
mod orbit;
