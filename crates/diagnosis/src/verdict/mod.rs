//! Accepts or rejects the selected causes, and reports their probabilities, the structure that
//! remains, and the parameters that the logs cannot determine.

pub(crate) mod acceptance;
pub(crate) mod causes;
pub(crate) mod effect_name;
pub(crate) mod estimates;
pub(crate) mod explanation;
pub(crate) mod identifiability;
pub(crate) mod materiality;
pub(crate) mod noise_summary;
pub(crate) mod nuisance_bounds;
pub(crate) mod parts;
pub(crate) mod probability;
pub(crate) mod ranking;
pub(crate) mod remaining_structure;
pub(crate) mod residual_bins;
pub(crate) mod second_pass;
pub(crate) mod series;
pub(crate) mod signature;
pub(crate) mod size_consistency;
pub(crate) mod tolerance;
pub(crate) mod tuning;
pub(crate) mod verdict_kind;
