//! Input columns of the networks in f32, for training and for the float networks.
//!
//! The controller evaluates the same formulas in fixed point ([`inference::features`]); a test here
//! keeps the two within two counts of 32767. The formulas use only `+ - * /`, comparison and
//! `sqrtf`, which IEEE 754 defines exactly, so the columns are the same on every machine. All
//! features lie in -1..=1 inside the training range. Outside it a value is clamped to the range and
//! flagged.

use inference::features::{COLLISION_INPUTS, EXTRAPOLATION, FRICTION_INPUTS};
use inference::{BearingMaterial, ContactState, Flags, Header, Range};
use libm::sqrtf;

/// Ranges of a header in SI units, with the feature formulas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloatFeatures {
    /// Bearing of the networks.
    pub bearing: BearingMaterial,
    /// Power of the deformation in the collision target, in halves.
    pub deformation_half_powers: u8,
    /// Training range of the radial clearance in m.
    pub radial_clearance_m: Range,
    /// Training range of the deformation in m.
    pub deformation_m: Range,
    /// Training range of the rate over the approach speed.
    pub rate_ratio: Range,
    /// Training range of the sliding speed in m/s.
    pub sliding_speed_m_s: Range,
    /// Range of the normal forces of the training set in N.
    pub normal_force_n: Range,
    /// Floor of the latched approach speed in m/s.
    pub latch_floor_m_s: f32,
    /// Sliding speeds in m/s at which the friction network's third and fourth input are one half.
    pub speed_scales_m_s: [f32; 2],
}

/// Input column of the collision network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloatColumn {
    /// The features.
    pub inputs: [f32; COLLISION_INPUTS],
    /// Factor from the network's output to the square root of the normal force; 0 without contact.
    pub root_force_factor: f32,
    /// Flags of the inputs outside the training range.
    pub flags: Flags,
}

impl FloatFeatures {
    /// Creates the formulas for a header.
    pub fn from_header(header: &Header) -> Self {
        Self {
            bearing: header.bearing,
            deformation_half_powers: header.deformation_half_powers,
            radial_clearance_m: header.radial_clearance_m(),
            deformation_m: header.deformation_m(),
            rate_ratio: header.rate_ratio(),
            sliding_speed_m_s: header.sliding_speed_m_s(),
            normal_force_n: header.normal_force_n(),
            latch_floor_m_s: header.latch_floor_m_s(),
            speed_scales_m_s: header.speed_scales_m_s(),
        }
    }

    /// Ratio of rate to latched approach speed, with the floor applied but not clamped to the
    /// training range.
    pub(crate) fn unclamped_rate_ratio(&self, state: &ContactState) -> f32 {
        let speed = state.approach_speed_m_s;
        let floored = if speed > self.latch_floor_m_s { speed } else { self.latch_floor_m_s };
        state.deformation_rate_m_s / floored
    }

    /// The column of the collision network; its inputs are listed at
    /// [`inference::features::Features::collision`].
    pub fn collision(&self, state: &ContactState) -> FloatColumn {
        let contact = state.deformation_m > 0.0;
        let raw_ratio = self.unclamped_rate_ratio(state);
        let clearance = self.radial_clearance_m.clamp(state.radial_clearance_m);
        let deformation = self.deformation_m.clamp(state.deformation_m);
        let ratio = self.rate_ratio.clamp(raw_ratio);
        let relative = deformation / self.deformation_m.high;
        let span = clearance + deformation;
        let magnitude = if ratio < 0.0 { -ratio } else { ratio };
        let unclamped = if contact { state.deformation_m / self.deformation_m.high } else { 0.0 };
        let unclamped = unclamped.min(EXTRAPOLATION as f32);
        let root_force_factor = match self.deformation_half_powers {
            0 => f32::from(u8::from(contact)),
            1 => sqrtf(unclamped),
            _ => unclamped,
        };
        FloatColumn {
            inputs: [
                clearance / self.radial_clearance_m.high,
                relative,
                sqrtf(relative),
                ratio / self.rate_ratio.high,
                deformation / span,
                ratio / (1.0 + magnitude),
                sqrtf(self.radial_clearance_m.low / span),
                sqrtf((ratio - self.rate_ratio.low) / (self.rate_ratio.high - self.rate_ratio.low)),
            ],
            root_force_factor,
            flags: Flags::OUTSIDE_CLEARANCE.when(!self.radial_clearance_m.contains(state.radial_clearance_m))
                | Flags::OUTSIDE_DEFORMATION.when(state.deformation_m > self.deformation_m.high)
                | Flags::OUTSIDE_RATE_RATIO.when(contact && !self.rate_ratio.contains(raw_ratio))
                | Flags::OUTSIDE_SLIDING_SPEED
                    .when(contact && !self.sliding_speed_m_s.contains(state.sliding_speed_m_s)),
        }
    }

