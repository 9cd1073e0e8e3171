#![doc = include_str!("../README.md")]

mod draw;
mod equations;
pub mod random;
mod run;
mod sensors;
mod world;

pub use draw::{Deviations, Parameter};
pub use run::Row;
pub use sensors::{Reading, Sensors};
pub use world::{Bearing, Friction, World};
