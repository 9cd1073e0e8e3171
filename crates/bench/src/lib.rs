//! Plants of the test benches, their measured logs and the integrator.
//!
//! * [`schema`]: fields of a description as data.
//! * [`signals`]: channels, motions over time, sensors, white noise.
//! * [`log`]: measured logs in eight formats (`docs/logs.md`).
//! * [`description`]: the data of a bench description, [`Bench`], and the facts of its plants.
//! * [`effects`]: deviations from the nominal model, by name.
//! * [`integrate`]: error-controlled integration with located contacts.
//! * [`plants`]: equations of motion, friction and energy of each plant.
//! * [`reading`]: presets, parsing and checking of a description.
//! * [`simulate`]: runs, records and responses of a bench, and the statistics of settled operation.
//! * [`statistics`]: samples, estimates over cycles, rainflow, bands, transients.
//! * [`template`]: a description as a template for a log.
//! * [`life`]: wear, thermal change and film of a bearing over many cycles.
//! * [`known_answers`]: the plants against published references.
#![forbid(unsafe_code)]

pub mod atomic;
pub mod description;
pub mod effects;
pub mod integrate;
pub mod known_answers;
pub mod life;
pub mod log;
pub mod plants;
pub mod reading;
pub mod schema;
pub mod signals;
pub mod simulate;
pub mod statistics;
pub mod template;

pub use contact::BearingMaterial;
pub use description::{Bench, DescriptionError};
pub use log::MeasuredLog;
pub use reading::{PRESETS, sticking_plants};
pub use signals::{Channel, Role};

/// Compiles and runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
