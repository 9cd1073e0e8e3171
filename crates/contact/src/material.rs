//! Elastic properties of the two bodies in contact.

use crate::error::{LawError, above_zero, expect};
use crate::real::Real;

/// Isotropic elastic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material<T = f64> {
    /// Young's modulus in Pa.
    pub youngs_modulus_pa: T,
    /// Poisson's ratio, 0 to 0.5.
    pub poisson_ratio: T,
}

impl Material {
    /// Steel of the shaft (206 GPa, 0.3). The paper names no shaft material: an assumption of this
    /// project.
    pub const STEEL: Self = Self { youngs_modulus_pa: 206e9, poisson_ratio: 0.3 };
}

impl<T: Real> Material<T> {
    /// Creates a material with a modulus above 0 and a Poisson's ratio from 0 to 0.5.
    pub fn new(youngs_modulus_pa: T, poisson_ratio: T) -> Result<Self, LawError> {
        let material = Self { youngs_modulus_pa, poisson_ratio };
        material.check()?;
        Ok(material)
    }

    pub(crate) fn check(&self) -> Result<(), LawError> {
        above_zero("Young's modulus (Pa)", self.youngs_modulus_pa)?;
        let nu = self.poisson_ratio;
        expect("Poisson's ratio", nu, nu >= T::ZERO && nu <= T::from_f64(0.5), "0 to 0.5")?;
        Ok(())
    }

    /// Plane-strain compliance `h = (1 - nu^2)/E` in 1/Pa.
    pub(crate) fn compliance_per_pa(&self) -> T {
        (T::ONE - self.poisson_ratio * self.poisson_ratio) / self.youngs_modulus_pa
    }
}

/// Effective modulus `E*` of a pair in Pa: `1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2`.
pub fn effective_modulus_pa<T: Real>(a: &Material<T>, b: &Material<T>) -> T {
    T::ONE / (a.compliance_per_pa() + b.compliance_per_pa())
}
