//! Configuration of the controller: validated completely ([`validate`]), applied to samples
//! ([`Calibrator`]), stored by [`crate::store::Keeper`] in its serialised form.

mod bench_b;
mod calibration;
mod validate;
mod wiring;

pub use bench_b::BENCH_B;
pub(crate) use calibration::Calibrator;
pub use validate::validate;
pub use wiring::wiring;

use link::{ControllerConfiguration, crc32};

/// Maximum length of the serialised form, bytes: that of the keeper's record.
const MAX_LENGTH: usize = crate::store::keeper::MAX_VALUE_LENGTH;

/// Returns the CRC-32 of a configuration's serialised form, which identifies it.
#[must_use]
pub fn checksum(configuration: &ControllerConfiguration) -> u32 {
    postcard::to_slice(configuration, &mut [0; MAX_LENGTH]).map_or(0, |bytes| crc32(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use link::track::{MonitorConfiguration, MonitorField, SensorChannel};
    use link::{BenchConfiguration, Calibration, Field, Limits, Reasons};
    use proptest::prelude::*;

    fn fields(reasons: &Reasons) -> Vec<Field> {
        reasons.iter().map(|reason| reason.field).collect()
    }

    #[test]
    fn the_example_is_accepted() {
        assert_eq!(validate(&BENCH_B), Ok(()));
        assert_ne!(checksum(&BENCH_B), 0);
    }

    #[test]
    fn every_reason_is_given_with_what_was_found_and_expected() {
        let mut bad = BENCH_B;
        bad.version = 9;
        bad.bench.sample_period_us = 10;
        bad.calibration[1].offset = 10_000_001;
        bad.calibration[3] = Calibration { offset: i32::MIN, gain_ppm: 400_000 };
        bad.monitor.mass_g = 0;
        bad.limits.slow_every = 9;
        let reasons = validate(&bad).unwrap_err();
        let expected = [
            Field::Version,
            Field::SamplePeriod,
            Field::Offset(SensorChannel::JournalZ),
            Field::Gain(SensorChannel::LoadForce),
            Field::Monitor(MonitorField::Mass),
            Field::SlowEvery,
        ];
        assert_eq!((fields(&reasons), reasons.count), (expected.to_vec(), 6));
        let period = reasons.iter().nth(1).unwrap();
        assert_eq!((period.found, period.min, period.max), (10, 50, 1_000));
    }

    #[test]
    fn a_configuration_without_a_valid_field_reports_as_many_reasons_as_fit() {
        let mut nothing = BENCH_B;
        nothing.bench = BenchConfiguration { bearing: 9, sample_period_us: 0, ..BENCH_B.bench };
        nothing.calibration = [Calibration { offset: i32::MAX, gain_ppm: 0 }; 4];
        nothing.limits = Limits { stuck_samples: 0, slow_every: 1, ..BENCH_B.limits };
        let zero: MonitorConfiguration = postcard::from_bytes(&[0; 64]).unwrap();
        nothing.monitor = zero;
        let reasons = validate(&nothing).unwrap_err();
        assert!(usize::from(reasons.count) > link::MAX_REASONS, "{}", reasons.count);
        assert_eq!(reasons.iter().count(), link::MAX_REASONS);
    }

    proptest! {
        #[test]
        fn zero_switches_reports_off_and_every_other_period_is_checked(
            slow_every in any::<u16>(),
            stuck in any::<u16>(),
        ) {
            let limits = Limits { slow_every, stuck_samples: stuck, ..BENCH_B.limits };
            let reasons = validate(&ControllerConfiguration { limits, ..BENCH_B }).err().unwrap_or_default();
            prop_assert_eq!(fields(&reasons).contains(&Field::SlowEvery), (1..10).contains(&slow_every));
            prop_assert_eq!(fields(&reasons).contains(&Field::StuckSamples), !(10..=10_000).contains(&stuck));
        }
    }
}
