//! Validation of every field before anything changes.

use core::ops::RangeInclusive;

use link::track::SensorChannel;
use link::{CONFIGURATION_VERSION, ControllerConfiguration, Field, OutOfRange, Reasons};

use super::wiring;
use crate::estimator::bench_ranges;
use crate::monitor::ranges;

/// Offsets of a journal coordinate, nm: mounting tolerance of a probe, 10 mm.
const JOURNAL_OFFSET_RANGE_NM: RangeInclusive<i64> = -10_000_000..=10_000_000;
/// Offsets of the other channels: any.
const OFFSET_RANGE: RangeInclusive<i64> = i32::MIN as i64..=i32::MAX as i64;
/// Gains, millionths: one half to two.
const GAIN_RANGE_PPM: RangeInclusive<i64> = 500_000..=2_000_000;
/// Force limits, N: none, or up to 1 MN.
const FORCE_LIMIT_RANGE_N: RangeInclusive<i64> = 0..=1_000_000;
/// Limits of the friction level, thousandths: none, or up to 65 times the described friction.
const FRICTION_LEVEL_LIMIT_RANGE_PER_MILLE: RangeInclusive<i64> = 0..=u16::MAX as i64;
/// Consecutive late estimates that trip the controller: never, or up to 10,000.
const DEADLINE_TRIP_RANGE: RangeInclusive<i64> = 0..=10_000;
/// Number of equal codes after which a sensor counts as stuck. Fewer than 10 occur at standstill.
const STUCK_RANGE_SAMPLES: RangeInclusive<i64> = 10..=10_000;
/// Samples between frames of slow telemetry: none, or at least 10.
const SLOW_EVERY_RANGE: RangeInclusive<i64> = 10..=u16::MAX as i64;

/// Accepts a configuration, or returns every reason against it.
///
/// # Errors
///
/// Fields are out of range.
pub fn validate(configuration: &ControllerConfiguration) -> Result<(), Reasons> {
    let mut reasons = Reasons::default();
    let mut check = |field, found: i64, range: RangeInclusive<i64>| {
        if !range.contains(&found) {
            reasons.add(OutOfRange { field, found, min: *range.start(), max: *range.end() });
        }
    };
    let version = i64::from(CONFIGURATION_VERSION);
    check(Field::Version, configuration.version.into(), version..=version);
    for (field, found, range) in bench_ranges(&configuration.bench) {
        check(field, found, range);
    }
    for (channel, calibration) in SensorChannel::ALL.into_iter().zip(&configuration.calibration) {
        let offsets = match channel {
            SensorChannel::JournalY | SensorChannel::JournalZ => JOURNAL_OFFSET_RANGE_NM,
            SensorChannel::ShaftAngle | SensorChannel::LoadForce => OFFSET_RANGE,
        };
        check(Field::Offset(channel), calibration.offset.into(), offsets);
        check(Field::Gain(channel), calibration.gain_ppm.into(), GAIN_RANGE_PPM);
    }
    for (field, found, range) in ranges(&configuration.monitor) {
        check(Field::Monitor(field), found, range);
    }
    let limits = &configuration.limits;
    check(Field::ForceLimit, limits.force_limit_n.into(), FORCE_LIMIT_RANGE_N);
    check(
        Field::FrictionLevelLimit,
        limits.friction_level_limit_per_mille.into(),
        FRICTION_LEVEL_LIMIT_RANGE_PER_MILLE,
    );
    check(Field::DeadlineTripCount, limits.deadline_trip_count.into(), DEADLINE_TRIP_RANGE);
    check(Field::StuckSamples, limits.stuck_samples.into(), STUCK_RANGE_SAMPLES);
    if limits.slow_every != 0 {
        check(Field::SlowEvery, limits.slow_every.into(), SLOW_EVERY_RANGE);
    }
    for (field, found, range) in wiring::ranges(&configuration.wiring) {
        check(Field::Wiring(field), found, range);
    }
    if reasons.count == 0 { Ok(()) } else { Err(reasons) }
}
