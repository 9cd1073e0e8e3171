//! Campaign over the parameters that the paper does not state: in which share of a parameter box
//! does each claim hold, and which parameter decides?
//!
//! * [`parameter_box`]: the box and its draws.
//! * [`verdicts`]: the verdicts of a draw, from rest and settled.
//! * [`work`]: all draws on all cores, with a journal.
//! * [`shares`]: shares, their intervals and the effect of each parameter.
//! * [`table`]: one row a claim.
//! * `pictures`, `report`: maps, page, files.

pub mod parameter_box;
mod pictures;
pub(crate) mod report;
pub mod shares;
pub mod table;
pub mod verdicts;
pub mod work;
