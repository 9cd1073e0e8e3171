#![doc = include_str!("../README.md")]

mod draw;
mod equations;
pub mod random;
mod row;
mod run;
mod sensors;
mod world;

pub use draw::{Deviations, Parameter};
pub use row::Row;
pub use sensors::{Reading, Sensors};
pub use world::{Bearing, Friction, World};
