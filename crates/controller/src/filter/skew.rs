//! Time between the samples of the two probes.
//!
//! A probe in the direction `w` that is sampled `t` later than the other measures the journal
//! displaced by `t (w . v) w`, with the speed `v`. The filter subtracts that with its predicted
//! speed. At 20 mm/s and 10 us the displacement is the noise of a sample.

use nalgebra::Vector2;

use super::measurement::Measurement;
use super::state::Motion;
use crate::integrity::words;

/// Displacement of the measured journal per speed, s: a symmetric matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Skew {
    yy: f32,
    yz: f32,
    zz: f32,
}
words!(Skew { yy, yz, zz });

impl Skew {
    /// Returns the skew of a probe in a direction of length 1 (y, z) that is sampled a time in s
    /// later than the other probe.
    #[must_use]
    pub fn new(direction: [f32; 2], time_s: f32) -> Self {
        let [y, z] = direction;
        Self { yy: time_s * (y * y), yz: time_s * (y * z), zz: time_s * (z * z) }
    }

    /// Returns a sample with the journal at the time of the first probe.
    pub(super) fn removed_from(&self, measured: &Measurement, motion: &Motion) -> Measurement {
        let Self { yy, yz, zz } = *self;
        let speed = Vector2::new(motion.z, motion.w);
        Measurement {
            journal_y_m: measured.journal_y_m - (yy * speed.x + yz * speed.y),
            journal_z_m: measured.journal_z_m - (yz * speed.x + zz * speed.y),
            ..*measured
        }
    }
}
