//! Signed packages of model images: what a controller takes as an update.
//!
//! | bytes | what |
//! |---|---|
//! | 0..96 | [`Manifest`] |
//! | 96..160 | ed25519 signature over the manifest ([`signature`]) |
//! | from 160 | payload: images by bearing code, then self-tests by bearing code ([`self_test`]) |
//!
//! The manifest holds the payload's hash, so that the signature covers everything and can still be checked before the payload has come. An
//! image is what [`inference::Model::load`] takes; every part's length is divisible by 4, so that a payload at an address divisible
//! by 4 can be run where it lies.
//!
//! Shared by the tool that makes packages and the controller that checks them. No heap, no I/O, no time, no panics, no unsafe code.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

mod check;
mod manifest;
pub mod self_test;
pub mod signature;

pub use check::{Checked, WRONG_BEARING, authentic, check};
pub use manifest::{FORMAT, LEAST_SAMPLES, MAGIC, Manifest, board, hash_of};
