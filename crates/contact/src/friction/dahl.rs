//! Dahl 1968: friction as a spring that yields.
//!
//! `z' = v |1 - s z/mu_c|^alpha sgn(1 - s z/mu_c)`, `s = s_0 sgn v`; `F = -N s_0 z`, with `s_0` in
//! 1/m. The form with `alpha = 1` was checked against public implementations; the exponent `alpha`
//! is recalled.
//!
//! Before sliding the force over displacement is a hysteresis loop; in steady sliding it is
//! Coulomb's `mu_c N`. There is no static excess, so no stick-slip. For every `alpha` the power
//! input minus the growth of the stored `N s_0 z^2/2` is not negative: the law is passive (tested).

use crate::error::{LawError, above_zero};
use crate::real::Real;

/// Dahl's law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dahl<T = f64> {
    coulomb_coefficient: T,
    stiffness_per_m: T,
    exponent: T,
}

impl<T: Real> Dahl<T> {
    /// `mu_c` above 0, bristle stiffness per normal force `s_0` in 1/m above 0, `alpha` above 0 (1
    /// is usual).
    pub fn new(coulomb_coefficient: T, stiffness_per_m: T, exponent: T) -> Result<Self, LawError> {
        above_zero("Coulomb coefficient", coulomb_coefficient)?;
        above_zero("bristle stiffness (1/m)", stiffness_per_m)?;
        above_zero("exponent", exponent)?;
        Ok(Self { coulomb_coefficient, stiffness_per_m, exponent })
    }

    /// Rate of the deflection in m/s, at a deflection in m and a sliding speed in m/s.
    pub fn rate_m_s(&self, deflection_m: T, sliding_speed_m_s: T) -> T {
        let v = sliding_speed_m_s;
        let left = T::ONE - self.stiffness_per_m * deflection_m * v.sign() / self.coulomb_coefficient;
        v * left.abs().powf(self.exponent) * left.sign()
    }

    /// Returns the deflection after `duration_s` of constant speed: exact for `alpha = 1`, for any
    /// stiffness and step.
    ///
    /// For other exponents use [`Dahl::rate_m_s`] with an integrator; this returns `None`.
    pub fn advanced_m(&self, deflection_m: T, sliding_speed_m_s: T, duration_s: T) -> Option<T> {
        (self.exponent == T::ONE).then(|| {
            let v = sliding_speed_m_s;
            let steady = self.coulomb_coefficient / self.stiffness_per_m * v.sign();
            let decay = (-self.stiffness_per_m * v.abs() * duration_s / self.coulomb_coefficient).exp();
            if v == T::ZERO { deflection_m } else { steady + (deflection_m - steady) * decay }
        })
    }

    /// Friction force in N along the sliding direction.
    pub fn force_n(&self, normal_force_n: T, deflection_m: T) -> T {
        -normal_force_n * self.stiffness_per_m * deflection_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn bad_figures_are_refused() {
        assert!(Dahl::new(0.0, 1e5, 1.0).is_err() && Dahl::new(0.2, -1.0, 1.0).is_err());
        assert!(Dahl::new(0.2, 1e5, 0.0).is_err());
        assert_eq!(Dahl::new(0.2, 1e5, 2.0).unwrap().advanced_m(0.0, 1.0, 1.0), None);
    }

    #[test]
    fn the_exponent_bends_the_approach_to_sliding() {
        let law = Dahl::new(0.2, 1e5, 2.0).unwrap();
        let half = 0.5 * 0.2 / 1e5;
        assert!((law.rate_m_s(half, 1e-3) - 0.25e-3).abs() < 1e-15);
        assert!((law.rate_m_s(half, -1e-3) + 2.25e-3).abs() < 1e-15);
        assert!((law.rate_m_s(3.0 * half, 1e-3) + 0.25e-3).abs() < 1e-15, "a stretched bristle gives way");
    }

    #[test]
    fn before_sliding_the_loop_closes_and_encloses_work() {
        let law = Dahl::new(0.2, 1e5, 1.0).unwrap();
        let (normal, amplitude, steps) = (100.0, 1e-6, 20_000);
        let mut z = 0.0;
        let mut loops = Vec::new();
        for _ in 0..4 {
            let mut work = 0.0;
            for index in 0..steps {
                let phase = std::f64::consts::TAU * f64::from(index) / f64::from(steps);
                let step = std::f64::consts::TAU / f64::from(steps);
                let v = amplitude * phase.cos();
                let next = law.advanced_m(z, v, step).unwrap();
                work -= 0.5 * (law.force_n(normal, z) + law.force_n(normal, next)) * v * step;
                z = next;
            }
            loops.push((work, z));
        }
        assert!(loops[3].0 > 0.0);
        assert!((loops[3].0 / loops[2].0 - 1.0).abs() < 0.05, "{loops:?}");
        // The deflection never reaches the 2 um of sliding, and returns to within the drift of the
        // last loop.
        assert!((loops[3].1 - loops[2].1).abs() < 0.05 * amplitude, "{loops:?}");
        // Far less than Coulomb's loop, 4 F A: this is pre-sliding.
        assert!(loops[3].0 < 0.5 * 4.0 * 20.0 * amplitude);
    }

    proptest! {
        #[test]
        fn the_exact_step_is_the_rate_equation(z in -2e-6..2e-6_f64, v in -1e-3..1e-3_f64) {
            let law = Dahl::new(0.2, 1e5, 1.0).unwrap();
            let step = 1e-7;
            let (mut stepped, parts) = (z, 1000);
            for _ in 0..parts {
                let middle = stepped + 0.5 * step / f64::from(parts) * law.rate_m_s(stepped, v);
                stepped += step / f64::from(parts) * law.rate_m_s(middle, v);
            }
            prop_assert!((law.advanced_m(z, v, step).unwrap() - stepped).abs() < 1e-15);
        }

        #[test]
        fn it_is_passive_and_odd(share in -1.0..1.0_f64, v in -1.0..1.0_f64, alpha in 0.5..3.0_f64) {
            let law = Dahl::new(0.2, 1e5, alpha).unwrap();
            let z = share * 0.2 / 1e5;
            let stored = 100.0 * 1e5 * z * law.rate_m_s(z, v);
            prop_assert!(-law.force_n(100.0, z) * v - stored >= -1e-12 * stored.abs());
            prop_assert_eq!(law.rate_m_s(-z, -v), -law.rate_m_s(z, v));
        }

        #[test]
        fn steady_sliding_is_coulombs(v in 1e-3..1.0_f64) {
            let law = Dahl::new(0.2, 1e5, 1.0).unwrap();
            let z = law.advanced_m(0.0, v, 1.0).unwrap();
            prop_assert!((law.force_n(100.0, z) + 20.0).abs() < 1e-9);
        }
    }
}
