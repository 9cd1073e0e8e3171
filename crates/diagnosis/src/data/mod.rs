//! Logs prepared for comparison: cycles, held-out samples, noise, and quantities that a residual
//! may depend on.

pub(crate) mod cycles;
pub(crate) mod features;
pub(crate) mod logs;
pub(crate) mod measures;
pub(crate) mod noise;
pub(crate) mod repeatability;
pub(crate) mod split;
pub(crate) mod tuning;
pub(crate) mod views;
