//! Offset and gain of every channel, in fixed point, without a branch on data.
//!
//! `true = (raw - offset) * gain`, with 30 fraction bits in the gain and the result rounded to the
//! nearest unit. Gain 1 and offset 0 leave every code unchanged. Results beyond an `i32`
//! saturate. The shaft angle is known modulo 2^32 nrad only, which is not compatible with a gain.
//! Therefore its steps are multiplied and summed, so that nothing jumps when the code wraps around.

use crate::integrity::{Words, words};
use fixed::types::{I34F30, U2F30};
use link::crc32::Digest;
use link::track::CHANNELS;
use link::{Calibration, SensorFrame};

const HALF: I34F30 = I34F30::lit("0.5");

/// Applies a calibration.
#[derive(Clone, Debug)]
pub(crate) struct Calibrator {
    config: Config,
    angle: AngleState,
}

/// Offsets and gains.
#[derive(Clone, Debug)]
struct Config {
    offsets: [i32; CHANNELS],
    gains: [U2F30; CHANNELS],
}
words!(Config { offsets, gains });

/// State of the angle.
#[derive(Clone, Debug, Default)]
struct AngleState {
    /// Code of the last sample less the offset.
    code: i32,
    /// Sum of the calibrated steps, nrad.
    sum: I34F30,
}

impl Calibrator {
    /// Adds offsets and gains to the CRC of the configuration.
    pub(crate) fn add_config_to(&self, crc: &mut Digest) {
        self.config.add_to(crc);
    }

    /// Takes the calibration of all channels.
    #[must_use]
    pub(crate) fn new(calibration: &[Calibration; CHANNELS]) -> Self {
        let gain = |channel: &Calibration| {
            let scaled = (u64::from(channel.gain_ppm) << U2F30::FRAC_NBITS).wrapping_add(500_000) / 1_000_000;
            U2F30::from_bits(u32::try_from(scaled).unwrap_or(u32::MAX))
        };
        let [y, z, angle, load] = calibration;
        Self {
            config: Config {
                offsets: [y.offset, z.offset, angle.offset, load.offset],
                gains: [gain(y), gain(z), gain(angle), gain(load)],
            },
            angle: AngleState::default(),
        }
    }

    /// Returns the calibrated frame.
    pub(crate) fn apply(&mut self, frame: &SensorFrame) -> SensorFrame {
        let Self { config, angle: state } = self;
        let [y, z, angle, load] = config.offsets;
        let [y_gain, z_gain, angle_gain, load_gain] = config.gains;
        let code = frame.shaft_angle_nrad.wrapping_sub(angle);
        let step = code.wrapping_sub(state.code);
        state.code = code;
        state.sum = state.sum.wrapping_add(product(step, angle_gain));
        SensorFrame {
            journal_y_nm: scaled(frame.journal_y_nm, y, y_gain),
            journal_z_nm: scaled(frame.journal_z_nm, z, z_gain),
            shaft_angle_nrad: state.sum.wrapping_add(HALF).wrapping_to_num(),
            load_force_mn: scaled(frame.load_force_mn, load, load_gain),
            ..*frame
        }
    }
}

fn scaled(raw: i32, offset: i32, gain: U2F30) -> i32 {
    let rounded: i64 = product(raw.saturating_sub(offset), gain).wrapping_add(HALF).wrapping_to_num();
    // Not `saturating_to_num`, which branches on the data.
    rounded.clamp(i32::MIN.into(), i32::MAX.into()) as i32
}

/// Returns the exact product.
fn product(value: i32, gain: U2F30) -> I34F30 {
    I34F30::from_bits(i64::from(value).wrapping_mul(gain.to_bits().into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn frame(code: i32) -> SensorFrame {
        SensorFrame {
            sequence: 1,
            time_us: 2,
            journal_y_nm: code,
            journal_z_nm: code,
            shaft_angle_nrad: code,
            load_force_mn: code,
        }
    }

    proptest! {
        #[test]
        fn no_calibration_changes_nothing(codes in prop::collection::vec(any::<i32>(), 1..50)) {
            let mut calibrator = Calibrator::new(&[Calibration::NONE; CHANNELS]);
            for code in codes {
                prop_assert_eq!(calibrator.apply(&frame(code)), frame(code));
            }
        }

        #[test]
        fn a_calibrated_code_is_off_by_at_most_half_a_unit(
            code in -1_000_000..1_000_000_i32,
            offset in -5_000_000..5_000_000_i32,
            gain_ppm in 500_000..2_000_000_u32,
        ) {
            let mut calibrator = Calibrator::new(&[Calibration { offset, gain_ppm }; CHANNELS]);
            let applied = calibrator.apply(&frame(code));
            let exact = f64::from(code - offset) * f64::from(gain_ppm) * 1e-6;
            let values =
                [applied.journal_y_nm, applied.journal_z_nm, applied.shaft_angle_nrad, applied.load_force_mn];
            for value in values {
                // The error of a gain is at most 2^-31.
                prop_assert!((f64::from(value) - exact).abs() <= 0.51, "{} {}", value, exact);
            }
        }
    }

    #[test]
    fn the_angle_is_continuous_where_its_code_wraps_around() {
        let calibration = Calibration { offset: 1_000, gain_ppm: 1_200_000 };
        let mut calibrator = Calibrator::new(&[calibration; CHANNELS]);
        let mut code = i32::MAX - 1_000_000;
        let mut last = calibrator.apply(&frame(code)).shaft_angle_nrad;
        for _ in 0..100 {
            code = code.wrapping_add(30_000);
            let angle = calibrator.apply(&frame(code)).shaft_angle_nrad;
            assert_eq!(angle.wrapping_sub(last), 36_000);
            last = angle;
        }
    }

    #[test]
    fn beyond_the_ends_a_value_stays_at_the_end() {
        let mut calibrator = Calibrator::new(&[Calibration { offset: -5, gain_ppm: 2_000_000 }; CHANNELS]);
        assert_eq!(calibrator.apply(&frame(i32::MAX)).journal_y_nm, i32::MAX);
        assert_eq!(calibrator.apply(&frame(i32::MIN)).journal_z_nm, i32::MIN);
    }
}
