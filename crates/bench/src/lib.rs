//! Plants of the test benches, their measured logs and the integrator.
//!
//! A [`description::Bench`] (TOML) says what a bench is; [`transmission`], [`friction_rig`] and [`slider_crank`] hold
//! the equations; [`run`] integrates a transmission bench; [`respond`] gives what a bench would have logged under a
//! measured log's own inputs, which is what a diagnosis compares; [`effects`] are what may be missing from a model.
#![forbid(unsafe_code)]

pub mod atomic;
pub mod channel;
mod contact_laws;
pub mod description;
mod description_io;
pub mod effects;
pub mod energy;
mod extended_friction;
pub mod falling_ball;
mod follow;
pub mod friction_rig;
pub mod impact_log;
pub mod integrate;
pub mod known_answers;
pub mod law_names;
pub mod limits;
pub mod log;
pub mod log_format;
pub mod motion;
pub mod multibody;
pub mod peaks;
pub mod record;
pub mod respond;
mod rest;
pub mod rig_groups;
pub mod run;
pub mod sensor;
pub mod slider_crank;
pub mod slider_crank_description;
pub mod transmission;
pub mod two_plane;
pub mod white_noise;

pub use channel::{Channel, Role};
pub use description::{BearingMaterial, Bench, DescriptionError, integrates_friction};
pub use description_io::PRESETS;
pub use log::MeasuredLog;
