//! A connected controller as a device: its identity and state, live values, and updates of its
//! models.

pub(crate) mod describe;
pub(crate) mod follow;
pub(crate) mod info;
pub mod update;
