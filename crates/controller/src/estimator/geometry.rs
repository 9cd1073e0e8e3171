//! Geometry of the contact in integers: from the motion of the journal to the motion at the
//! contact, and from the contact forces to the axes of the bench.
//!
//! `a` is the distance of the journal from the centre of the bearing, `n = (y, z)/a` points to the
//! contact, and `t = (n_z, -n_y)` is the direction in which the journal slides when the shaft turns
//! forward (from +z towards +y). Positions are in nm within [`POSITION_LIMIT_NM`], the distance in
//! nm/16, directions times 2^30. No branch depends on data.

use super::arithmetic::{product, saturated, saturated_unsigned, select};
use crate::integrity::words;
use core::f32::consts::{FRAC_PI_2, PI};
use inference::fixed::{fraction, root};

/// Limit of positions, nm: beyond every clearance that can be served, and within the range of a
/// window of 24 samples.
pub const POSITION_LIMIT_NM: i32 = 7_700_000;
/// Steps of the distance in a nanometre.
pub const DISTANCE_STEPS_PER_NM: i32 = 16;
/// Fraction bits of a direction.
const DIRECTION_BITS: u32 = 30;

/// Frame of reference of the contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactFrame {
    /// Distance `a` of the journal from the centre, nm/16, rounded down.
    pub distance: i32,
    /// `n` along y, times 2^30.
    pub normal_y: i32,
    /// `n` along z, times 2^30.
    pub normal_z: i32,
    /// `2^62` over the distance times 2^`scale`.
    inverse: u32,
    /// Power of two that brings the distance to 2^31..2^32: 8 to 31.
    scale: u32,
}
words!(ContactFrame { distance, normal_y, normal_z, inverse, scale });

impl ContactFrame {
    /// Returns the frame at a journal position; magnitudes are limited to [`POSITION_LIMIT_NM`]. At
    /// the exact centre, where there is no contact, the normal is taken along +y at a distance of 1
    /// nm.
    #[inline]
    #[must_use]
    pub fn at(y_nm: i32, z_nm: i32) -> Self {
        let y = cut(y_nm);
        let z = cut(z_nm);
        let y = y | i32::from((y | z) == 0);
        // At most 2^47: the even shift to 2^62..2^64 is 16 at least.
        let square = product(y, y, 0).wrapping_add(product(z, z, 0)).cast_unsigned();
        let scale = (square.leading_zeros() >> 1) & 31;
        let scaled = square << (2 * scale);
        // A root of 16 bits from below, then one division: `h = h0 + (s - h0^2)/(2 h0)`, with a
        // relative error of 2^-30.
        let first = root((scaled >> 32) as u32).wrapping_sub(1);
        let rough = u64::from(first) << 15;
        let rest = scaled.wrapping_sub(rough.wrapping_mul(rough)) >> 18;
        let more = (rest as u32) / ((first >> 2) | 1);
        let length = saturated_unsigned(rough.wrapping_add(u64::from(more)));
        // At most just below 2^31.
        let inverse = fraction(1 << DIRECTION_BITS, length).min(i32::MAX as u32);
        // A component is not longer than the vector: below 2^31.
        let along = |component: i32| {
            product(component << (scale.wrapping_sub(1) & 31), inverse.cast_signed(), 31) as i32
        };
        Self {
            distance: (length >> (scale.wrapping_sub(4) & 31)).cast_signed(),
            normal_y: along(y),
            normal_z: along(z),
            inverse,
            scale,
        }
    }

    /// The same distance in another direction.
    #[inline]
    pub(super) const fn towards(self, normal_y: i32, normal_z: i32) -> Self {
        Self { normal_y, normal_z, ..self }
    }

    /// Returns `a phi'`: the speed of the journal around the centre, from +y towards +z, in the
    /// unit of its components (below 2^30).
    #[inline]
    #[must_use]
    pub fn turning(&self, y: i32, z: i32) -> i32 {
        let turned = product(self.normal_y, z, 0).wrapping_sub(product(self.normal_z, y, 0));
        saturated(turned >> DIRECTION_BITS)
    }

