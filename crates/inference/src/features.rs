//! From a physical sample to the networks' input columns, in whole numbers.
//!
//! Features are -1 to 1 at 32767 and saturate at the training range, so that the networks never see what they were not
//! trained on; the flags say that it happened. The force itself goes on with the deformation, as the training target is over
//! a power of it. The same formulas in floating point, for training, are in `model-quant`.

use crate::fixed::{Reciprocal, fraction, fraction_wide, root};
use crate::flags::Flags;
use crate::image::Header;
use crate::sample::Sample;

/// Inputs of the collision network per column.
pub const COLLISION_INPUTS: usize = 8;
/// Inputs of the friction network per column.
pub const FRICTION_INPUTS: usize = 4;
/// Full scale: a feature of 1.
pub const FULL_SCALE: i16 = i16::MAX;
/// The force goes on growing with the deformation up to this multiple of the training range (and is flagged).
pub const EXTRAPOLATION: u32 = 4;

/// A column of the collision network and what goes with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CollisionColumn {
    /// The features.
    pub inputs: [i16; COLLISION_INPUTS],
    /// Factor, times 2^30, that turns the network's output into the square root of the normal force; 0 without contact.
    pub root_force_factor_q30: u32,
    /// Which inputs lie outside the training range.
    pub flags: Flags,
}

/// The formulas with the constants of one image.
#[derive(Clone, Copy, Debug, Hash)]
pub struct Features {
    header: Header,
    per_clearance: Reciprocal,
    per_deformation: Reciprocal,
    per_sliding_speed: Reciprocal,
    per_root_force: Reciprocal,
}

/// A fraction of 2^32 as a feature.
#[inline]
fn feature(fraction: u32) -> i16 {
    ((u64::from(fraction).wrapping_mul(FULL_SCALE as u64)).wrapping_add(1 << 31) >> 32) as i16
}

/// A root of a fraction, of 2^17, as a feature.
#[inline]
fn root_feature(fraction: u32) -> i16 {
    (root(fraction).wrapping_mul(FULL_SCALE as u32).wrapping_add(1 << 16) >> 17) as i16
}

/// The feature with the sign of a number.
#[inline]
fn signed(feature: i16, sign: i32) -> i16 {
    if sign < 0 { feature.wrapping_neg() } else { feature }
}

impl Features {
    /// Prepares the formulas of an image.
    pub fn new(header: Header) -> Self {
        let root_force_high = (u64::from(header.normal_force_high_mn) << 32) / 1000;
        Self {
            header,
            per_clearance: Reciprocal::of(header.clearance_high_nm),
            per_deformation: Reciprocal::of(header.deformation_high_pm),
            per_sliding_speed: Reciprocal::of(header.sliding_speed_high_nm_s),
            per_root_force: Reciprocal::of(root_force_high.isqrt() as u32),
        }
    }

    /// The image's header.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The column of the collision network.
    ///
    /// Inputs: clearance `D`, deformation `d` (0 in a gap), `sqrt d`, ratio `r` of the rate to the approach speed, each
    /// over the upper end of its range; the penetration `d/(D + d)`; `r/(1 + |r|)`; `sqrt(D_low/(D + d))`;
    /// `sqrt((r - r_low)/(r_high - r_low))`.
    #[inline]
    pub fn collision(&self, sample: &Sample) -> CollisionColumn {
        let header = &self.header;
        let contact = sample.deformation_pm > 0;
        let clearance = sample.radial_clearance_nm.max(header.clearance_low_nm).min(header.clearance_high_nm);
        let found = sample.deformation_pm.max(0).cast_unsigned();
        let deformation = found.min(header.deformation_high_pm);
        // Below 2 mm and 1.1 mm: no sum leaves its 32 bits.
        let span = clearance.wrapping_mul(1000).wrapping_add(deformation);
        let low = header.clearance_low_nm.wrapping_mul(1000);
        let relative = self.per_deformation.fraction(deformation, 32);

        // The largest rate inside the range, in nm/s: up to 2^31 times 2^6.
        let approach = sample.approach_speed_nm_s.max(header.latch_floor_nm_s);
        let limit = u64::from(approach).wrapping_mul(u64::from(header.rate_ratio_high_q16)) >> 16;
        let magnitude = sample.deformation_rate_nm_s.unsigned_abs();
        let rate = u64::from(magnitude).min(limit);
        let sign = sample.deformation_rate_nm_s;
        let above_low = if sign < 0 { limit.wrapping_sub(rate) } else { limit.wrapping_add(rate) };

        let factor = self.per_deformation.fraction(found, 30);
        let root_force_factor_q30 = match header.deformation_half_powers {
            0 => u32::from(contact) << 30,
            1 => root(factor) << 14,
            _ => factor,
        };
        CollisionColumn {
            inputs: [
                feature(self.per_clearance.fraction(clearance, 32)),
                feature(relative),
                root_feature(relative),
                signed(feature(fraction_wide(rate, limit)), sign),
                feature(fraction(deformation, span)),
                signed(feature(fraction_wide(rate, rate.wrapping_add(u64::from(approach)))), sign),
                root_feature(fraction(low, span)),
                root_feature(fraction_wide(above_low, limit.wrapping_mul(2))),
            ],
            root_force_factor_q30,
            flags: Flags::OUTSIDE_CLEARANCE.when(clearance != sample.radial_clearance_nm)
                | Flags::OUTSIDE_DEFORMATION.when(found != deformation)
                // `&`, not `&&`: no branch on data.
                | Flags::OUTSIDE_RATE_RATIO.when(contact & (u64::from(magnitude) > limit))
                | Flags::OUTSIDE_SLIDING_SPEED.when(
                    contact & (sample.sliding_speed_nm_s.unsigned_abs() > header.sliding_speed_high_nm_s),
                ),
        }
    }

    /// The column of the friction network, from the square root of the normal force in N, times 2^16, that the collision
    /// network gave, and the sliding speed, whose sign is put back outside: friction is an odd function of the speed.
    ///
    /// Inputs: root force and speed `v` over the upper ends of their ranges, `v/(v + v_slow)`, `v/(v + v_fast)`.
    #[inline]
    pub fn friction(&self, root_force_q16: u32, sliding_speed_nm_s: i32) -> [i16; FRICTION_INPUTS] {
        let header = &self.header;
        let speed = sliding_speed_nm_s.unsigned_abs().min(header.sliding_speed_high_nm_s);
        [
            feature(self.per_root_force.fraction(root_force_q16, 32)),
            feature(self.per_sliding_speed.fraction(speed, 32)),
            feature(fraction(speed, speed.wrapping_add(header.slow_speed_nm_s))),
            feature(fraction(speed, speed.wrapping_add(header.fast_speed_nm_s))),
        ]
    }
}
