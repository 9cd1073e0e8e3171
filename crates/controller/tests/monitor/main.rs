//! The monitor from outside: runs of the bench in, what it tracks, flags and holds out.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod anything;
mod faults;
mod run;
mod tracking;
