//! Which states the networks are trained on.
//!
//! `paper` is Table 2 of the paper: radial clearance uniform up to 1.5 mm, deformation up to 1e-4 m, rate and approach
//! speed up to 1 m/s, exponential and independent (truncated; mean a fifth of the range). `bench` covers what the
//! transmission bench meets: deformations up to 80 um (Babbitt) and 260 um (plastic), rates of both signs in sustained
//! contact with the approach speed at its floor.
//!
//! The rate over the approach speed has no bound in Table 2. Rule for both ranges: it is limited to -6..=6; a row
//! beyond gets the rate that gives the nearest end. The networks clamp the ratio in the same way and flag it.

use contact::DEFAULT_LATCH_FLOOR_M_S;
use inference::layout::FORMAT_VERSION;
use inference::{Bearing, Header, Range};
use serde::{Deserialize, Serialize};

/// Name of a set of ranges and distributions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum RangeKind {
    /// Table 2 of the paper.
    Paper,
    /// What the transmission bench meets.
    Bench,
}

/// Limit of the rate over the approach speed.
const RATE_RATIO: f32 = 6.0;
/// Limit of the sliding speed in m/s.
const SLIDING_SPEED_M_S: f32 = 0.25;
/// Sliding speed scales in m/s: the onset of sliding and the Stribeck range.
const SPEED_SCALES_M_S: [f32; 2] = [1e-3, 2e-2];

/// The header of a model trained on a range, without its check sum and training id.
pub fn header(bearing: Bearing, kind: RangeKind) -> Header {
    let (clearance_low, deformation_high, force_high) = match (kind, bearing) {
        (RangeKind::Paper, Bearing::Babbitt) => (1e-6, 1e-4, 1e6),
        (RangeKind::Paper, Bearing::Plastic) => (1e-6, 1e-4, 2e4),
        (RangeKind::Bench, Bearing::Babbitt) => (5e-5, 8e-5, 4e4),
        (RangeKind::Bench, Bearing::Plastic) => (5e-5, 2.6e-4, 4e4),
    };
    Header {
        bearing,
        format_version: FORMAT_VERSION,
        training_id: 0,
        deformation_half_powers: 2,
        radial_clearance_m: Range { low: clearance_low, high: 1.5e-3 },
        deformation_m: Range { low: 0.0, high: deformation_high },
        rate_ratio: Range { low: -RATE_RATIO, high: RATE_RATIO },
        sliding_speed_m_s: Range { low: -SLIDING_SPEED_M_S, high: SLIDING_SPEED_M_S },
        normal_force_n: Range { low: 0.0, high: force_high },
        latch_floor_m_s: DEFAULT_LATCH_FLOOR_M_S as f32,
        slow_speed_m_s: SPEED_SCALES_M_S[0],
        fast_speed_m_s: SPEED_SCALES_M_S[1],
        crc: 0,
    }
}
