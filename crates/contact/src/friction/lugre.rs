//! LuGre (Canudas de Wit, Olsson, Astrom, Lischinsky 1995): bristles with a Stribeck curve.
//!
//! `z' = v - s_0 |v| z/g(v)`, `g(v) = mu_c + (mu_s - mu_c) exp(-(v/v_s)^2)`, `F = -N (s_0 z + s_1
//! z' + s_2 v)`, with `s_0` in 1/m, `s_1` and `s_2` in s/m. Checked against several public
//! implementations (which give the force-scaled form; dividing by `N` is the form used for tyres).
//! With the load as a factor, a change of `N` scales the force at once and does not change the
//! deflection.
//!
//! Steady sliding: `F = -N (g(v) sgn v + s_2 v)`. Break-away falls with the rate of the applied
//! force. A load below break-away that oscillates lets the joint drift. The power input minus the
//! growth of the stored `N s_0 z^2/2` is not negative while `s_1 |v| <= 4 g(v)` (the discriminant
//! of that quadratic in `z`; tested): a damping that violates it at the speeds of a run can deliver
//! energy.

use crate::error::{LawError, above_zero, at_least_zero, expect};
use crate::real::Real;

/// The LuGre law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LuGre<T = f64> {
    /// `mu_c`, above 0.
    pub coulomb_coefficient: T,
    /// `mu_s`, at least `mu_c`.
    pub static_coefficient: T,
    /// `v_s` in m/s, above 0.
    pub stribeck_speed_m_s: T,
    /// `s_0` in 1/m, above 0.
    pub stiffness_per_m: T,
    /// `s_1` in s/m, 0 or more.
    pub damping_s_m: T,
    /// `s_2` in s/m, 0 or more.
    pub viscous_slope_s_m: T,
}

impl<T: Real> LuGre<T> {
    /// Checks every parameter.
    pub fn check(&self) -> Result<(), LawError> {
        above_zero("Coulomb coefficient", self.coulomb_coefficient)?;
        let holds = self.static_coefficient >= self.coulomb_coefficient;
        expect("static coefficient", self.static_coefficient, holds, "at least the Coulomb coefficient")?;
        above_zero("Stribeck speed (m/s)", self.stribeck_speed_m_s)?;
        above_zero("bristle stiffness (1/m)", self.stiffness_per_m)?;
        at_least_zero("bristle damping (s/m)", self.damping_s_m)?;
        at_least_zero("viscous slope (s/m)", self.viscous_slope_s_m)?;
        Ok(())
    }

    /// Returns `g(v)`: the coefficient of steady sliding without its viscous part.
    pub fn steady_coefficient(&self, sliding_speed_m_s: T) -> T {
        let ratio = sliding_speed_m_s / self.stribeck_speed_m_s;
        self.coulomb_coefficient
            + (self.static_coefficient - self.coulomb_coefficient) * (-ratio * ratio).exp()
    }

    /// Rate of the deflection in m/s, at a deflection in m and a sliding speed in m/s.
    pub fn rate_m_s(&self, deflection_m: T, sliding_speed_m_s: T) -> T {
        let v = sliding_speed_m_s;
        v - self.stiffness_per_m * v.abs() * deflection_m / self.steady_coefficient(v)
    }

    /// Returns the deflection after `duration_s` of constant speed: exact for any stiffness and
    /// step.
    ///
    /// At constant speed the rate is linear in the deflection. The time constant of the bristles,
    /// `g/(s_0 |v|)`, is microseconds on a stiff joint. With this step an integrator of the
    /// mechanism need not resolve it.
    pub fn advanced_m(&self, deflection_m: T, sliding_speed_m_s: T, duration_s: T) -> T {
        let v = sliding_speed_m_s;
        if v == T::ZERO {
            return deflection_m;
        }
        let coefficient = self.steady_coefficient(v);
        let steady = coefficient / self.stiffness_per_m * v.sign();
        let decay = (-self.stiffness_per_m * v.abs() * duration_s / coefficient).exp();
        steady + (deflection_m - steady) * decay
    }

