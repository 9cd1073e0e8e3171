//! Data sets, training, quantisation and verification of the contact networks.
//!
//! The chain: [`rows`] draws states and their forces, [`window`] gives each a history, [`train`] fits a network,
//! [`checkpoint`] keeps it, [`quantise`] turns it into the image that [`inference`] runs. Every draw comes from a
//! seed, every result is the same bytes on any number of threads and on any machine with IEEE 754 arithmetic.

pub mod card;
pub mod checkpoint;
pub mod csv;
pub mod draw;
pub mod float_pair;
pub mod law;
pub mod net;
pub mod pipeline;
pub mod quantise;
pub mod ranges;
pub mod recipe;
pub mod round;
pub mod rows;
pub mod train;
pub mod verify;
pub mod window;
pub mod write;
