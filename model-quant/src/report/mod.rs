//! Reports: training report, pictures of the paper, verdicts on the paper's claims about friction
//! and training, model cards.

pub mod card;
pub mod claims;
pub mod paper;
pub(crate) mod torque;
pub(crate) mod training;
