//! Facts about this image: its build and its board.

use controller::boards::{Board, find};

use super::rtt::PINTLE_BUILD_ID;

/// Name of this build: `git describe`, or the crate's version.
///
/// The compiler must not know the name: it would compute the name's checksum and unroll its copy,
/// and the size of the image would depend on the name.
pub(super) fn build_id() -> link::BuildId {
    link::BuildId(*core::hint::black_box(&PINTLE_BUILD_ID))
}

/// Row of the table for the board of this image. `build.rs` checks the name and sets it.
pub static BOARD: &Board = match find(env!("PINTLE_BOARD")) {
    Some(board) => board,
    None => panic!("PINTLE_BOARD names no board of the table"),
};
