//! The two networks that the controller runs for each bearing: kinds and shapes.
//!
//! Both have the shape of [`inference::model::Network`]; only the number of inputs differs.

use super::{ConvolutionShape, Padding, Shape};
use inference::WINDOW;
use inference::features::{COLLISION_INPUTS, FRICTION_INPUTS};
use inference::model::{CHANNELS, CONVOLUTIONS, KERNEL};

/// Number of layers of each network: the convolutions and the head.
pub(crate) const LAYERS: usize = CONVOLUTIONS + 1;

/// One of the two networks of a bearing. The numbers select the random streams of its training and
/// of its windows for other runtimes. They must not change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NetworkKind {
    /// Network from the state of the contact to the normal force.
    Collision = 0,
    /// Network from normal force and sliding speed to the coefficient of friction.
    Friction = 1,
}

impl NetworkKind {
    /// Both kinds, in the order of a checkpoint.
    pub const ALL: [Self; 2] = [Self::Collision, Self::Friction];

    /// Lower-case name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Collision => "collision",
            Self::Friction => "friction",
        }
    }

    /// Shape of the networks of this kind.
    pub fn shape(self) -> Shape {
        let inputs = match self {
            Self::Collision => COLLISION_INPUTS,
            Self::Friction => FRICTION_INPUTS,
        };
        Shape {
            columns: WINDOW,
            inputs,
            padding: Padding::Valid,
            convolutions: vec![ConvolutionShape { kernel: KERNEL, outputs: CHANNELS }; CONVOLUTIONS],
            outputs: 1,
        }
    }
}
