//! The boards that the controller runs on: the one place that touches registers.
//!
//! Empty unless built for a controller's target: what a host can test is in the `controller` crate.
#![cfg(target_os = "none")]
#![no_std]
#![deny(unsafe_code)]
#![warn(clippy::indexing_slicing)]

pub mod boards;
