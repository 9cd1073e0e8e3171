//! What the system tests share.

pub mod faults;
pub mod generator;
pub mod soak;
pub mod hidden_effects;
