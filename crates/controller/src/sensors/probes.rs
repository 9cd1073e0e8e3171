//! Journal centre from the gaps of two probes at 90 degrees.
//!
//! A probe in the direction `u` measures the surface of a shaft of radius `R` displaced by `r`:
//!
//! ```text
//! gap = gap_0 - u.r + (w.r)^2/(2R),    w perpendicular to u
//! ```
//!
//! The last term, the curvature of the target, is 1.8 um at half a millimetre sideways and a radius
//! of 70 mm: nine times the noise. The other probe measures just that displacement, so one
//! correction removes it up to 15 nm. The second probe is a quarter turn from the first, from +y
//! towards +z.

use super::SensorFault;
use fixed::FixedI64;
use fixed::types::extra::{U30, U36};
use fixed::types::{I2F30, I4F60};

const HALF: FixedI64<U30> = FixedI64::lit("0.5");
/// Maximum difference of a squared direction from 1.
const DIRECTION_TOLERANCE: I4F60 = I4F60::lit("2e-6");
/// Maximum displacement of a journal, nm: 8 mm.
const FARTHEST_NM: i64 = 1 << 23;
/// Minimum journal radius, nm: 1 mm.
const MIN_RADIUS_NM: u32 = 1_000_000;

/// Two probes at 90 degrees.
#[derive(Clone, Copy, Debug)]
pub struct ProbePair {
    direction: [I2F30; 2],
    gaps_nm: [i32; 2],
    /// Reciprocal of the diameter, 1/nm.
    curvature: FixedI64<U36>,
    opposite: Option<Opposite>,
}

/// Third probe, opposite to the first.
#[derive(Clone, Copy, Debug)]
pub struct Opposite {
    /// Gap with the journal in the bearing's centre, nm.
    pub gap_nm: i32,
    /// Maximum difference from the value expected from the first probe, nm.
    pub tolerance_nm: u32,
}

impl ProbePair {
    /// Creates a pair from the direction of the first probe (y, z) and the gaps with the journal in
    /// the bearing's centre. Returns `None` if the direction is not of length 1 (to 1e-6) or the
    /// radius is below 1 mm.
    #[must_use]
    pub fn new(
        direction: [I2F30; 2],
        gaps_nm: [i32; 2],
        journal_radius_nm: u32,
        opposite: Option<Opposite>,
    ) -> Option<Self> {
        let [y, z] = direction.map(|part| part.wide_mul(part));
        // Squares are at most 4 each: a sum of 8 wraps around to -8, which is not 1 either.
        let is_unit = y.wrapping_add(z).wrapping_sub(I4F60::ONE).wrapping_abs() < DIRECTION_TOLERANCE;
        let diameter_nm = i64::from(journal_radius_nm).wrapping_mul(2);
        let curvature = FixedI64::<U36>::ONE.checked_div_int(diameter_nm)?;
        (is_unit && journal_radius_nm >= MIN_RADIUS_NM).then_some(Self {
            direction,
            gaps_nm,
            curvature,
            opposite,
        })
    }

    /// Returns the direction of the second probe, (y, z).
    #[must_use]
    pub(crate) fn second_direction(&self) -> [f32; 2] {
        let [y, z] = self.direction;
        [z.wrapping_neg(), y].map(|part| part.to_num())
    }

    /// Returns the centre of the journal, (y, z) in nm.
    #[must_use]
    pub(crate) fn centre_nm(&self, gaps_nm: [i32; 2]) -> [i32; 2] {
        let [along, across] = self.closed_nm(gaps_nm);
        let along_true = along.wrapping_add(self.curvature_nm(across));
        let across_true = across.wrapping_add(self.curvature_nm(along));
        let [y, z] = self.direction;
        let axis = |a: I2F30, b: I2F30| {
            let part =
                |a: I2F30, b_nm: i64| FixedI64::<U30>::from_bits(a.to_bits().into()).wrapping_mul_int(b_nm);
            part(a, along_true).wrapping_add(part(b, across_true)).wrapping_add(HALF).wrapping_to_num()
        };
        [axis(y, z.wrapping_neg()), axis(z, y)]
    }

    /// Compares the gap of the third probe with the value expected from the other two.
    ///
    /// # Errors
    ///
    /// They differ by more than the tolerance: the first or the third probe is wrong.
    pub fn agree(&self, gaps_nm: [i32; 2], opposite_nm: i32) -> Result<(), SensorFault> {
        let Some(opposite) = self.opposite else { return Ok(()) };
        let [along, across] = self.closed_nm(gaps_nm);
        // The gap of the third probe grows as that of the first shrinks; the curvature adds to
        // both.
        let expected = i64::from(opposite.gap_nm)
            .wrapping_add(along)
            .wrapping_add(self.curvature_nm(across).wrapping_mul(2));
        let off = i64::from(opposite_nm).wrapping_sub(expected).unsigned_abs();
        if off > u64::from(opposite.tolerance_nm) { Err(SensorFault::Disagreement) } else { Ok(()) }
    }

