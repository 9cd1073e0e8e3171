//! Training ranges of the networks.
//!
//! `paper` is Table 2 of the paper: radial clearance uniform up to 1.5 mm, deformation up to 1e-4
//! m, rate and approach speed up to 1 m/s, independent and exponential (truncated; mean a fifth of
//! the range). `bench` covers the states of the transmission bench: the deformations of the
//! material's [`contact::LoadLimits`], rates of both signs in sustained contact with the approach
//! speed at its floor. `rig` is `bench` with the deformations under the friction rig's loads.
//!
//! Table 2 sets no bound to the ratio of rate to approach speed. All ranges limit it to -6..=6: a
//! rate beyond is replaced by that of the nearest limit. The networks clamp the ratio in the same
//! way and flag it.

use contact::DEFAULT_LATCH_FLOOR_M_S;
use inference::{BearingMaterial, Header};
use serde::{Deserialize, Serialize};

/// Name of a set of ranges and distributions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum RangeKind {
    /// Table 2 of the paper.
    Paper,
    /// States of the transmission bench.
    Bench,
    /// Loads of the friction rig, up to 300 kN.
    Rig,
}

/// Upper end of the radial clearance in nm.
const CLEARANCE_NM: u32 = 1_500_000;
/// Limit of the ratio of rate to approach speed.
const RATE_RATIO: u32 = 6;
/// Limit of the sliding speed in nm/s.
const SLIDING_SPEED_NM_S: u32 = 250_000_000;
/// Sliding speed scales in nm/s: the onset of sliding and the Stribeck range.
const SPEED_SCALES_NM_S: [u32; 2] = [1_000_000, 20_000_000];

/// Returns the header of a model trained on a range, with training id 0.
pub fn header(bearing: BearingMaterial, kind: RangeKind) -> Header {
    let limits = bearing.load_limits();
    // Lowest clearance in nm, largest deformation in um, largest force in N.
    let (clearance_low_nm, deformation_um, force_n) = match kind {
        RangeKind::Paper => (1000, 100, limits.paper_force_n),
        RangeKind::Bench => (50_000, limits.bench_deformation_um, 40_000),
        RangeKind::Rig => (50_000, limits.rig_deformation_um, 300_000),
    };
    let [slow_speed_nm_s, fast_speed_nm_s] = SPEED_SCALES_NM_S;
    Header {
        bearing,
        training_id: 0,
        deformation_half_powers: 2,
        clearance_low_nm,
        clearance_high_nm: CLEARANCE_NM,
        deformation_high_pm: 1_000_000 * deformation_um,
        rate_ratio_high_q16: RATE_RATIO << 16,
        sliding_speed_high_nm_s: SLIDING_SPEED_NM_S,
        normal_force_high_mn: 1000 * force_n,
        latch_floor_nm_s: (DEFAULT_LATCH_FLOOR_M_S * 1e9).round() as u32,
        slow_speed_nm_s,
        fast_speed_nm_s,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use inference::Range;

    /// The checked-in float checkpoints were trained on exactly these numbers.
    #[test]
    fn si_units_are_the_nearest_floats_to_the_decimals() {
        for (bearing, kind, low, deformation, force) in [
            (BearingMaterial::Babbitt, RangeKind::Paper, 1e-6, 1e-4, 1e6),
            (BearingMaterial::Plastic, RangeKind::Paper, 1e-6, 1e-4, 2e4),
            (BearingMaterial::Babbitt, RangeKind::Bench, 5e-5, 8e-5, 4e4),
            (BearingMaterial::Plastic, RangeKind::Bench, 5e-5, 2.6e-4, 4e4),
        ] {
            let header = header(bearing, kind);
            assert_eq!(header.radial_clearance_m(), Range { low, high: 1.5e-3 });
            assert_eq!(header.deformation_m(), Range { low: 0.0, high: deformation });
            assert_eq!(header.rate_ratio(), Range { low: -6.0, high: 6.0 });
            assert_eq!(header.sliding_speed_m_s(), Range { low: -0.25, high: 0.25 });
            assert_eq!(header.normal_force_n(), Range { low: 0.0, high: force });
            assert_eq!(header.latch_floor_m_s(), DEFAULT_LATCH_FLOOR_M_S as f32);
            assert_eq!(header.speed_scales_m_s(), [1e-3, 2e-2]);
        }
    }
}
