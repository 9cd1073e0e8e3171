//! Exchange of networks with other tools: ONNX and safetensors in and out.
//!
//! [`recognise`] finds a network of the family in an ONNX file, whichever framework wrote it; [`samples`] are the inputs and outputs
//! that it is checked with; [`quantised`] puts a network that stands alone into whole numbers, [`interpreter`] runs the result
//! with the arithmetic of the engine, [`source`] and [`card`] make it a piece of Rust that explains itself. [`onnx`] and
//! [`weights`] write what was trained here.

pub mod axes;
pub mod card;
mod chain;
pub mod constant;
pub mod description;
pub mod error;
pub mod export;
pub mod frameworks;
pub mod interpreter;
pub mod onnx;
mod padding;
pub mod proto;
pub mod quantised;
pub mod recognise;
pub mod samples;
pub mod scaling;
pub mod source;
pub mod weights;
