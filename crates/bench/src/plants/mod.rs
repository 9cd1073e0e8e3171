//! Equations of each plant: motion, contact, friction and energy.

pub(crate) mod contact_laws;
pub mod energy;
pub(crate) mod forward_axis;
pub mod friction_rig;
pub mod mechanism;
pub mod slider_crank;
pub(crate) mod stick_slip;
pub mod transmission;
pub mod two_plane;
