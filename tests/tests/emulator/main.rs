//! The firmware image in the emulator: it gives the host's bits, it repeats exactly, and its
//! failures have named errors and timeouts.
//!
//! Needs qemu-system-arm and the image (`cargo xtask firmware`).
#![cfg(feature = "emulated")]
#![expect(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail the test")]

mod agreement;
mod batch;
mod board;
mod campaign;
mod failures;
mod faults;
mod flood;
mod frames;
mod image;
mod other_core;
mod own_sensors;
mod serial_flood;
mod ticks;
mod update;
