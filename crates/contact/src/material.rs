//! Elastic properties of the two bodies in contact.

/// Isotropic elastic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Young's modulus in Pa.
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio, 0 to 0.5.
    pub poisson_ratio: f64,
}

impl Material {
    /// The steel of the shaft (206 GPa, 0.3). The paper names no shaft material: an assumption of this project.
    pub const STEEL: Self = Self { youngs_modulus_pa: 206e9, poisson_ratio: 0.3 };
    /// Babbitt alloy of the bearing, Table 2 of the paper.
    pub const BABBITT: Self = Self { youngs_modulus_pa: 50e9, poisson_ratio: 0.3 };
    /// Engineering plastic alloy of the bearing, Table 2 of the paper.
    pub const PLASTIC: Self = Self { youngs_modulus_pa: 2.5e9, poisson_ratio: 0.4 };

    /// Plane-strain compliance `h = (1 - nu^2)/E` in 1/Pa.
    pub fn compliance_per_pa(&self) -> f64 {
        (1.0 - self.poisson_ratio * self.poisson_ratio) / self.youngs_modulus_pa
    }
}

/// Effective modulus `E*` of a pair in Pa: `1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2`.
pub fn effective_modulus_pa(a: &Material, b: &Material) -> f64 {
    1.0 / (a.compliance_per_pa() + b.compliance_per_pa())
}
