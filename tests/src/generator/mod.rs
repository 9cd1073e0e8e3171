//! Benches that are not the engine's: the source of "measured" logs for the tests of the diagnosis.
//!
//! [`axis`] is the friction rig and the linear axis, [`planar`] the transmission bench, whose shaft may tilt (`tilt`), both written from their equations alone, with
//! other integrators and steps than the engine's; [`session`] puts one to an operating point with nuisances of its own,
//! [`conditions`] are those under which it is logged,
//! [`sensing`] makes readings of it, [`hidden`] says what a log hides and [`vocabulary`] draws it, [`size`] measures how large that is.
//! Nothing here uses the `bench` or `diagnosis` crate.

pub mod axis;
pub mod bench_vocabulary;
pub mod conditions;
pub mod hidden;
pub mod motion;
pub mod noise;
pub mod planar;
mod planar_added;
mod planar_plant;
pub mod sensing;
pub mod session;
pub mod size;
mod tilt;
pub mod vocabulary;

pub use planar::{Hidden, RealBench};
