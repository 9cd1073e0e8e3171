//! Dry friction: a coefficient over the sliding speed, opposed to it.
//!
//! `mu(v) = mu_c + (mu_s - mu_c) exp(-(|v|/v_s)^n) + k max(|v| - v_k, 0)`, speeds in m/s, forces in
//! N.

use crate::error::{LawError, above_zero, at_least_zero, expect};
use crate::real::Real;

/// Exponent of the Stribeck term `exp(-(|v|/v_s)^n)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StribeckShape {
    /// `n = 1`.
    Tustin,
    /// `n = 2`.
    Gauss,
}

/// Coefficient of friction over the sliding speed.
///
/// Coulomb (paper eq. 6) is `static_coefficient == coulomb_coefficient` and no viscous slope.
/// Stribeck (paper eqs. 7-8) adds the exponential. The viscous slope may begin above a threshold
/// speed, as measured on the plastic bearing. The sign is regularised by `tanh(v/v_r)` because a
/// force law inside an integrator must be a function of the state; `regularisation_m_s = 0` gives
/// the discontinuous sign with 0 at standstill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionLaw<T = f64> {
    /// Coefficient at high speed, `F_c/N`.
    pub coulomb_coefficient: T,
    /// Coefficient at the onset of sliding, `F_s/N`.
    pub static_coefficient: T,
    /// Stribeck speed `v_s` in m/s, above 0 if the two coefficients differ.
    pub stribeck_speed_m_s: T,
    /// Exponent of the Stribeck term.
    pub shape: StribeckShape,
    /// Slope of the coefficient over speed in s/m.
    pub viscous_slope_s_m: T,
    /// Speed in m/s where the viscous slope begins.
    pub viscous_onset_m_s: T,
    /// Width `v_r` of the regularised sign in m/s.
    pub regularisation_m_s: T,
}

impl<T: Real> FrictionLaw<T> {
    /// Coulomb's law with a regularised sign.
    pub const fn coulomb(coefficient: T, regularisation_m_s: T) -> Self {
        Self {
            coulomb_coefficient: coefficient,
            static_coefficient: coefficient,
            stribeck_speed_m_s: T::ONE,
            shape: StribeckShape::Tustin,
            viscous_slope_s_m: T::ZERO,
            viscous_onset_m_s: T::ZERO,
            regularisation_m_s,
        }
    }

    /// Checks signs and order: coefficients, slope and speeds 0 or more, Stribeck speed above 0.
    pub fn check(&self) -> Result<(), LawError> {
        at_least_zero("Coulomb coefficient", self.coulomb_coefficient)?;
        let holds = self.static_coefficient >= self.coulomb_coefficient;
        expect("static coefficient", self.static_coefficient, holds, "at least the Coulomb coefficient")?;
        above_zero("Stribeck speed (m/s)", self.stribeck_speed_m_s)?;
        at_least_zero("viscous slope (s/m)", self.viscous_slope_s_m)?;
        at_least_zero("viscous onset (m/s)", self.viscous_onset_m_s)?;
        at_least_zero("regularisation speed (m/s)", self.regularisation_m_s)?;
        Ok(())
    }

    /// Unsigned coefficient at a sliding speed in m/s.
    pub fn coefficient(&self, sliding_speed_m_s: T) -> T {
        let speed = sliding_speed_m_s.abs();
        let ratio = speed / self.stribeck_speed_m_s;
        let power = match self.shape {
            StribeckShape::Tustin => ratio,
            StribeckShape::Gauss => ratio * ratio,
        };
        self.coulomb_coefficient
            + (self.static_coefficient - self.coulomb_coefficient) * (-power).exp()
            + self.viscous_slope_s_m * (speed - self.viscous_onset_m_s).max(T::ZERO)
    }

