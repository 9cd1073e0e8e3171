//! The firmware's image in the emulator: it agrees with the host to the bit, repeats itself, and its failures have names and bounds.
//!
//! Needs qemu-system-arm and the image (`cargo xtask firmware`).
#![cfg(feature = "emulated")]

mod agreement;
mod failures;
mod frames;
mod image;
