//! Conversion of a physical sample to the networks' input columns, in integer arithmetic.
//!
//! Features are fractions from -1 to 1 in units of 1/32767. They saturate at the training range, so
//! that the networks never see untrained inputs; the flags report it. The force itself still grows
//! with the deformation beyond the range, because the training target is divided by a power of the
//! deformation. The same formulas in floating point, for training, are in `model-quant`.

use crate::fixed::{Reciprocal, fraction, fraction_wide, root};
use crate::flags::Flags;
use crate::image::Header;
use crate::sample::Sample;

/// Inputs of the collision network per column.
pub const COLLISION_INPUTS: usize = 8;
/// Inputs of the friction network per column.
pub const FRICTION_INPUTS: usize = 4;
/// Full scale: the integer of a feature of 1.
pub const FULL_SCALE: i16 = i16::MAX;
/// Multiple of the deformation's training range up to which the force grows (and is flagged).
pub const EXTRAPOLATION: u32 = 4;

/// Input column of the collision network with its scale factor and flags.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CollisionColumn {
    /// Features of the column.
    pub inputs: [i16; COLLISION_INPUTS],
    /// Factor, times 2^30, from the network's output to the square root of the normal force; 0
    /// without contact.
    pub root_force_factor_q30: u32,
    /// Inputs that lie outside the training range.
    pub(crate) flags: Flags,
}

/// Feature formulas with the constants of one image.
#[derive(Clone, Copy, Debug, Hash)]
pub struct Features {
    header: Header,
    per_clearance: Reciprocal,
    per_deformation: Reciprocal,
    per_sliding_speed: Reciprocal,
    per_root_force: Reciprocal,
}

/// Converts a fraction times 2^32 to a feature.
#[inline]
fn feature(fraction: u32) -> i16 {
    ((u64::from(fraction).wrapping_mul(FULL_SCALE as u64)).wrapping_add(1 << 31) >> 32) as i16
}

/// Converts the doubled square root of a fraction times 2^32 ([`root`], so times 2^17) to a
/// feature.
#[inline]
fn root_feature(fraction: u32) -> i16 {
    (root(fraction).wrapping_mul(FULL_SCALE as u32).wrapping_add(1 << 16) >> 17) as i16
}

/// Returns the feature with the sign of a number.
#[inline]
fn signed(feature: i16, sign: i32) -> i16 {
    if sign < 0 { feature.wrapping_neg() } else { feature }
}

impl Features {
    /// Prepares the formulas for an image.
    pub fn new(header: Header) -> Self {
        let root_force_high = (u64::from(header.normal_force_high_mn) << 32) / 1000;
        Self {
            header,
            per_clearance: Reciprocal::new(header.clearance_high_nm),
            per_deformation: Reciprocal::new(header.deformation_high_pm),
            per_sliding_speed: Reciprocal::new(header.sliding_speed_high_nm_s),
            per_root_force: Reciprocal::new(root_force_high.isqrt() as u32),
        }
    }

    /// Header of the image.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Returns the input column of the collision network.
    ///
    /// Inputs: clearance `D`, deformation `d` (0 in a gap), `sqrt d`, ratio `r` of the rate to the
    /// approach speed, each divided by the upper end of its range; the penetration `d/(D + d)`;
    /// `r/(1 + |r|)`; `sqrt(D_low/(D + d))`; `sqrt((r - r_low)/(r_high - r_low))`.
    #[inline]
    pub fn collision(&self, sample: &Sample) -> CollisionColumn {
        let header = &self.header;
        let contact = sample.deformation_pm > 0;
        let clearance = sample.radial_clearance_nm.max(header.clearance_low_nm).min(header.clearance_high_nm);
        let found = sample.deformation_pm.max(0).cast_unsigned();
        let deformation = found.min(header.deformation_high_pm);
        // Less than 2 mm plus 1.1 mm in pm: the sum fits into 32 bits.
        let span = clearance.wrapping_mul(1000).wrapping_add(deformation);
        let low = header.clearance_low_nm.wrapping_mul(1000);
        let relative = self.per_deformation.fraction(deformation, 32);

        // Largest rate inside the range, in nm/s: up to 2^31 times 2^6.
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

    /// Returns the input column of the friction network for the square root of the normal force in
    /// N, times 2^16, and the sliding speed. The caller applies the sign of the speed: friction is
    /// an odd function of it.
    ///
    /// Inputs: root force and speed `v` divided by the upper ends of their ranges, `v/(v +
    /// v_slow)`, `v/(v + v_fast)`.
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
