//! Log and link of an attached controller through a debug probe.
//!
//! Needs qemu-system-arm and the image (`cargo xtask firmware`). No flash is written.
#![cfg(all(feature = "fake-probe", target_os = "linux"))]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

mod emulated;
mod log;
mod memory;
mod rings;
mod software;
#[path = "../twin/trial.rs"]
mod trial;
#[path = "../twin/mod.rs"]
mod twin;