    /// The column of the friction network, from the square root of the normal force in N (output of
    /// the collision network) and the sliding speed. Its inputs are listed at
    /// [`inference::features::Features::friction`].
    pub(crate) fn friction(&self, root_force: f32, sliding_speed_m_s: f32) -> [f32; FRICTION_INPUTS] {
        let magnitude = if sliding_speed_m_s < 0.0 { -sliding_speed_m_s } else { sliding_speed_m_s };
        let speed = self.sliding_speed_m_s.clamp(magnitude);
        let root = root_force / sqrtf(self.normal_force_n.high);
        let [slow, fast] = self.speed_scales_m_s;
        [
            if root > 1.0 { 1.0 } else { root },
            speed / self.sliding_speed_m_s.high,
            speed / (speed + slow),
            speed / (speed + fast),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::ranges::{RangeKind, header};
    use inference::features::{FULL_SCALE, Features};
    use proptest::prelude::*;

    fn kinds() -> impl Strategy<Value = (BearingMaterial, RangeKind)> {
        (0usize..4).prop_map(|case| {
            (BearingMaterial::ALL[case % 2], if case < 2 { RangeKind::Bench } else { RangeKind::Paper })
        })
    }

    /// Log-uniform magnitude of either sign.
    fn signed(decades: core::ops::Range<f64>) -> impl Strategy<Value = f32> {
        (decades, any::<bool>())
            .prop_map(|(decade, up)| (if up { 1.0 } else { -1.0 } * 10f64.powf(decade)) as f32)
    }

    fn states() -> impl Strategy<Value = ContactState> {
        (
            -7.0..-2.7,
            prop_oneof![signed(-11.0..-2.7), (0.0..3e-4f32)],
            prop_oneof![signed(-6.0..0.3), (-8e-3..8e-3f32)],
            prop_oneof![Just(0.0f32), 0.0..2e-3f32, (-4.0..0.3f64).prop_map(|d| 10f64.powf(d) as f32)],
            prop_oneof![signed(-6.0..0.3), Just(0.0)],
        )
            .prop_map(|(clearance, deformation, rate, approach, sliding)| ContactState {
                radial_clearance_m: 10f64.powf(clearance) as f32,
                deformation_m: deformation,
                deformation_rate_m_s: rate,
                approach_speed_m_s: approach,
                sliding_speed_m_s: sliding,
            })
            .prop_map(|state| {
                // Rounded to nanometres and picometres, as on the controller: half a nanometre at a
                // clearance of 1 um alone is 4 counts of 32767.
                let sample = state.sample().unwrap_or_default();
                let si = |units: f64, per_unit: f64| (units / per_unit) as f32;
                ContactState {
                    radial_clearance_m: si(f64::from(sample.radial_clearance_nm), 1e9),
                    deformation_m: si(f64::from(sample.deformation_pm), 1e12),
                    deformation_rate_m_s: si(f64::from(sample.deformation_rate_nm_s), 1e9),
                    approach_speed_m_s: si(f64::from(sample.approach_speed_nm_s), 1e9),
                    sliding_speed_m_s: si(f64::from(sample.sliding_speed_nm_s), 1e9),
                }
            })
    }

    fn close(found: i16, float: f32) -> bool {
        (f64::from(found) - f64::from(float) * f64::from(FULL_SCALE)).abs() <= 2.0
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn fixed_point_and_float_columns_agree(
            (bearing, kind) in kinds(),
            powers in 0u8..3,
            state in states(),
        ) {
            let header = inference::Header { deformation_half_powers: powers, ..header(bearing, kind) };
            let (fixed, float) = (Features::new(header), FloatFeatures::from_header(&header));
            let sample = state.sample().expect("finite");
            let (found, expected) = (fixed.collision(&sample), float.collision(&state));
            for (input, (&a, &b)) in found.inputs.iter().zip(&expected.inputs).enumerate() {
                prop_assert!(close(a, b), "input {}: {} for {}", input, a, b * f32::from(FULL_SCALE));
            }
            let factor = f64::from(found.root_force_factor_q30) / f64::from(1u32 << 30);
            // The fixed-point root has 17 bits.
            let tolerance = if powers == 1 { 2e-5 } else { 1e-6 * factor.max(0.02) };
            prop_assert!((factor - f64::from(expected.root_force_factor)).abs() < tolerance, "{}", factor);
        }

        #[test]
        fn friction_columns_agree((bearing, kind) in kinds(), root in 0.0..1200.0f32, state in states()) {
            let header = header(bearing, kind);
            let (fixed, float) = (Features::new(header), FloatFeatures::from_header(&header));
            let speed = state.sample().expect("finite").sliding_speed_nm_s;
            let found = fixed.friction((root * 65536.0) as u32, speed);
            let expected = float.friction(root, state.sliding_speed_m_s);
            for (input, (&a, &b)) in found.iter().zip(&expected).enumerate() {
                prop_assert!(close(a, b), "input {}: {} for {}", input, a, b * f32::from(FULL_SCALE));
            }
        }
    }
}
