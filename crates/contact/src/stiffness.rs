//! Stiffness part of a normal law: elastic force as a function of the deformation.
//!
//! Deformation in m, force in N. [`Stiffness::from_name`] and [`crate::StiffnessKind::build`] check
//! the ranges. The variants can also be written directly, unchecked, if the parameters are known to
//! be valid.

use crate::error::{LawError, expect};
use crate::joint::Joint;
use crate::logarithmic::Logarithmic;
use crate::material::Material;
use crate::real::Real;
use core::f64::consts::PI;

/// Elastic part of a normal law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stiffness<T = f64> {
    /// `F = K d`.
    Linear {
        /// `K` in N/m.
        coefficient: T,
    },
    /// `F = K d^1.5` with a constant `K` in N/m^1.5 (Hertz, sphere in sphere; see
    /// [`hertz_sphere_in_sphere`]).
    Hertz {
        /// `K` in N/m^1.5.
        coefficient: T,
    },
    /// `F = K d^n`. Pereira's law is of this form; see `Stiffness::pereira`.
    Power {
        /// `K` in N/m^n.
        coefficient: T,
        /// `n`, above 0.
        exponent: T,
    },
    /// The hybrid law of Bai and Zhao as the paper prints it: `F = K_n d^1.5`, `K_n = (1/8) pi E*
    /// sqrt(2 d (3D + 2d)^2/(D + d)^3)`.
    ///
    /// `K_n` is the derivative over `d` of [`Stiffness::LiuTimesLength`] per unit of length, so
    /// this product has the wrong unit (no bearing length enters). Kept under its own name to
    /// reproduce the paper; for a consistent law take Liu's.
    HybridAsPrinted {
        /// `E*` in Pa.
        effective_modulus_pa: T,
        /// `D` in m.
        radial_clearance_m: T,
    },
    /// Liu et al. 2007 times the bearing length: `F = L (pi/2) d E* sqrt(d/(2(D + d)))`.
    LiuTimesLength {
        /// `E*` in Pa.
        effective_modulus_pa: T,
        /// `D` in m.
        radial_clearance_m: T,
        /// `L` in m.
        length_m: T,
    },
    /// Johnson, Radzimovsky, Goldsmith, Dubowsky-Freudenstein or ESDU-78035: implicit, up to a
    /// limit.
    Logarithmic(Logarithmic<T>),
}

impl<T: Real> Stiffness<T> {
    /// Elastic force in N at a deformation in m; 0 without contact (`d <= 0`).
    ///
    /// Beyond [`Stiffness::largest_deformation_m`] the force is clamped to its largest value, so
    /// that a trial step of an integrator stays finite. Such a result is outside the law.
    pub fn force_n(&self, deformation_m: T) -> T {
        let d = deformation_m;
        if d <= T::ZERO {
            return T::ZERO;
        }
        match *self {
            Self::Linear { coefficient } => coefficient * d,
            Self::Hertz { coefficient } => coefficient * d * d.sqrt(),
            Self::Power { coefficient, exponent } => coefficient * d.powf(exponent),
            Self::HybridAsPrinted { effective_modulus_pa, radial_clearance_m: clearance } => {
                let sum = clearance + d;
                let shape = T::from_f64(3.0) * clearance + T::from_f64(2.0) * d;
                let coefficient = T::from_f64(PI / 8.0)
                    * effective_modulus_pa
                    * (T::from_f64(2.0) * d / sum).sqrt()
                    * shape
                    / sum;
                coefficient * d * d.sqrt()
            }
            Self::LiuTimesLength { effective_modulus_pa, radial_clearance_m, length_m } => {
                length_m
                    * T::from_f64(0.5)
                    * T::from_f64(PI)
                    * d
                    * effective_modulus_pa
                    * (d / (T::from_f64(2.0) * (radial_clearance_m + d))).sqrt()
            }
            Self::Logarithmic(law) => law.force_n(d),
        }
    }

    /// Largest deformation in m for which the law is valid, if there is one.
    pub fn largest_deformation_m(&self) -> Option<T> {
        match self {
            Self::Logarithmic(law) => Some(law.largest_deformation_m()),
            _ => None,
        }
    }

    /// Pereira et al. 2011, internal contact: `F = (a D + b) L E*/D d^n`, `a = .965`, `b = .0965`,
    /// `n = Y D^-0.005`, `Y = 1.51 ln(1000 D)^-0.151` for `.005 <= D < .34954` and `.0151 D +
    /// 1.151` up to 10.
    ///
    /// Here `D`, `d` and `L` are in mm and `E*` in MPa, as the authors fitted them; the result is
    /// converted to SI. The fit is checked against its authors' range: a clearance outside .005 to
    /// 10 mm is refused. Their published law has Zhiying and Qishao's factor; any other factor can
    /// be combined with it here.
    pub(crate) fn pereira(joint: &Joint<T>) -> Result<Self, LawError> {
        joint.check()?;
        let clearance_mm = joint.radial_clearance_m * T::from_f64(1e3);
        let (low, high) = (T::from_f64(0.005 * (1.0 - 1e-6)), T::from_f64(10.0 * (1.0 + 1e-6)));
        let holds = clearance_mm >= low && clearance_mm <= high;
        expect(
            "radial clearance (m)",
            joint.radial_clearance_m,
            holds,
            "5e-6 to 1e-2, the range of the fit",
        )?;
        let shape = if clearance_mm < T::from_f64(0.34954) {
            T::from_f64(1.51) * (T::from_f64(1e3) * clearance_mm).ln().powf(T::from_f64(-0.151))
        } else {
            T::from_f64(0.0151) * clearance_mm + T::from_f64(1.151)
        };
        let exponent = shape * clearance_mm.powf(T::from_f64(-0.005));
        let modulus_mpa = joint.effective_modulus_pa() * T::from_f64(1e-6);
        let length_mm = joint.length_m * T::from_f64(1e3);
        let per_mm = (T::from_f64(0.965) * clearance_mm + T::from_f64(0.0965)) * length_mm * modulus_mpa
            / clearance_mm;
        Ok(Self::Power { coefficient: per_mm * T::from_f64(1e3).powf(exponent), exponent })
    }
}

