//! The firmware's image in the emulator: it agrees with the host to the bit, repeats itself, and its failures have names and bounds.
//!
//! Needs qemu-system-arm and the image (`cargo xtask firmware`).
#![cfg(feature = "emulated")]
#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod agreement;
mod failures;
mod frames;
mod image;
