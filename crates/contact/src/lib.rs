//! Contact and friction laws of a dry cylindrical clearance joint: pure functions of the state.
//!
//! A normal law is a [`Stiffness`] (elastic force over deformation) times a [`Dissipation`] factor:
//! `F = F_el(d) (1 + chi(e) d'/d'0)`, clamped at zero, because a dry surface cannot pull. A friction law
//! gives a coefficient over the sliding speed. SI units throughout; nothing here allocates, keeps state or does I/O.
//!
//! What this does not model: lubrication, wear during a run, adhesion, pre-sliding displacement.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

mod dissipation;
mod friction;
mod material;
mod normal;
mod stiffness;

pub use dissipation::{Dissipation, produced_restitution};
pub use friction::{FrictionLaw, StribeckShape};
pub use material::{Material, effective_modulus_pa};
pub use normal::{DEFAULT_LATCH_FLOOR_M_S, NormalLaw};
pub use stiffness::{Stiffness, hertz_sphere_in_sphere};
