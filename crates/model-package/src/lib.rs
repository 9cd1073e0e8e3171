#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

mod check;
mod manifest;
pub mod self_test;
pub mod signature;

pub use check::{Checked, WRONG_BEARING, authenticate, check};
pub use manifest::{MAX_VERSION, MAX_VERSION_STEP, MIN_SAMPLES, Manifest, board, hash_of};
