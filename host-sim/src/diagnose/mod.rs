//! Text and report page of a diagnosis.

mod pictures;
pub(crate) mod report;
mod sentences;
pub(crate) mod tables;
pub(crate) mod text;
