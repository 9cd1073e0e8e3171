//! Coefficient of friction of the dry rubbing pair of a friction rig.
//!
//! `mu` is the coefficient of the dry rubbing pair of `[surface]`, with the sliding speed `v` in
//! m/s, the load `N` in N, and the mean pressure `p` in MPa on 140 mm x 140 mm:
//!
//! * Babbitt: `.14 + .08 exp(-v/.010) (1 + .15 (N - 100e3)/100e3)`: falls with speed, more so at
//!   higher load.
//! * plastic: `.08 (p/5)^-.15 + 6 (v - .0035)` from 3.5 mm/s to 7.4 mm/s, the rig's range; constant
//!   up to 20 mm/s, then `.25 (v - .020)` more.
//!
//! The coefficient follows the speed with a lag (frictional memory), and a standstill raises it.
//! The excess grows towards `break_away_ratio - 1` over `break_away_time_s` at standstill and is
//! lost over `break_away_distance_m` of sliding. These are assumptions in the shape of published
//! curves; the published values lie within a factor of two of them.

use crate::description::Surface;
use contact::BearingMaterial;

/// Area that carries the load, m2.
const AREA_M2: f64 = 0.14 * 0.14;
/// Maximum sliding speed of the rig's tests: 6 deg/s at a radius of 70 mm, rounded up.
const RIG_SPEED_M_S: f64 = 0.0074;
/// Speed in m/s below which a pair counts as at standstill.
const REST_M_S: f64 = 1e-5;
/// Minimum pressure in MPa at which the power law of the pressure is evaluated.
const MIN_PRESSURE_MPA: f64 = 0.01;

/// Coefficient of a dry pair at a sliding speed in m/s (not negative) and a load in N.
pub fn coefficient(material: BearingMaterial, sliding_m_s: f64, load_n: f64) -> f64 {
    let (load, rig, law) = (load_n.abs(), material.rig_friction(), material.friction_law());
    let pressure = (load / AREA_M2 * 1e-6).max(MIN_PRESSURE_MPA);
    law.coulomb_coefficient * (pressure / 5.0).powf(rig.pressure_exponent)
        + rig.stribeck_rise
            * (-sliding_m_s / rig.stribeck_speed_m_s).exp()
            * (1.0 + rig.rise_growth * (load - 100e3) / 100e3)
        + rig.slow_slope_s_m * (sliding_m_s.min(RIG_SPEED_M_S) - rig.slow_onset_m_s).max(0.0)
        + law.viscous_slope_s_m * (sliding_m_s - law.viscous_onset_m_s).max(0.0)
}

impl Surface {
    /// Excess of static friction after a step at a sliding speed.
    pub(super) fn excess_after(&self, excess: f64, sliding_m_s: f64, step_s: f64) -> f64 {
        let full = self.break_away_ratio - 1.0;
        if sliding_m_s < REST_M_S {
            full + (excess - full) * (-step_s / self.break_away_time_s).exp()
        } else {
            excess * (-sliding_m_s * step_s / self.break_away_distance_m).exp()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn babbitt_falls_with_speed_and_more_at_load_while_plastic_rises() {
        use BearingMaterial::{Babbitt, Plastic};
        let drop = |load| coefficient(Babbitt, 0.0, load) - coefficient(Babbitt, 0.0073, load);
        assert!(drop(240e3) > 1.15 * drop(100e3) && drop(100e3) > 0.04);
        assert!((coefficient(Babbitt, 0.0, 100e3) - 0.22).abs() < 1e-15);
        assert_eq!(coefficient(Plastic, 0.001, 100e3), coefficient(Plastic, 0.003, 100e3));
        assert!((coefficient(Plastic, 0.0055, 98e3) - 0.08 - 6.0 * 0.002).abs() < 1e-12);
        assert!(coefficient(Plastic, 0.006, 240e3) < coefficient(Plastic, 0.006, 100e3));
        // Babbitt has the higher torque at every speed and load of the rig.
        for load in [100e3, 150e3, 200e3, 240e3] {
            for speed in [0.0, 0.002, 0.005, 0.0073] {
                assert!(coefficient(Babbitt, speed, load) > coefficient(Plastic, speed, load));
            }
        }
    }
}
