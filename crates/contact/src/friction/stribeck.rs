//! Dry friction: a coefficient over the sliding speed, opposed to it.
//!
//! `mu(v) = mu_c + (mu_s - mu_c) exp(-(|v|/v_s)^n) + k max(|v| - v_k, 0)`, speeds in m/s, forces in N.

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
/// Coulomb (paper eq. 6) is `static_coefficient == coulomb_coefficient` and no viscous slope;
/// Stribeck (paper eqs. 7-8) adds the exponential; the viscous slope may begin at a speed of its own, as measured on
/// the plastic bearing. The sign is regularised by `tanh(v/v_r)` because a force law inside an integrator must be a
/// function of the state; `regularisation_m_s = 0` gives the discontinuous sign with 0 at rest.
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

impl FrictionLaw {
    /// Dry Babbitt on the bench: `.14 + .08 exp(-v/.02)`, sign `tanh(v/1 mm/s)`.
    pub const BABBITT_BENCH: Self = Self {
        coulomb_coefficient: 0.14,
        static_coefficient: 0.22,
        stribeck_speed_m_s: 0.02,
        shape: StribeckShape::Tustin,
        viscous_slope_s_m: 0.0,
        viscous_onset_m_s: 0.0,
        regularisation_m_s: 1e-3,
    };

    /// Dry engineering plastic on the bench: `.08`, rising by `.25 (v - .02)` above 20 mm/s.
    pub const PLASTIC_BENCH: Self =
        Self { viscous_slope_s_m: 0.25, viscous_onset_m_s: 0.02, ..Self::coulomb(0.08, 1e-3) };
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
    use proptest::prelude::*;

    #[test]
    fn stribeck_exponents_are_tustin_and_gauss() {
        let tustin = FrictionLaw { stribeck_speed_m_s: 0.01, ..FrictionLaw::BABBITT_BENCH };
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
        let law = FrictionLaw::PLASTIC_BENCH;
        assert_eq!(law.coefficient(0.019), 0.08);
        assert!((law.coefficient(0.12) - 0.105).abs() < 1e-15);
    }

    proptest! {
        #[test]
        fn friction_dissipates_and_is_odd(n in 0.0..1e5_f64, v in -1.0..1.0_f64) {
            for law in [FrictionLaw::BABBITT_BENCH, FrictionLaw::PLASTIC_BENCH, FrictionLaw::coulomb(0.2, 1e-3)] {
                prop_assert!(law.force_n(n, v) * v <= 0.0);
                prop_assert_eq!(law.force_n(n, v), -law.force_n(n, -v));
            }
        }
    }
}