/// Hertz's coefficient `K` in N/m^1.5 of a sphere of `inner_radius_m` inside a sphere of
/// `outer_radius_m`: `K = 4/(3(h_i + h_j)) sqrt(R_i R_j/(R_i - R_j))`. The outer radius must be the
/// larger one.
pub fn hertz_sphere_in_sphere<T: Real>(
    outer_radius_m: T,
    outer: &Material<T>,
    inner_radius_m: T,
    inner: &Material<T>,
) -> T {
    let curvature = outer_radius_m * inner_radius_m / (outer_radius_m - inner_radius_m);
    T::from_f64(4.0) / (T::from_f64(3.0) * (outer.compliance_per_pa() + inner.compliance_per_pa()))
        * curvature.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BearingMaterial;
    use crate::material::effective_modulus_pa;

    fn joint(radial_clearance_m: f64) -> Joint {
        Joint {
            bearing_radius_m: 0.07,
            radial_clearance_m,
            length_m: 0.14,
            bearing: BearingMaterial::Babbitt.elastic(),
            journal: Material::STEEL,
        }
    }

    #[test]
    fn hertz_coefficient_of_the_slider_crank_joint() {
        let steel = Material { youngs_modulus_pa: 207e9, poisson_ratio: 0.3 };
        let k = hertz_sphere_in_sphere(10e-3, &steel, 9.5e-3, &steel);
        assert!((k / 6.6101984e10 - 1.0).abs() < 1e-7, "{k}");
    }

    #[test]
    fn hybrid_coefficient_is_the_derivative_of_liu_per_length() {
        let effective_modulus_pa =
            effective_modulus_pa(&BearingMaterial::Babbitt.elastic(), &Material::STEEL);
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
        let effective_modulus_pa =
            effective_modulus_pa(&BearingMaterial::Plastic.elastic(), &Material::STEEL);
        for (clearance_mm, force_kn) in [(0.1, 2.88), (0.25, 2.37), (0.5, 1.89), (1.0, 1.43), (1.5, 1.20)] {
            let law =
                Stiffness::HybridAsPrinted { effective_modulus_pa, radial_clearance_m: clearance_mm * 1e-3 };
            let force = law.force_n(1e-4) * 1e-3;
            assert!((force - force_kn).abs() < 0.006, "{clearance_mm} mm: {force} kN");
        }
    }

    #[test]
    fn pereira_is_the_fit_in_millimetres_and_continuous_at_its_break() {
        let Ok(Stiffness::Power { coefficient, exponent }) = Stiffness::pereira(&joint(0.5e-3)) else {
            panic!("in range")
        };
        // By hand at D = .5 mm: Y = .0151 * .5 + 1.151, n = Y * .5^-.005, K = (.965 * .5 + .0965) *
        // 140 * E*/.5.
        let n = 1.15855 * 0.5_f64.powf(-0.005);
        let modulus_mpa = 1e-6 * effective_modulus_pa(&BearingMaterial::Babbitt.elastic(), &Material::STEEL);
        let per_mm = 0.579 * 140.0 * modulus_mpa / 0.5;
        assert!((exponent - n).abs() < 1e-12, "{exponent}");
        let force = Stiffness::Power { coefficient, exponent }.force_n(0.02e-3);
        assert!((force / (per_mm * 0.02_f64.powf(n)) - 1.0).abs() < 1e-12);
        let force = |clearance: f64| Stiffness::pereira(&joint(clearance)).map(|law| law.force_n(2e-5));
        let (below, above) = (force(0.349539e-3).unwrap(), force(0.349541e-3).unwrap());
        assert!((below / above - 1.0).abs() < 1e-4, "{below} {above}");
    }

    #[test]
    fn pereira_refuses_a_clearance_outside_its_fit() {
        assert!(Stiffness::pereira(&joint(5e-6)).is_ok() && Stiffness::pereira(&joint(1e-2)).is_ok());
        for clearance in [4.9e-6, 10.1e-3] {
            assert!(matches!(
                Stiffness::pereira(&joint(clearance)),
                Err(LawError::OutOfRange { quantity: "radial clearance (m)", .. })
            ));
        }
    }

    #[test]
    fn a_law_that_ends_keeps_its_largest_force_beyond_its_limit() {
        let law = crate::StiffnessKind::Logarithmic(crate::LogarithmicKind::Johnson)
            .build(&crate::StiffnessParameters::from_joint(joint(0.5e-3)))
            .unwrap();
        let limit = law.largest_deformation_m().unwrap();
        let largest_n = law.force_n(limit);
        assert!(largest_n.is_finite() && law.force_n(0.999 * limit) < largest_n);
        assert!((law.force_n(2.0 * limit) / largest_n - 1.0).abs() < 1e-6);
        assert_eq!(Stiffness::Linear { coefficient: 1e9 }.largest_deformation_m(), None);
    }
}
