//! The normal contact law: stiffness times dissipation, with the approach speed latched at onset.

use crate::dissipation::Dissipation;
use crate::stiffness::Stiffness;
use libm::fmax;

/// Default floor of the latched approach speed, 1 mm/s.
///
/// `d'0 = 0` divides by zero, and in sustained contact the damping is `chi d'/floor`: between 1 and 200 mm/s
/// the floor moves the bench's peak force by -19 to +37 %. It is therefore a parameter, not a guard.
pub const DEFAULT_LATCH_FLOOR_M_S: f64 = 1e-3;

/// `F = F_el(d) (1 + chi(e) d'/max(d'0, floor))`, clamped at 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalLaw {
    /// Elastic part.
    pub stiffness: Stiffness,
    /// Dissipation factor.
    pub dissipation: Dissipation,
    /// Nominal restitution, `0 < e <= 1`.
    pub restitution: f64,
    /// Floor of the latched approach speed in m/s, above 0.
    pub latch_floor_m_s: f64,
}

impl NormalLaw {
    /// Normal force in N, never negative.
    ///
    /// `deformation_m` is positive in contact, `rate_m_s` its derivative, `latched_rate_m_s` the rate at onset.
    pub fn force_n(&self, deformation_m: f64, rate_m_s: f64, latched_rate_m_s: f64) -> f64 {
        let ratio = rate_m_s / fmax(latched_rate_m_s, self.latch_floor_m_s);
        let factor = 1.0 + self.dissipation.factor(self.restitution) * ratio;
        fmax(self.stiffness.force_n(deformation_m) * factor, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::produced_restitution;
    use proptest::prelude::*;

    /// Integrates a free impact with RK4 and returns (rebound speed, largest deformation, largest force, duration).
    fn impact(law: &NormalLaw, mass_kg: f64, speed_m_s: f64, step_s: f64) -> (f64, f64, f64, f64) {
        let acceleration = |d: f64, v: f64| -law.force_n(d, v, speed_m_s) / mass_kg;
        let (mut d, mut v, mut t) = (0.0, speed_m_s, 0.0);
        let (mut deepest, mut strongest) = (0.0_f64, 0.0_f64);
        loop {
            let (k1d, k1v) = (v, acceleration(d, v));
            let (k2d, k2v) =
                (v + 0.5 * step_s * k1v, acceleration(d + 0.5 * step_s * k1d, v + 0.5 * step_s * k1v));
            let (k3d, k3v) =
                (v + 0.5 * step_s * k2v, acceleration(d + 0.5 * step_s * k2d, v + 0.5 * step_s * k2v));
            let (k4d, k4v) = (v + step_s * k3v, acceleration(d + step_s * k3d, v + step_s * k3v));
            let next = d + step_s / 6.0 * (k1d + 2.0 * k2d + 2.0 * k3d + k4d);
            let next_v = v + step_s / 6.0 * (k1v + 2.0 * k2v + 2.0 * k3v + k4v);
            if next <= 0.0 {
                return (-next_v, deepest, strongest, t + step_s * d / (d - next));
            }
            (d, v, t) = (next, next_v, t + step_s);
            deepest = deepest.max(d);
            strongest = strongest.max(law.force_n(d, v, speed_m_s));
        }
    }

    #[test]
    fn hertz_impact_matches_the_closed_form() {
        let law = NormalLaw {
            stiffness: Stiffness::Hertz { coefficient: 1e9 },
            dissipation: Dissipation::None,
            restitution: 1.0,
            latch_floor_m_s: 1e-3,
        };
        let (rebound, deepest, strongest, duration) = impact(&law, 1.0, 1.0, 1e-8);
        let closed = libm::pow(5.0 / (4.0 * 1e9), 0.4);
        assert!((closed / 2.746401e-4 - 1.0).abs() < 1e-6);
        assert!((deepest / 2.746401e-4 - 1.0).abs() < 1e-6, "{deepest}");
        assert!((strongest / 4551.4105 - 1.0).abs() < 1e-6, "{strongest}");
        assert!((duration / 8.083415e-4 - 1.0).abs() < 1e-5, "{duration}");
        assert!((rebound - 1.0).abs() < 1e-6, "{rebound}");
    }

    #[test]
    fn every_law_rebounds_with_its_exact_restitution() {
        let effective_modulus_pa = 5e10;
        let radial_clearance_m = 0.5e-3;
        for stiffness in [
            Stiffness::Hertz { coefficient: 1e9 },
            Stiffness::HybridAsPrinted { effective_modulus_pa, radial_clearance_m },
            Stiffness::LiuTimesLength { effective_modulus_pa, radial_clearance_m, length_m: 0.14 },
        ] {
            for dissipation in Dissipation::ALL {
                for restitution in [0.3, 0.4, 0.6, 0.8, 0.95] {
                    let law = NormalLaw { stiffness, dissipation, restitution, latch_floor_m_s: 1e-3 };
                    let (rebound, ..) = impact(&law, 10.0, 0.5, 5e-7);
                    let expected = 0.5 * produced_restitution(dissipation.factor(restitution));
                    assert!(
                        (rebound / expected - 1.0).abs() < 2e-3,
                        "{stiffness:?} {dissipation:?} e = {restitution}: {rebound} for {expected}"
                    );
                }
            }
        }
    }

    proptest! {
        #[test]
        fn force_never_pulls_and_vanishes_without_contact(
            d in -1e-3..1e-3_f64, rate in -1.0..1.0_f64, latched in -1.0..1.0_f64, e in 0.05..1.0_f64,
        ) {
            let law = NormalLaw {
                stiffness: Stiffness::HybridAsPrinted { effective_modulus_pa: 4e10, radial_clearance_m: 2.5e-4 },
                dissipation: Dissipation::ZhiyingQishao,
                restitution: e,
                latch_floor_m_s: DEFAULT_LATCH_FLOOR_M_S,
            };
            let force = law.force_n(d, rate, latched);
            prop_assert!(force >= 0.0 && force.is_finite());
            if d <= 0.0 { prop_assert_eq!(force, 0.0); }
        }
    }
}
