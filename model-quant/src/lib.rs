//! Data sets, training, quantisation and verification of the contact networks.
//!
//! The chain: [`rows`] draws states and their forces, [`window`] gives each a history, [`train`] fits a network,
//! [`checkpoint`] keeps it, [`quantise`] turns it into the image that [`inference`] runs, [`verify`], [`layers`] and [`peers`]
//! say how far that is from the laws, the float networks and other runtimes. Every draw comes from a
//! seed, every result is the same bytes on any number of threads and on any machine with IEEE 754 arithmetic.
//!
//! The checked-in models come from
//!
//! ```text
//! model-quant train --bearing babbitt --out model-quant/models      # and plastic; five to eight minutes each on two cores
//! model-quant quantize --out crates/inference/models
//! ```
//!
//! and are checked by the tests (quantisation and accuracy, in seconds) and by `model-quant train --check` (training, in
//! minutes).
//!
//! # What the networks learn
//!
//! The collision network gives `y = sqrt(F_n)/(d/d_max)`, so `F_n = (y d/d_max)^2`: companded as a root, because the
//! force spans four decades, and relative to the deformation, so that the relative error is even and a light contact gets
//! no spurious stiffness. The power of `d` stands in the image's header in halves: 2 suits the hybrid law as printed,
//! which grows as `d^2` at first; a law that grows as `d^1.5` (Hertz, Liu) would take 1. Without contact the force is
//! exactly 0. The friction network gives the coefficient of friction from the root of the force and features of `|v|`:
//! `F_f = -sign(v) mu F_n`, an odd function of the speed by construction.

pub mod bench_loop;
pub mod card;
pub mod checkpoint;
pub mod claims;
pub mod csv;
pub mod dataset;
pub mod draw;
pub mod errors;
pub mod exchange;
pub mod features;
pub mod float_pair;
pub mod goals;
pub mod held_out;
pub mod history;
pub mod image;
pub mod key;
pub mod law;
pub mod layers;
pub mod limits;
pub mod mode;
pub mod network;
pub mod package;
pub mod parameters;
pub mod peers;
pub mod pipeline;
pub mod quantise;
pub mod ranges;
pub mod recipe;
pub mod rig;
pub mod round;
pub mod rows;
pub mod shapes;
pub mod sources;
pub mod train;
pub mod training_report;
pub mod verify;
pub mod window;
pub mod write;
