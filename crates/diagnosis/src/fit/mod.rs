//! Least-squares fits of a bench description to logs: parameters, sensitivities, standard
//! deviations, held-out error.

pub(crate) mod held_out_gain;
pub(crate) mod held_out_nuisances;
pub(crate) mod least_squares;
pub(crate) mod linear;
pub(crate) mod model;
pub(crate) mod nuisance;
pub(crate) mod parameter;
pub(crate) mod sensitivities;
pub(crate) mod simulation;
pub(crate) mod standard_deviations;
pub(crate) mod trust_region;
pub(crate) mod tuning;
