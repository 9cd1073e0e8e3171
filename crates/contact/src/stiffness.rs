//! Elastic force over deformation: the stiffness part of a normal law.

use crate::material::Material;
use core::f64::consts::PI;
use libm::sqrt;

/// Elastic part of a normal law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stiffness {
    /// `F = K d^1.5` with a constant `K` in N/m^1.5 (Hertz, sphere in sphere; see [`hertz_sphere_in_sphere`]).
    Hertz {
        /// `K` in N/m^1.5.
        coefficient: f64,
    },
    /// The hybrid law of Bai and Zhao as the paper prints it: `F = K_n d^1.5`,
    /// `K_n = (1/8) pi E* sqrt(2 d (3D + 2d)^2/(D + d)^3)`.
    ///
    /// `K_n` is the derivative over `d` of [`Stiffness::LiuTimesLength`] per unit of length, so this product has the
    /// wrong unit (no bearing length enters). Kept under its own name to reproduce the paper; for a consistent law
    /// take Liu's.
    HybridAsPrinted {
        /// `E*` in Pa.
        effective_modulus_pa: f64,
        /// `D` in m.
        radial_clearance_m: f64,
    },
    /// Liu et al. 2007 times the bearing length: `F = L (pi/2) d E* sqrt(d/(2(D + d)))`.
    LiuTimesLength {
        /// `E*` in Pa.
        effective_modulus_pa: f64,
        /// `D` in m.
        radial_clearance_m: f64,
        /// `L` in m.
        length_m: f64,
    },
}

impl Stiffness {
    /// Elastic force in N at a deformation in m; 0 without contact (`d <= 0`).
    pub fn force_n(&self, deformation_m: f64) -> f64 {
        let d = deformation_m;
        if d <= 0.0 {
            return 0.0;
        }
        match *self {
            Self::Hertz { coefficient } => coefficient * d * sqrt(d),
            Self::HybridAsPrinted { effective_modulus_pa, radial_clearance_m: clearance } => {
                let sum = clearance + d;
                let shape = 3.0 * clearance + 2.0 * d;
                let coefficient = PI / 8.0 * effective_modulus_pa * sqrt(2.0 * d / sum) * shape / sum;
                coefficient * d * sqrt(d)
            }
            Self::LiuTimesLength { effective_modulus_pa, radial_clearance_m, length_m } => {
                length_m * 0.5 * PI * d * effective_modulus_pa * sqrt(d / (2.0 * (radial_clearance_m + d)))
            }
        }
    }
}

/// Hertz's coefficient `K` in N/m^1.5 of a sphere of `inner_radius_m` inside a sphere of `outer_radius_m`:
/// `K = 4/(3(h_i + h_j)) sqrt(R_i R_j/(R_i - R_j))`. The outer radius must be the larger one.
pub fn hertz_sphere_in_sphere(
    outer_radius_m: f64,
    outer: &Material,
    inner_radius_m: f64,
    inner: &Material,
) -> f64 {
    let curvature = outer_radius_m * inner_radius_m / (outer_radius_m - inner_radius_m);
    4.0 / (3.0 * (outer.compliance_per_pa() + inner.compliance_per_pa())) * sqrt(curvature)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::effective_modulus_pa;

    #[test]
    fn hertz_coefficient_of_the_slider_crank_joint() {
        let steel = Material { youngs_modulus_pa: 207e9, poisson_ratio: 0.3 };
        let k = hertz_sphere_in_sphere(10e-3, &steel, 9.5e-3, &steel);
        assert!((k / 6.6101984e10 - 1.0).abs() < 1e-7, "{k}");
    }

    #[test]
    fn hybrid_coefficient_is_the_derivative_of_liu_per_length() {
        let effective_modulus_pa = effective_modulus_pa(&Material::BABBITT, &Material::STEEL);
        let radial_clearance_m = 0.5e-3;
        let liu = Stiffness::LiuTimesLength { effective_modulus_pa, radial_clearance_m, length_m: 1.0 };
        let hybrid = Stiffness::HybridAsPrinted { effective_modulus_pa, radial_clearance_m };
        for d in [1e-6, 1e-5, 5e-5, 2e-4] {
            let h = d * 1e-5;
            let slope = (liu.force_n(d + h) - liu.force_n(d - h)) / (2.0 * h);
            let coefficient = hybrid.force_n(d) / (d * d.sqrt());
            assert!((slope / coefficient - 1.0).abs() < 1e-8, "d = {d}: {slope} {coefficient}");
        }
    }

    #[test]
    fn printed_plastic_law_at_the_edge_of_table_2() {
        let effective_modulus_pa = effective_modulus_pa(&Material::PLASTIC, &Material::STEEL);
        for (clearance_mm, force_kn) in [(0.1, 2.88), (0.25, 2.37), (0.5, 1.89), (1.0, 1.43), (1.5, 1.20)] {
            let law =
                Stiffness::HybridAsPrinted { effective_modulus_pa, radial_clearance_m: clearance_mm * 1e-3 };
            let force = law.force_n(1e-4) * 1e-3;
            assert!((force - force_kn).abs() < 0.006, "{clearance_mm} mm: {force} kN");
        }
    }
}
