//! Reports: training report, verdicts on the paper's claims about friction and training, model
//! cards.

pub mod card;
pub mod claims;
pub(crate) mod training;
