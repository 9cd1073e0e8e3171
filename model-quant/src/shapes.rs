//! Sizes of the two networks, for arrays of their weights.

use inference::features::{COLLISION_INPUTS, FRICTION_INPUTS};
use inference::model::{CHANNELS, HEAD_COLUMNS, KERNEL};

/// Taps of an output of the collision network's first convolution.
pub const COLLISION_TAPS: usize = KERNEL * COLLISION_INPUTS;
/// Taps of an output of the friction network's first convolution.
pub const FRICTION_TAPS: usize = KERNEL * FRICTION_INPUTS;
/// Taps of an output of the second and third convolutions.
pub const HIDDEN_TAPS: usize = KERNEL * CHANNELS;
/// Weights of a head.
pub const HEAD_WEIGHTS: usize = HEAD_COLUMNS * CHANNELS;

/// Multiply-accumulates of one streaming step of a network whose first convolution has so many taps.
pub const fn macs_per_step(first_taps: usize) -> usize {
    CHANNELS * (first_taps + 2 * HIDDEN_TAPS) + HEAD_WEIGHTS
}
