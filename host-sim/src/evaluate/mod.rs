//! Text and report page of an evaluation.

pub(crate) mod report;
pub(crate) mod text;
