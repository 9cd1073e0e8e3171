//! The firmware image on a serial port, like a board: USART6 of the emulator on a pseudo-terminal.
//! The host gets the bits of the native controller, failures have named errors and timeouts, and
//! the log in memory reads as text.
//!
//! Needs qemu-system-arm and the image (`cargo xtask firmware`).
#![cfg(all(feature = "emulated", target_os = "linux"))]
#![expect(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail the test")]

mod agreement;
mod board;
mod log;
mod troubles;
