//! Karnopp 1985: a band of speeds that counts as standstill.
//!
//! Inside `|v| < v_band` friction balances the applied force up to `mu_s N`; below that limit the
//! joint sticks. Outside, friction is `mu_c N` plus a viscous part, against the motion. Checked
//! against public implementations and quotations (band, balance and break-away; Coulomb and viscous
//! outside).
//!
//! The law needs the applied tangential force: the sum of all others on the sliding body, along the
//! sliding direction. That is its known limit: in a mechanism this force follows from the equations
//! of motion. While the joint sticks, set the speed to 0 (Karnopp's own rule) or leave its residual
//! inside the band; the creep is then below `v_band`.

use crate::error::{LawError, above_zero, at_least_zero, expect};
use crate::real::Real;

/// Karnopp's law. Coefficients dimensionless.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Karnopp<T = f64> {
    coulomb_coefficient: T,
    static_coefficient: T,
    viscous_slope_s_m: T,
    band_m_s: T,
}

/// State of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KarnoppState {
    /// Sticking: in the band, and friction balances the applied force.
    Sticking,
    /// Break-away: in the band, but the applied force exceeds `mu_s N`.
    BreakingAway,
    /// Outside the band.
    Sliding,
}

impl<T: Real> Karnopp<T> {
    /// `0 <= mu_c <= mu_s`, viscous slope in s/m 0 or more, band in m/s above 0.
    pub fn new(
        coulomb_coefficient: T,
        static_coefficient: T,
        viscous_slope_s_m: T,
        band_m_s: T,
    ) -> Result<Self, LawError> {
        at_least_zero("Coulomb coefficient", coulomb_coefficient)?;
        let holds = static_coefficient >= coulomb_coefficient;
        expect("static coefficient", static_coefficient, holds, "at least the Coulomb coefficient")?;
        at_least_zero("viscous slope (s/m)", viscous_slope_s_m)?;
        above_zero("band (m/s)", band_m_s)?;
        Ok(Self { coulomb_coefficient, static_coefficient, viscous_slope_s_m, band_m_s })
    }

    /// Width of the band in m/s.
    pub fn band_m_s(&self) -> T {
        self.band_m_s
    }

    /// Applied force in N up to which the joint sticks.
    pub fn break_away_n(&self, normal_force_n: T) -> T {
        self.static_coefficient * normal_force_n
    }

    /// Returns the state at a sliding speed under an applied tangential force.
    pub fn state(&self, normal_force_n: T, sliding_speed_m_s: T, applied_n: T) -> KarnoppState {
        if sliding_speed_m_s.abs() >= self.band_m_s {
            KarnoppState::Sliding
        } else if applied_n.abs() <= self.break_away_n(normal_force_n) {
            KarnoppState::Sticking
        } else {
            KarnoppState::BreakingAway
        }
    }

    /// Friction force in N along the sliding direction.
    pub fn force_n(&self, normal_force_n: T, sliding_speed_m_s: T, applied_n: T) -> T {
        let speed = sliding_speed_m_s.abs();
        match self.state(normal_force_n, sliding_speed_m_s, applied_n) {
            KarnoppState::Sticking => -applied_n,
            KarnoppState::BreakingAway => -self.break_away_n(normal_force_n) * applied_n.sign(),
            KarnoppState::Sliding => {
                let coefficient = self.coulomb_coefficient + self.viscous_slope_s_m * speed;
                -coefficient * normal_force_n * sliding_speed_m_s.sign()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn break_away_is_exactly_at_the_static_force() {
        let law = Karnopp::new(0.2, 0.3, 0.0, 1e-4).unwrap();
        assert_eq!(law.force_n(100.0, 0.0, 29.999), -29.999);
        assert_eq!(law.state(100.0, 0.0, 30.0), KarnoppState::Sticking);
        assert_eq!(law.state(100.0, 0.0, 30.001), KarnoppState::BreakingAway);
        assert_eq!(law.force_n(100.0, 0.0, -31.0), 30.0);
        assert_eq!(law.force_n(100.0, 1e-3, 31.0), -20.0);
        assert!(Karnopp::new(0.3, 0.2, 0.0, 1e-4).is_err() && Karnopp::new(0.2, 0.3, 0.0, 0.0).is_err());
    }

    proptest! {
        #[test]
        fn it_is_odd_and_dissipates_outside_its_band(
            v in -1.0..1.0_f64, applied in -100.0..100.0_f64, n in 0.0..200.0_f64,
        ) {
            let law = Karnopp::new(0.2, 0.3, 0.1, 1e-4).unwrap();
            let force = law.force_n(n, v, applied);
            prop_assert_eq!(force, -law.force_n(n, -v, -applied));
            if v.abs() >= 1e-4 { prop_assert!(force * v <= 0.0); }
            prop_assert!(force.abs() <= 0.3 * n + 0.1 * n * v.abs());
        }

        #[test]
        fn without_a_static_excess_it_is_coulombs(v in 1e-6..1.0_f64) {
            let law = Karnopp::new(0.2, 0.2, 0.0, 1e-9).unwrap();
            prop_assert_eq!(law.force_n(100.0, v, 5.0), -20.0);
        }
    }
}
