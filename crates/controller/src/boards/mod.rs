//! The table of boards: every fact about a board that does not need a register.
//!
//! The firmware, its `build.rs`, `xtask` and `host-sim` all read this table. `build.rs` includes
//! this folder as source, so it uses `core` only and refers to nothing else in this crate.
//!
//! Adding a board with a microcontroller of the table takes one row in [`BOARDS`].

mod memory_map;
mod signals;
mod table;

pub use memory_map::{MemoryMap, Region};
pub use signals::{Port, Signal, Signals};
/// Baud rate of the link's serial port, on every board and on the host.
pub const LINK_BAUD: u32 = 500_000;

pub use table::{BOARDS, Board, ExternalClock, Light, Microcontroller, UnknownBoard, find, parse};

#[cfg(test)]
mod tests;