    /// Coefficient with the sign of the sliding speed, and its derivative over the speed in s/m.
    ///
    /// Requires a regularised sign (`regularisation_m_s > 0`): the derivative at standstill is the
    /// static coefficient over that speed.
    pub fn signed_coefficient(&self, sliding_speed_m_s: T) -> (T, T) {
        let (speed, ratio) = (sliding_speed_m_s.abs(), sliding_speed_m_s.abs() / self.stribeck_speed_m_s);
        let (power, power_slope) = match self.shape {
            StribeckShape::Tustin => (ratio, T::ONE),
            StribeckShape::Gauss => (ratio * ratio, ratio + ratio),
        };
        let rise = (self.static_coefficient - self.coulomb_coefficient) * (-power).exp();
        let viscous = if speed > self.viscous_onset_m_s { self.viscous_slope_s_m } else { T::ZERO };
        let size = self.coulomb_coefficient + rise + viscous * (speed - self.viscous_onset_m_s);
        let slope = viscous - rise * power_slope / self.stribeck_speed_m_s;
        let sign = (speed / self.regularisation_m_s).tanh();
        let sign_slope = (T::ONE - sign * sign) / self.regularisation_m_s;
        ((size * sign).copysign(sliding_speed_m_s), slope * sign + size * sign_slope)
    }

    /// Friction force in N along the sliding direction: opposed to the sliding speed.
    pub fn force_n(&self, normal_force_n: T, sliding_speed_m_s: T) -> T {
        let sign = if self.regularisation_m_s > T::ZERO {
            (sliding_speed_m_s / self.regularisation_m_s).tanh()
        } else {
            sliding_speed_m_s.sign()
        };
        -self.coefficient(sliding_speed_m_s) * normal_force_n * sign
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BearingMaterial;
    use proptest::prelude::*;

    #[test]
    fn stribeck_exponents_are_tustin_and_gauss() {
        let tustin = FrictionLaw { stribeck_speed_m_s: 0.01, ..BearingMaterial::Babbitt.friction_law() };
        let gauss = FrictionLaw { shape: StribeckShape::Gauss, ..tustin };
        assert!((tustin.coefficient(0.02) - (0.14 + 0.08 * (-2.0_f64).exp())).abs() < 1e-15);
        assert!((gauss.coefficient(0.02) - (0.14 + 0.08 * (-4.0_f64).exp())).abs() < 1e-15);
        assert_eq!(tustin.coefficient(0.0), 0.22);
    }

    #[test]
    fn discontinuous_coulomb_is_zero_at_rest_and_full_beside_it() {
        let law = FrictionLaw::coulomb(0.3, 0.0);
        assert_eq!(law.force_n(100.0, 0.0), 0.0);
        assert_eq!(law.force_n(100.0, 1e-12), -30.0);
        assert_eq!(law.force_n(100.0, -1e-12), 30.0);
    }

    #[test]
    fn plastic_is_flat_up_to_its_knee_then_rises() {
        let law = BearingMaterial::Plastic.friction_law();
        assert_eq!(law.coefficient(0.019), 0.08);
        assert!((law.coefficient(0.12) - 0.105).abs() < 1e-15);
    }

    proptest! {
        #[test]
        fn signed_coefficient_is_the_friction_of_one_newton_with_its_derivative(v in -0.3..0.3_f64) {
            let babbitt = BearingMaterial::Babbitt.friction_law();
            let gauss = FrictionLaw { shape: StribeckShape::Gauss, ..babbitt };
            for law in [babbitt, BearingMaterial::Plastic.friction_law(), gauss] {
                let (value, slope) = law.signed_coefficient(v);
                prop_assert!((value + law.force_n(1.0, v)).abs() < 1e-15);
                let step = 1e-8;
                let secant = (law.force_n(1.0, v - step) - law.force_n(1.0, v + step)) / (2.0 * step);
                let is_kink = (v.abs() - law.viscous_onset_m_s).abs() < 2.0 * step || v.abs() < 2.0 * step;
                let error = (slope - secant).abs();
                prop_assert!(is_kink || error < 1e-3 + 1e-4 * secant.abs(), "{slope} {secant}");
            }
        }

        #[test]
        fn friction_dissipates_and_is_odd(n in 0.0..1e5_f64, v in -1.0..1.0_f64) {
            for law in [
                BearingMaterial::Babbitt.friction_law(),
                BearingMaterial::Plastic.friction_law(),
                FrictionLaw::coulomb(0.2, 1e-3),
            ] {
                prop_assert!(law.force_n(n, v) * v <= 0.0);
                prop_assert_eq!(law.force_n(n, v), -law.force_n(n, -v));
            }
        }
    }
}
