//! Functional mock-up units: export, and units of other programs as the plant of a run.

pub(crate) mod export;
mod libraries;
mod plant;
pub(crate) mod plant_unit;
