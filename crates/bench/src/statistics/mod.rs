//! Statistics of histories: numerics that know no bench.

mod band;
mod bootstrap;
mod extreme;
mod rainflow;
mod transient;

pub(crate) use band::Band;
pub use bootstrap::Estimate;
pub(crate) use bootstrap::{estimate, mean, quantile};
pub(crate) use extreme::largest_in;
pub(crate) use rainflow::{RangeCycle, count as count_ranges};
pub(crate) use transient::transient_length;
