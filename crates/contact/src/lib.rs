#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

mod bearing_material;
pub mod catalogue;
mod contact_law;
mod damping;
mod dissipation;
mod entry;
mod error;
mod friction;
mod joint;
mod logarithmic;
mod logarithmic_curve;
mod material;
mod normal;
mod real;
mod restitution;
mod spring_dashpot;
mod stiffness;
mod stiffness_kind;

pub use bearing_material::{BearingMaterial, Lining, LoadLimits, RigFriction};
pub use contact_law::{AdamsImpact, CompleteLawKind, CompleteLawParameters, ContactLaw};
pub use damping::{DEFAULT_LATCH_FLOOR_M_S, Damping};
pub use dissipation::{Dissipation, produced_restitution};
pub use error::LawError;
pub use friction::*;
pub use joint::Joint;
pub use logarithmic::{Logarithmic, LogarithmicKind};
pub use material::{Material, effective_modulus_pa};
pub use normal::{FactorisedLaw, NormalLaw};
pub use real::Real;
pub use spring_dashpot::{SpringDashpot, restitution_without_tension};
pub use stiffness::{Stiffness, hertz_sphere_in_sphere};
pub use stiffness_kind::{StiffnessKind, StiffnessParameters};

/// Gravity, m/s2: the value of the published test problems. Bench and controller use the same.
pub const GRAVITY_M_S2: f64 = 9.81;
