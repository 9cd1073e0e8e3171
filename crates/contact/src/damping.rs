//! Rate ratio `q` that a dissipation factor multiplies: `F = F_el(d) (1 + chi q)`, with three
//! definitions of `q`.
//!
//! The factors are derived for one free impact. There `q = d'/d'0` with the approach speed `d'0`
//! latched at the onset, and `-e <= q <= 1` throughout. A joint that stays in contact has no
//! meaningful approach speed. Therefore:
//!
//! * [`Damping::Latched`], `q = d'/max(d'0, floor)`: as printed. The force depends on how the
//!   contact began and jumps where the latch is renewed. `q` has no bound: at a floor of 1 mm/s a
//!   rate of 5 mm/s multiplies the elastic force by `1 + 5 chi`.
//! * [`Damping::Bounded`], the same `q` clamped to -1..1. In a free impact above the floor nothing
//!   changes, because `q` stays in that range. Outside it the force stays within `(1 - chi) F_el`
//!   and `(1 + chi) F_el`.
//! * [`Damping::Reference`], `q = d'/v_r` with a constant speed `v_r`: a function of the state
//!   alone, without latch, floor or jump. This is the form in which Hunt and Crossley wrote their
//!   law, `F = K d^n (1 + a d')` with `a = chi/v_r` a constant of the material pair (their `a = 3
//!   alpha/2`, from `e = 1 - alpha v`; recalled, as the text was not at hand). Multibody codes such
//!   as Drake call that constant the Hunt and Crossley dissipation, in s/m. At an approach speed
//!   `v` the law equals a latched law with the factor `chi v/v_r`. It produces the restitution of
//!   `chi` at `v = v_r` and `produced_restitution(chi v/v_r)` at any other speed, nearer to 1 the
//!   slower the impact, as measured on metals. Every cycle in contact dissipates `F_el a d'^2` per
//!   time, which is never negative.

use crate::error::{LawError, above_zero};
use crate::real::Real;

/// Default floor of the latched approach speed, 1 mm/s.
///
/// `d'0 = 0` divides by zero, so there must be a smallest approach speed. Below it the law is no
/// longer scaled by its own onset and becomes `1 + (chi/floor) d'`, a damping per rate that is the
/// same for every slow contact. In sustained contact, as on the transmission bench after its start,
/// the complete run is damped by `chi/floor`. Between 1 and 200 mm/s the floor changes the bench's
/// peak force by -19 to +37 %, and at 1 mm/s an error of 0.1 mm/s in the rate is 21 % of Babbitt's
/// force. It is therefore a parameter of the joint, to be fitted or stated, not a guard.
pub const DEFAULT_LATCH_FLOOR_M_S: f64 = 1e-3;

/// Reference speed for the rate of deformation. Speeds in m/s, above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Damping<T = f64> {
    /// The latched approach speed, at least the floor.
    Latched {
        /// Floor of the approach speed.
        floor_m_s: T,
    },
    /// The same, with the ratio clamped to -1..1.
    Bounded {
        /// Floor of the approach speed.
        floor_m_s: T,
    },
    /// A constant speed, at which the nominal restitution is produced.
    Reference {
        /// The speed.
        speed_m_s: T,
    },
}

impl<T: Real> Damping<T> {
    /// Names in descriptions, in the order of the variants.
    pub const NAMES: [&'static str; 3] = ["latched", "bounded", "reference"];

    /// Returns the damping of a name, with its floor or reference speed in m/s.
    pub fn from_name(name: &str, speed_m_s: T) -> Result<Self, LawError> {
        let damping = match name {
            "latched" => Self::Latched { floor_m_s: speed_m_s },
            "bounded" => Self::Bounded { floor_m_s: speed_m_s },
            "reference" => Self::Reference { speed_m_s },
            _ => return Err(LawError::UnknownName { group: "damping" }),
        };
        damping.check()?;
        Ok(damping)
    }

    pub(crate) fn check(&self) -> Result<(), LawError> {
        let (quantity, speed) = match *self {
            Self::Latched { floor_m_s } | Self::Bounded { floor_m_s } => ("latch floor (m/s)", floor_m_s),
            Self::Reference { speed_m_s } => ("reference speed (m/s)", speed_m_s),
        };
        above_zero(quantity, speed)?;
        Ok(())
    }

    /// Returns the ratio `q` at a rate of deformation and a latched approach speed, in m/s.
    pub fn rate_ratio(&self, rate_m_s: T, latched_rate_m_s: T) -> T {
        match *self {
            Self::Latched { floor_m_s } => rate_m_s / latched_rate_m_s.max(floor_m_s),
            Self::Bounded { floor_m_s } => {
                (rate_m_s / latched_rate_m_s.max(floor_m_s)).max(-T::ONE).min(T::ONE)
            }
            Self::Reference { speed_m_s } => rate_m_s / speed_m_s,
        }
    }
}
