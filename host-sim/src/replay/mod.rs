//! Replays: a recorded link session on another controller, compared to the bit; or a measured log.

mod compare;
pub mod log;

pub use compare::{Difference, Replayed, replay};
