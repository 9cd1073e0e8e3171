#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), no_std)]

pub mod activation;
pub mod chain;
mod convolution;
mod estimate;
pub mod features;
pub mod fixed;
mod flags;
mod head;
pub mod image;
pub mod kernel;
pub mod model;
mod padding;
mod pair;
mod ring;
mod sample;
mod scale;
mod shipped;
pub mod storage;
mod streaming;
mod weights;
mod windowed;
pub mod word_sum;

pub use contact::BearingMaterial;
pub use convolution::Convolution;
pub use estimate::Estimate;
pub use flags::Flags;
pub use head::Head;
pub use image::{Header, ImageError, Range};
pub use model::{Model, Network, WINDOW};
pub use padding::{Causal, Pad, Padding, Same, Valid};
pub use pair::Pair;
pub use sample::{ContactState, Sample};
pub use scale::Scale;
pub use shipped::shipped;
pub use streaming::Streaming;
pub use weights::{LayerInput, PackedWeights, Stored, Weights16, WeightsOf};
pub use windowed::Windowed;
