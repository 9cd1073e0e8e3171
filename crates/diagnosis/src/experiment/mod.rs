//! Proposes the next experiment when several effects fit equally well.

pub(crate) mod menu;
pub(crate) mod proposal;
pub(crate) mod tuning;
