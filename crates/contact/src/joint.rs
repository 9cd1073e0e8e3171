//! Geometry and materials of a cylindrical clearance joint, from which the stiffness parts are
//! computed.

use crate::error::{LawError, above_zero, expect};
use crate::material::{Material, effective_modulus_pa};
use crate::real::Real;

/// A journal inside a bearing. Lengths in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint<T = f64> {
    /// Inner radius `R_B` of the bearing.
    pub bearing_radius_m: T,
    /// Radial clearance `D = R_B - R_J`.
    pub radial_clearance_m: T,
    /// Length `L` of the bearing.
    pub length_m: T,
    /// Material of the bearing.
    pub bearing: Material<T>,
    /// Material of the journal.
    pub journal: Material<T>,
}

impl<T: Real> Joint<T> {
    /// Checks radii, clearance, length and materials.
    pub fn check(&self) -> Result<(), LawError> {
        above_zero("bearing radius (m)", self.bearing_radius_m)?;
        let clearance = self.radial_clearance_m;
        let holds = clearance > T::ZERO && clearance < self.bearing_radius_m;
        expect("radial clearance (m)", clearance, holds, "above 0 and below the bearing's radius")?;
        above_zero("bearing length (m)", self.length_m)?;
        self.bearing.check()?;
        self.journal.check()
    }

    /// Radius `R_J` of the journal in m.
    pub fn journal_radius_m(&self) -> T {
        self.bearing_radius_m - self.radial_clearance_m
    }

    /// Effective modulus `E*` in Pa.
    pub fn effective_modulus_pa(&self) -> T {
        effective_modulus_pa(&self.bearing, &self.journal)
    }

    /// Radius of relative curvature `R = R_B R_J/D` in m.
    pub(crate) fn relative_radius_m(&self) -> T {
        self.bearing_radius_m * self.journal_radius_m() / self.radial_clearance_m
    }
}