    /// Friction force in N along the sliding direction.
    pub fn force_n(&self, normal_force_n: T, deflection_m: T, sliding_speed_m_s: T) -> T {
        let rate = self.rate_m_s(deflection_m, sliding_speed_m_s);
        -normal_force_n
            * (self.stiffness_per_m * deflection_m
                + self.damping_s_m * rate
                + self.viscous_slope_s_m * sliding_speed_m_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LAW: LuGre = LuGre {
        coulomb_coefficient: 0.15,
        static_coefficient: 0.25,
        stribeck_speed_m_s: 1e-3,
        stiffness_per_m: 1e5,
        damping_s_m: 30.0,
        viscous_slope_s_m: 0.1,
    };

    #[test]
    fn bad_figures_are_refused() {
        assert!(LAW.check().is_ok());
        assert!(LuGre { static_coefficient: 0.1, ..LAW }.check().is_err());
        assert!(LuGre { stiffness_per_m: 0.0, ..LAW }.check().is_err());
        assert!(LuGre { stribeck_speed_m_s: 0.0, ..LAW }.check().is_err());
    }

    #[test]
    fn the_stribeck_curve_has_exponent_two() {
        assert_eq!(LAW.steady_coefficient(0.0), 0.25);
        assert!((LAW.steady_coefficient(1e-3) - (0.15 + 0.1 * (-1.0_f64).exp())).abs() < 1e-15);
        assert!((LAW.steady_coefficient(-2e-3) - (0.15 + 0.1 * (-4.0_f64).exp())).abs() < 1e-15);
    }

    proptest! {
        #[test]
        fn steady_sliding_is_the_stribeck_curve(v in 1e-4..0.1_f64) {
            let z = LAW.advanced_m(0.0, v, 10.0);
            let expected = LAW.steady_coefficient(v) + 0.1 * v;
            prop_assert!((LAW.force_n(100.0, z, v) / (-100.0 * expected) - 1.0).abs() < 1e-9);
            prop_assert!(LAW.rate_m_s(z, v).abs() < 1e-12);
        }

        #[test]
        fn the_exact_step_is_the_rate_equation(z in -2e-6..2e-6_f64, v in -1e-3..1e-3_f64) {
            let (mut stepped, parts, step) = (z, 1000, 1e-7);
            for _ in 0..parts {
                let middle = stepped + 0.5 * step / f64::from(parts) * LAW.rate_m_s(stepped, v);
                stepped += step / f64::from(parts) * LAW.rate_m_s(middle, v);
            }
            prop_assert!((LAW.advanced_m(z, v, step) - stepped).abs() < 1e-15);
        }

        #[test]
        fn it_is_odd_and_passive_within_its_damping_bound(share in -1.0..1.0_f64, v in -0.02..0.02_f64) {
            let z = share * 0.25 / 1e5;
            prop_assert_eq!(LAW.force_n(100.0, -z, -v), -LAW.force_n(100.0, z, v));
            prop_assert!(LAW.damping_s_m * v.abs() <= 4.0 * LAW.steady_coefficient(v));
            let taken = -LAW.force_n(100.0, z, v) * v;
            let stored = 100.0 * 1e5 * z * LAW.rate_m_s(z, v);
            prop_assert!(taken - stored >= -1e-12 * stored.abs());
        }

        #[test]
        fn without_excess_and_viscosity_it_ends_in_coulombs(v in 1e-3..1.0_f64) {
            let law = LuGre { static_coefficient: 0.15, viscous_slope_s_m: 0.0, stiffness_per_m: 1e9, ..LAW };
            prop_assert!((law.force_n(100.0, law.advanced_m(0.0, v, 1e-3), v) + 15.0).abs() < 1e-9);
        }
    }
}
