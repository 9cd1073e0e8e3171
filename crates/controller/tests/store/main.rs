//! The kept models and the kept configuration, on a flash memory whose power fails at every step.
#![expect(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail the test")]

mod attacks;
mod configuration;
mod flash;
mod line;
mod package;
mod power;
mod refusals;
mod session;