    /// Returns `a phi'^2` in units of 1024 nm/s2 from `a phi'` in nm/s; saturates at 2.2 km/s2.
    #[inline]
    #[must_use]
    pub fn centripetal(&self, turning_nm_s: i32) -> i32 {
        // (v/2^8)^2/2^14 has 32 bits: steps of 2^30 nm2/s2, 1e-5 m/s2 at a tenth of a millimetre.
        let speed = turning_nm_s >> 8;
        let square = product(speed, speed, 14).cast_unsigned();
        let quotient = square.wrapping_mul(u64::from(self.inverse));
        saturated_unsigned(quotient >> (42_u32.wrapping_sub(self.scale) & 63))
            .min(i32::MAX as u32)
            .cast_signed()
    }

    /// Returns the force of the bearing on the journal, `-F_n n + F_f t`, along y and z, in the
    /// unit of its parts.
    #[inline]
    #[must_use]
    pub fn force(&self, normal: i32, friction: i32) -> (i32, i32) {
        let y = product(self.normal_z, friction, 0).wrapping_sub(product(self.normal_y, normal, 0));
        let z = product(self.normal_y, friction, 0).wrapping_add(product(self.normal_z, normal, 0));
        (saturated(y >> DIRECTION_BITS), saturated(z.wrapping_neg() >> DIRECTION_BITS))
    }

    /// Returns the angle of `n` from +y towards +z, rad, with an error of 1e-6. It is a polynomial
    /// in the first eighth of the circle, the rest by symmetry: additions, multiplications and one
    /// division, so the bits are the same everywhere.
    #[must_use]
    pub fn angle_rad(&self) -> f32 {
        let (y, z) = (self.normal_y.saturating_abs(), self.normal_z.saturating_abs());
        let x = y.min(z) as f32 / y.max(z).max(1) as f32;
        let s = x * x;
        // Odd minimax polynomial of the arctangent on 0 to 1.
        let eighth = x
            * (0.999_996_1
                + s * (-0.333_173_7
                    + s * (0.198_078_15
                        + s * (-0.132_333_42
                            + s * (0.079_623_66 + s * (-0.033_604_21 + s * 0.006_811_79))))));
        let steep = pick(z > y, FRAC_PI_2 - eighth, eighth);
        let half = pick(self.normal_y < 0, PI - steep, steep);
        pick(self.normal_z < 0, -half, half)
    }
}

/// Limits a position.
#[inline]
#[expect(clippy::manual_clamp, reason = "a clamp may panic")]
pub(super) fn cut(position_nm: i32) -> i32 {
    position_nm.max(-POSITION_LIMIT_NM).min(POSITION_LIMIT_NM)
}

