//! Benches that are independent of the engine: the source of "measured" logs for the tests of the
//! diagnosis.
//!
//! [`axis`] is the friction rig and the linear axis; [`planar`] is the transmission bench, whose
//! shaft may tilt (`tilt`). Both are written from their equations, with other integrators and steps
//! than the engine's. [`plant`] lists them, [`record`] adds an operating point and nuisance
//! parameters, [`conditions`] the conditions of the log, [`sensing`] the sensors. [`hidden`] is an
//! effect, `axis_effects` and `planar_effects` draw it and add its terms, [`vocabulary`] lists all,
//! and [`size`] measures its size. Nothing here uses the crates `bench` or `diagnosis`.

pub mod axis;
mod axis_data;
mod axis_effects;
pub mod conditions;
mod drawn;
pub mod hidden;
pub mod motion;
pub mod noise;
pub mod planar;
mod planar_data;
mod planar_effects;
mod planar_plant;
pub mod plant;
pub mod record;
pub mod sensing;
pub mod size;
mod tilt;
pub mod vocabulary;

pub use planar_data::{Hidden, RealBench};
