//! Shapes of the two networks that the controller runs.

use crate::network::{ConvolutionShape, Padding, Shape};
use inference::WINDOW;
use inference::features::{COLLISION_INPUTS, FRICTION_INPUTS};
use inference::model::{CHANNELS, HEAD_COLUMNS, KERNEL};

/// Convolutions of either network.
pub const CONVOLUTIONS: usize = 3;
/// Layers of either network: the convolutions and the head.
pub const LAYERS: usize = CONVOLUTIONS + 1;
const _: () = assert!(WINDOW == HEAD_COLUMNS + CONVOLUTIONS * (KERNEL - 1));

fn causal(inputs: usize) -> Shape {
    Shape {
        columns: WINDOW,
        inputs,
        padding: Padding::Valid,
        convolutions: vec![ConvolutionShape { kernel: KERNEL, outputs: CHANNELS }; CONVOLUTIONS],
        outputs: 1,
    }
}

/// The collision network.
pub fn collision() -> Shape {
    causal(COLLISION_INPUTS)
}

/// The friction network.
pub fn friction() -> Shape {
    causal(FRICTION_INPUTS)
}
