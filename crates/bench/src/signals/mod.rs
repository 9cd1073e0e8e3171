//! Signals over time: channels of a log, motions that drive a plant, sensors, and white noise.

mod axis_motion;
mod channel;
mod motion;
mod profile;
mod schedule;
mod sensor;
mod spectrum;
pub(crate) mod spline;
mod standstill;
pub mod white_noise;

pub(crate) use axis_motion::{follow, smoothed};
pub use channel::{Channel, Role};
pub use motion::Motion;
pub use profile::Profile;
pub(crate) use profile::sweep_s;
pub use schedule::{Course, Schedule};
pub use sensor::Sensor;
pub(crate) use spectrum::SeaState;
