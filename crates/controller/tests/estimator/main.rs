//! The estimator from outside: accuracy, flags, any samples.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod accuracy;
mod anything;
mod flags;
mod impacts;
mod run;
mod ticks;
