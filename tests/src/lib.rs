//! What the system tests share.

pub mod generator;
pub mod generator_noise;
