//! Dry friction. Sliding speeds in m/s, forces in N along the sliding direction, so that friction
//! has the opposite sign.
//!
//! Laws without memory are functions of normal force and speed: [`FrictionLaw`], [`SlidingLaw`].
//! Those with memory have a state that the caller keeps, so that an integrator can step it and a
//! run can be repeated: [`Karnopp`], [`Dahl`], [`LuGre`], [`SevenParameter`]. All scale with the
//! normal force, which varies on a bench: stiffness and damping of the bristles are given per
//! newton of it.

mod dahl;
mod karnopp;
pub(crate) mod kind;
mod lugre;
mod seven_parameter;
mod sliding;
mod stribeck;

pub use dahl::Dahl;
pub use karnopp::{Karnopp, KarnoppState};
pub use kind::FrictionKind;
pub use lugre::LuGre;
pub use seven_parameter::{SevenParameter, SevenParameterState};
pub use sliding::{SlidingLaw, SlidingParameters};
pub use stribeck::{FrictionLaw, StribeckShape};