/// Returns one of two numbers without a branch.
fn pick(condition: bool, yes: f32, no: f32) -> f32 {
    let bits = select(condition, yes.to_bits().cast_signed(), no.to_bits().cast_signed());
    f32::from_bits(bits.cast_unsigned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ONE: f64 = (1 << DIRECTION_BITS) as f64;

    fn code() -> impl Strategy<Value = i32> {
        prop_oneof![-3_000_000..3_000_000_i32, -200..200_i32, any::<i32>(), Just(i32::MIN), Just(i32::MAX)]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]

        #[test]
        fn distance_and_direction_are_those_of_floating_point(y in code(), z in code()) {
            let frame = ContactFrame::at(y, z);
            let limit = f64::from(POSITION_LIMIT_NM);
            let (y, z) = (f64::from(y).clamp(-limit, limit), f64::from(z).clamp(-limit, limit));
            prop_assume!(y != 0.0 || z != 0.0);
            let a = y.hypot(z);
            let steps = a * f64::from(DISTANCE_STEPS_PER_NM);
            let error = (f64::from(frame.distance) - steps).abs();
            prop_assert!(error <= 1.0 + 2e-9 * steps, "{:?} {}", frame, steps);
            prop_assert!((f64::from(frame.normal_y) / ONE - y / a).abs() < 1e-8, "{:?}", frame);
            prop_assert!((f64::from(frame.normal_z) / ONE - z / a).abs() < 1e-8, "{:?}", frame);
            let off = (f64::from(frame.angle_rad()) - z.atan2(y)).abs();
            prop_assert!(off < 3e-6 || (off - core::f64::consts::TAU).abs() < 3e-6, "{}", off);
        }

        #[test]
        fn speeds_and_accelerations_are_those_of_floating_point(
            y in -1_000_000..1_000_000_i32, z in 50_000..1_000_000_i32,
            v_y in -400_000_000..400_000_000_i32, v_z in -400_000_000..400_000_000_i32,
        ) {
            let frame = ContactFrame::at(y, z);
            let a = f64::from(y).hypot(f64::from(z));
            let turning = (f64::from(y) * f64::from(v_z) - f64::from(z) * f64::from(v_y)) / a;
            let found = frame.turning(v_y, v_z);
            prop_assert!((f64::from(found) - turning).abs() < 20.0, "{} {}", found, turning);
            let expected = turning * turning / a / 1024.0;
            prop_assume!(expected < 2e9);
            let centripetal = f64::from(frame.centripetal(found));
            // The speed has an error of 20 nm/s (above) and steps of 256 nm/s, its square steps of
            // 2^30 nm2/s2, the distance one step.
            let distance = expected / (a * f64::from(DISTANCE_STEPS_PER_NM));
            let off = 2.0 * (256.0 + 20.0) * turning.abs() / a / 1024.0 + 1.1e9 / a / 1024.0 + distance + 2.0;
            prop_assert!((centripetal - expected).abs() <= off, "{} {} {}", centripetal, expected, off);
        }

        #[test]
        fn nothing_overflows(y in code(), z in code(), a in any::<i32>(), b in any::<i32>()) {
            let frame = ContactFrame::at(y, z);
            let _ = (frame.turning(a, b), frame.centripetal(a), frame.force(a, b));
            prop_assert!(frame.distance > 0 && frame.angle_rad().abs() <= core::f32::consts::PI);
        }

        #[test]
        fn force_components_keep_the_size(
            y in code(), z in code(),
            normal in 0..100_000_000_i32, friction in -30_000_000..30_000_000_i32,
        ) {
            let (force_y, force_z) = ContactFrame::at(y, z).force(normal, friction);
            let size = f64::from(force_y).hypot(f64::from(force_z));
            prop_assert!((size - f64::from(normal).hypot(f64::from(friction))).abs() < 3.0, "{}", size);
        }
    }

    #[test]
    fn at_the_bottom_forward_shaft_rotation_slides_backwards_along_y() {
        let frame = ContactFrame::at(0, -500_000);
        assert!(frame.normal_z + (1 << 30) < 20 && frame.normal_y == 0, "{frame:?}");
        assert!((frame.distance - 8_000_000).abs() <= 1);
        // A journal that moves to +y turns from +y to -z, that is backwards: `a phi' = n_y v_z -
        // n_z v_y`.
        assert!((frame.turning(1_000_000, 0) - 1_000_000).abs() <= 1);
        assert!((frame.angle_rad() + FRAC_PI_2).abs() < 1e-6);
        // Friction opposing forward sliding (negative) pushes the journal along +y; the bearing
        // pushes it up.
        let (force_y, force_z) = frame.force(1_000_000, -100_000);
        assert!((force_y - 100_000).abs() <= 1 && (force_z - 1_000_000).abs() <= 1, "{force_y} {force_z}");
    }

    #[test]
    fn the_centre_causes_no_division_by_zero() {
        let frame = ContactFrame::at(0, 0);
        assert_eq!(frame.force(0, 0), (0, 0));
        assert!(frame.angle_rad() == 0.0 && frame.distance.abs_diff(16) <= 1);
    }
}