    /// Returns the decrease of each gap.
    fn closed_nm(&self, gaps_nm: [i32; 2]) -> [i64; 2] {
        let [first, second] = self.gaps_nm;
        let [gap_first, gap_second] = gaps_nm;
        let closed = |centred: i32, gap: i32| {
            i64::from(centred).wrapping_sub(i64::from(gap)).clamp(-FARTHEST_NM, FARTHEST_NM)
        };
        [closed(first, gap_first), closed(second, gap_second)]
    }

    /// Returns the curvature's contribution to a gap.
    fn curvature_nm(&self, across_nm: i64) -> i64 {
        // At most 2^46 times 2^15.
        self.curvature.wrapping_mul_int(across_nm.wrapping_mul(across_nm)).wrapping_to_num()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const RADIUS_NM: f64 = 69.5e6;
    const AXIS: [I2F30; 2] = [I2F30::ONE, I2F30::ZERO];
    const CENTRED_NM: [i32; 2] = [1_000_000, 1_100_000];

    /// Returns the exact gap of a probe along `u` (nm) with the shaft's circle at `r`.
    fn gap(centred: f64, u: [f64; 2], r: [f64; 2]) -> i32 {
        let along = u[0] * r[0] + u[1] * r[1];
        let across = u[0] * r[1] - u[1] * r[0];
        (centred + RADIUS_NM - along - (RADIUS_NM * RADIUS_NM - across * across).sqrt()).round() as i32
    }

    fn pair(angle: f64, opposite: Option<Opposite>) -> ProbePair {
        let direction = [angle.cos(), angle.sin()].map(I2F30::from_num);
        ProbePair::new(direction, CENTRED_NM, RADIUS_NM as u32, opposite).unwrap()
    }

    #[test]
    fn the_second_probe_is_a_quarter_turn_from_the_first_towards_z() {
        for angle in [0.0, 0.5, 2.0, -1.0] {
            let [y, z] = pair(angle, None).second_direction().map(f64::from);
            assert!((y + angle.sin()).abs() < 1e-6 && (z - angle.cos()).abs() < 1e-6, "{angle}: {y} {z}");
        }
    }

    proptest! {
        #[test]
        fn the_centre_comes_back_wherever_the_probes_are_mounted(
            angle in -3.1..3.1_f64, y in -6e5..6e5_f64, z in -6e5..6e5_f64,
        ) {
            let (u, v) = ([angle.cos(), angle.sin()], [-angle.sin(), angle.cos()]);
            let gaps = [gap(f64::from(CENTRED_NM[0]), u, [y, z]), gap(f64::from(CENTRED_NM[1]), v, [y, z])];
            let found = pair(angle, None).centre_nm(gaps);
            let errors = [f64::from(found[0]) - y, f64::from(found[1]) - z];
            prop_assert!(errors.iter().all(|error| error.abs() < 40.0), "{found:?}");
        }
    }

    #[test]
    fn a_third_probe_agrees_until_one_of_the_two_is_off() {
        let opposite = Opposite { gap_nm: 900_000, tolerance_nm: 500 };
        let probes = pair(0.3, Some(opposite));
        let (u, v, w) = (
            [0.3_f64.cos(), 0.3_f64.sin()],
            [-0.3_f64.sin(), 0.3_f64.cos()],
            [-0.3_f64.cos(), -0.3_f64.sin()],
        );
        let r = [-350_000.0, 280_000.0];
        let gaps = [gap(f64::from(CENTRED_NM[0]), u, r), gap(f64::from(CENTRED_NM[1]), v, r)];
        let third = gap(900_000.0, w, r);
        assert_eq!(probes.agree(gaps, third), Ok(()));
        assert_eq!(probes.agree(gaps, third + 600), Err(SensorFault::Disagreement));
        assert_eq!(probes.agree([gaps[0] - 600, gaps[1]], third), Err(SensorFault::Disagreement));
    }

    #[test]
    fn invalid_directions_and_shafts_are_refused() {
        assert!(ProbePair::new(AXIS, [0; 2], 69_500_000, None).is_some());
        assert!(ProbePair::new([I2F30::ONE, I2F30::lit("0.5")], [0; 2], 69_500_000, None).is_none());
        assert!(ProbePair::new(AXIS, [0; 2], 999_999, None).is_none());
    }
}
