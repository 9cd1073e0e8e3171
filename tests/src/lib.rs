//! What the system tests share.

pub mod faults;
pub mod generator;
pub mod hidden_effects;
pub mod journal;
pub mod soak;
