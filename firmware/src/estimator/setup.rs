//! The configuration, checked and turned into the factors that a tick needs.

use core::ops::RangeInclusive;

use inference::{Bearing, ImageError, Model};
use link::{Configuration, Refusal};

use super::geometry::DISTANCE_STEPS_PER_NM;

/// Radial clearances that can be served, nm: 1 um to 5 mm. What the networks know is narrower; they flag the rest.
pub const CLEARANCE_RANGE_NM: RangeInclusive<u32> = 1_000..=5_000_000;
/// Journal radii that can be served, nm: 1 mm to 1 m.
pub const JOURNAL_RADIUS_RANGE_NM: RangeInclusive<u32> = 1_000_000..=1_000_000_000;
/// Sample periods that can be served, us: 50 us to 1 ms. The window is chosen for 100 us.
pub const SAMPLE_PERIOD_RANGE_US: RangeInclusive<u32> = 50..=1_000;
/// Latch floors and assumed approach speeds that can be served, um/s: 1 um/s to 1 m/s.
pub const LATCH_FLOOR_RANGE_UM_S: RangeInclusive<u32> = 1..=1_000_000;

/// Factors of a tick.
#[derive(Clone, Debug)]
pub(super) struct Setup {
    pub(super) radial_clearance_nm: u32,
    /// The same in steps of the distance.
    pub(super) radial_clearance: i32,
    pub(super) journal_radius_m: f32,
    pub(super) latch_floor_nm_s: i32,
    pub(super) unseen_approach_nm_s: i32,
    /// The floor that the image applies inside.
    pub(super) image_floor_nm_s: u32,
}

impl Setup {
    pub(super) fn new(
        image: &'static [u8],
        configuration: Configuration,
    ) -> Result<(Self, Model<'static>), Refusal> {
        let Configuration {
            bearing: code,
            radial_clearance_nm,
            journal_radius_nm,
            sample_period_us,
            latch_floor_um_s,
            unseen_approach_um_s,
        } = configuration;
        let bearing = Bearing::from_code(code).ok_or(Refusal::UnknownBearing { found: code })?;
        within(&CLEARANCE_RANGE_NM, radial_clearance_nm, |found_nm, min_nm, max_nm| {
            Refusal::RadialClearance { found_nm, min_nm, max_nm }
        })?;
        within(&JOURNAL_RADIUS_RANGE_NM, journal_radius_nm, |found_nm, min_nm, max_nm| {
            Refusal::JournalRadius { found_nm, min_nm, max_nm }
        })?;
        within(&SAMPLE_PERIOD_RANGE_US, sample_period_us, |found_us, min_us, max_us| {
            Refusal::SamplePeriod { found_us, min_us, max_us }
        })?;
        within(&LATCH_FLOOR_RANGE_UM_S, latch_floor_um_s, |found_um_s, min_um_s, max_um_s| {
            Refusal::LatchFloor { found_um_s, min_um_s, max_um_s }
        })?;
        within(&LATCH_FLOOR_RANGE_UM_S, unseen_approach_um_s, |found_um_s, min_um_s, max_um_s| {
            Refusal::UnseenApproach { found_um_s, min_um_s, max_um_s }
        })?;
        let model = Model::load(image).map_err(|error| Refusal::Image { cause: image_cause(&error) })?;
        if model.header().bearing != bearing {
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

fn within(
    range: &RangeInclusive<u32>,
    found: u32,
    refusal: impl Fn(u32, u32, u32) -> Refusal,
) -> Result<(), Refusal> {
    if range.contains(&found) { Ok(()) } else { Err(refusal(found, *range.start(), *range.end())) }
}

const WRONG_BEARING: u8 = 100;

/// The cause of a refused image as one byte for the wire: the position in [`ImageError`]'s list; 100 is a sound image of
/// another bearing.
#[must_use]
pub const fn image_cause(error: &ImageError) -> u8 {
    match error {
        ImageError::Length { .. } => 0,
        ImageError::Magic => 1,
        ImageError::Version { .. } => 2,
        ImageError::TooShort => 3,
        ImageError::Crc { .. } => 4,
        ImageError::Bearing { .. } => 5,
        ImageError::Shape { .. } => 6,
        ImageError::Field { .. } => 7,
        ImageError::Overflow { .. } => 8,
        ImageError::Scale { .. } => 9,
        ImageError::Alignment => 10,
        ImageError::Trailing => 11,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Estimator;
    use inference::shipped;

    const GOOD: Configuration = Configuration {
        bearing: 0,
        radial_clearance_nm: 500_000,
        journal_radius_nm: 69_500_000,
        sample_period_us: 100,
        latch_floor_um_s: 1_000,
        unseen_approach_um_s: 1_000,
    };

    fn refusal(configuration: Configuration) -> Option<Refusal> {
        Estimator::new(shipped(Bearing::Babbitt), configuration).err()
    }

    #[test]
    fn a_good_configuration_is_taken() {
        assert_eq!(refusal(GOOD), None);
    }

    #[test]
    fn values_out_of_range_are_refused_by_name_and_limits() {
        let clearance = Configuration { radial_clearance_nm: 999, ..GOOD };
        let expected = Refusal::RadialClearance { found_nm: 999, min_nm: 1_000, max_nm: 5_000_000 };
        assert_eq!(refusal(clearance), Some(expected));
        let radius = Configuration { journal_radius_nm: 0, ..GOOD };
        assert!(matches!(refusal(radius), Some(Refusal::JournalRadius { found_nm: 0, .. })));
        for sample_period_us in [0, 49, 1_001, u32::MAX] {
            let period = Configuration { sample_period_us, ..GOOD };
            assert!(matches!(refusal(period), Some(Refusal::SamplePeriod { .. })));
        }
        let floor = Configuration { latch_floor_um_s: 0, ..GOOD };
        assert!(matches!(refusal(floor), Some(Refusal::LatchFloor { found_um_s: 0, .. })));
        assert_eq!(refusal(Configuration { bearing: 9, ..GOOD }), Some(Refusal::UnknownBearing { found: 9 }));
    }

    #[test]
    fn images_that_are_damaged_or_for_the_other_bearing_are_refused() {
        assert_eq!(
            refusal(Configuration { bearing: 1, ..GOOD }),
            Some(Refusal::Image { cause: WRONG_BEARING })
        );
        let short = Estimator::new(&[1, 2, 3], GOOD).err();
        assert_eq!(short, Some(Refusal::Image { cause: 3 }));
    }
}
