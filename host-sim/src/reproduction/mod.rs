//! Reproduction of the paper: the runs of its Figs. 16-20 and the verdict on each of its claims.

pub mod campaign;
pub mod claims;
mod pictures;
pub(crate) mod report;
pub mod runs;
pub mod swing;
