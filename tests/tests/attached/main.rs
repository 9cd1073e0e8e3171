//! The firmware's image behind its serial port, as a board would be: USART6 of the emulator on a pseudo-terminal. The host gets what the native
//! controller gives, to the bit; what goes wrong has a name and an end; the log in the image's memory reads as text.
//!
//! Needs qemu-system-arm and the image (`cargo xtask firmware`).
#![cfg(all(feature = "emulated", target_os = "linux"))]
#![expect(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail the test")]

mod agreement;
mod board;
mod log;
mod troubles;
