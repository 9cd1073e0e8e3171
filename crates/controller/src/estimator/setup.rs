//! The checked configuration and the factors that a tick derives from it.

use core::ops::RangeInclusive;

use inference::{BearingMaterial, Model};
use link::{BenchConfiguration, Field, OutOfRange, Refusal};
use model_package::WRONG_BEARING;

use super::geometry::DISTANCE_STEPS_PER_NM;
use crate::integrity::words;

/// Sample periods that can be served, us: 50 us to 1 ms.
pub const SAMPLE_PERIOD_RANGE_US: RangeInclusive<i64> = 50..=1_000;

/// Returns every field of a bench with its value and its valid range.
///
/// | field | range |
/// |---|---|
/// | radial clearance | 1 um to 5 mm |
/// | journal radius | 1 mm to 1 m |
/// | sample period | [`SAMPLE_PERIOD_RANGE_US`]; the window is chosen for 100 us |
/// | latch floor, approach speed of an onset not seen | 1 um/s to 1 m/s |
///
/// The networks are trained on a narrower range of clearances and flag the others.
#[must_use]
pub fn bench_ranges(bench: &BenchConfiguration) -> [(Field, i64, RangeInclusive<i64>); 6] {
    let speeds = 1..=1_000_000;
    [
        (Field::Bearing, bench.bearing.into(), bearings()),
        (Field::RadialClearance, bench.radial_clearance_nm.into(), 1_000..=5_000_000),
        (Field::JournalRadius, bench.journal_radius_nm.into(), 1_000_000..=1_000_000_000),
        (Field::SamplePeriod, bench.sample_period_us.into(), SAMPLE_PERIOD_RANGE_US),
        (Field::LatchFloor, bench.latch_floor_um_s.into(), speeds.clone()),
        (Field::UnseenApproach, bench.unseen_approach_um_s.into(), speeds),
    ]
}

fn bearings() -> RangeInclusive<i64> {
    0..=BearingMaterial::ALL.iter().fold(0, |most, bearing| most.max(i64::from(bearing.code())))
}

/// Returns the bearing of a bench.
pub(crate) fn bearing_of(bench: &BenchConfiguration) -> Result<BearingMaterial, Refusal> {
    let (min, max) = bearings().into_inner();
    let reason = OutOfRange { field: Field::Bearing, found: bench.bearing.into(), min, max };
    BearingMaterial::from_code(bench.bearing).ok_or_else(|| Refusal::Configuration(reason.into()))
}

/// Factors of a tick, set by configuration and image.
#[derive(Clone, Debug)]
pub(super) struct Setup {
    pub(super) radial_clearance_nm: u32,
    /// The same in nm/16.
    pub(super) radial_clearance: i32,
    pub(super) journal_radius_m: f32,
    pub(super) latch_floor_nm_s: i32,
    pub(super) unseen_approach_nm_s: i32,
    /// Floor of the approach speed that the image applies.
    pub(super) image_floor_nm_s: u32,
}
words!(Setup {
    radial_clearance_nm,
    radial_clearance,
    journal_radius_m,
    latch_floor_nm_s,
    unseen_approach_nm_s,
    image_floor_nm_s,
});

impl Setup {
    pub(super) fn new(
        image: &'static [u8],
        configuration: BenchConfiguration,
    ) -> Result<(Self, Model<'static>), Refusal> {
        if let Some((field, found, range)) =
            bench_ranges(&configuration).into_iter().find(|(_, found, range)| !range.contains(found))
        {
            let (min, max) = range.into_inner();
            return Err(Refusal::Configuration(OutOfRange { field, found, min, max }.into()));
        }
        let BenchConfiguration {
            bearing: code,
            radial_clearance_nm,
            journal_radius_nm,
            latch_floor_um_s,
            unseen_approach_um_s,
            ..
        } = configuration;
        let model = Model::load(image).map_err(|error| Refusal::Image { cause: error.cause() })?;
        if model.header().bearing.code() != code {
            return Err(Refusal::Image { cause: WRONG_BEARING });
        }
        let steps = radial_clearance_nm.wrapping_mul(DISTANCE_STEPS_PER_NM.unsigned_abs());
        let speed_nm_s = |speed_um_s: u32| speed_um_s.wrapping_mul(1000).cast_signed();
        let setup = Self {
            radial_clearance_nm,
            radial_clearance: steps.cast_signed(),
            journal_radius_m: journal_radius_nm as f32 * 1e-9,
            latch_floor_nm_s: speed_nm_s(latch_floor_um_s),
            unseen_approach_nm_s: speed_nm_s(unseen_approach_um_s),
            image_floor_nm_s: model.header().latch_floor_nm_s,
        };
        Ok((setup, model))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Estimator;
    use inference::shipped;
    use link::Reasons;

    const GOOD: BenchConfiguration = BenchConfiguration {
        bearing: 0,
        radial_clearance_nm: 500_000,
        journal_radius_nm: 69_500_000,
        sample_period_us: 100,
        latch_floor_um_s: 1_000,
        unseen_approach_um_s: 1_000,
    };

    fn refusal(configuration: BenchConfiguration) -> Option<Refusal> {
        Estimator::new(shipped(BearingMaterial::Babbitt), configuration).err()
    }

    #[test]
    fn a_valid_configuration_is_accepted() {
        assert_eq!(refusal(GOOD), None);
    }

    #[test]
    fn values_out_of_range_are_refused_by_name_and_limits() {
        let out_of_range = |configuration| match refusal(configuration) {
            Some(Refusal::Configuration(Reasons { count: 1, first: [Some(reason), ..] })) => reason,
            other => panic!("{other:?}"),
        };
        let clearance = out_of_range(BenchConfiguration { radial_clearance_nm: 999, ..GOOD });
        let expected = OutOfRange { field: Field::RadialClearance, found: 999, min: 1_000, max: 5_000_000 };
        assert_eq!(clearance, expected);
        assert_eq!(
            out_of_range(BenchConfiguration { journal_radius_nm: 0, ..GOOD }).field,
            Field::JournalRadius
        );
        for sample_period_us in [0, 49, 1_001, u32::MAX] {
            let period = out_of_range(BenchConfiguration { sample_period_us, ..GOOD });
            assert_eq!((period.field, period.found), (Field::SamplePeriod, sample_period_us.into()));
        }
        assert_eq!(out_of_range(BenchConfiguration { latch_floor_um_s: 0, ..GOOD }).field, Field::LatchFloor);
        assert_eq!(out_of_range(BenchConfiguration { bearing: 9, ..GOOD }).found, 9);
    }

    #[test]
    fn images_that_are_damaged_or_for_the_other_bearing_are_refused() {
        assert_eq!(
            refusal(BenchConfiguration { bearing: 1, ..GOOD }),
            Some(Refusal::Image { cause: WRONG_BEARING })
        );
        let short = Estimator::new(&[1, 2, 3], GOOD).err();
        assert_eq!(short, Some(Refusal::Image { cause: 3 }));
    }
}
