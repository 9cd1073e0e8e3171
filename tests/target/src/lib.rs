//! What the binaries run on a controller and the tests on the host: the same code, generic over the engine.
//!
//! [`agreement`] digests the outputs of layers of many shapes; [`network`] has the reference network that counts are published
//! for, and random parameters for both.
#![no_std]

pub mod agreement;
pub mod network;
pub mod noise;
