//! Statistics of samples and histories: numerics that know no bench.

mod band;
mod bootstrap;
mod extreme;
mod rainflow;
mod samples;
mod transient;

pub(crate) use band::Band;
pub use bootstrap::Estimate;
pub(crate) use bootstrap::{estimate, estimate_tail};
pub(crate) use extreme::largest_in;
pub(crate) use rainflow::{RangeCycle, count as count_ranges, sums_per_cycle};
pub(crate) use samples::quantile;
pub use samples::{mean, median, rms};
pub(crate) use transient::transient_length;
