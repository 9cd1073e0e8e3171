//! Exchange of networks: ONNX and safetensors in and out, signed packages for the controller.
//!
//! Import: [`onnx_import`] reads a supported network from an ONNX file of any framework, and
//! [`samples`] checks it with inputs and outputs of the framework. [`quantised`] converts it to
//! fixed point, [`interpreter`] evaluates the result with the arithmetic of the engine,
//! [`rust_source`] and [`card`] write it as Rust source and model card. Export: [`onnx_export`] and
//! [`safetensors_export`] write networks that were trained here, [`reference_samples`] their
//! outputs for test windows. [`c_package`] writes images for programs in C. [`package`] and [`key`]
//! make signed updates for a controller.

pub(crate) mod axes;
pub(crate) mod c_package;
pub(crate) mod card;
mod chain;
pub(crate) mod constants;
pub(crate) mod description;
pub(crate) mod error;
pub mod input_scale;
pub mod interpreter;
pub mod key;
pub(crate) mod layout;
pub mod onnx_export;
pub mod onnx_import;
pub mod package;
mod padding;
pub mod proto;
pub(crate) mod quantised;
pub(crate) mod reference_samples;
pub(crate) mod rust_source;
pub mod safetensors_export;
pub mod samples;
pub mod weight_order;
