//! The checked configuration and the factors that a tick derives from it.

use core::ops::RangeInclusive;

use contact::FrictionLaw;
use inference::{BearingMaterial, Model, Sample};
use link::track::{MonitorConfiguration, MonitorField};
use link::{BenchConfiguration, ContactSource, Field, OutOfRange, Refusal, SensorFrame};
use model_package::WRONG_BEARING;

use super::envelope::Envelope;
use crate::filter::{
    FilterConfiguration, FilterError, FilterEstimate, FilterModel, Measurement, SensorNoise, Uncertainty,
};
use crate::integrity::words;

/// Metres in a nanometre, and radians in a nanoradian.
const NANO: f32 = 1e-9;

/// Sample periods that can be served, us: 50 us to 1 ms.
pub const SAMPLE_PERIOD_RANGE_US: RangeInclusive<i64> = 50..=1_000;

/// Returns every field of a bench with its value and its valid range.
///
/// | field | range |
/// |---|---|
/// | radial clearance | 1 um to 5 mm |
/// | journal radius | 1 mm to 1 m |
/// | sample period | [`SAMPLE_PERIOD_RANGE_US`] |
/// | latch floor | 100 um/s to 100 mm/s |
///
/// The networks are trained on a narrower range of clearances and flag the others.
#[must_use]
pub(crate) fn bench_ranges(bench: &BenchConfiguration) -> [(Field, i64, RangeInclusive<i64>); 5] {
    [
        (Field::Bearing, bench.bearing.into(), bearings()),
        (Field::RadialClearance, bench.radial_clearance_nm.into(), 1_000..=5_000_000),
        (Field::JournalRadius, bench.journal_radius_nm.into(), 1_000_000..=1_000_000_000),
        (Field::SamplePeriod, bench.sample_period_us.into(), SAMPLE_PERIOD_RANGE_US),
        (Field::LatchFloor, bench.latch_floor_um_s.into(), 100..=100_000),
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

/// Checked configuration: the filter's, and the factors of a tick.
#[derive(Clone, Debug)]
pub(super) struct Setup {
    pub(super) filter: FilterModel,
    pub(super) envelope: Envelope,
    pub(super) journal_radius_m: f32,
    pub(super) sample_period_us: u32,
    /// Angle reading with the drive crank vertical, nrad.
    crank_vertical_nrad: i32,
    /// True if the networks are the source of the contact, false if the law is.
    pub(super) uses_networks: bool,
    /// Normal force at which half of the networks' difference from the law is taken, N.
    pub(super) blend_n: f32,
}
words!(Setup {
    filter,
    envelope,
    journal_radius_m,
    sample_period_us,
    crank_vertical_nrad,
    uses_networks,
    blend_n
});

impl Setup {
    pub(super) fn new(
        image: &'static [u8],
        bench: &BenchConfiguration,
        monitor: &MonitorConfiguration,
    ) -> Result<(Self, Model<'static>), Refusal> {
        if let Some((field, found, range)) =
            bench_ranges(bench).into_iter().find(|(_, found, range)| !range.contains(found))
        {
            let (min, max) = range.into_inner();
            return Err(Refusal::Configuration(OutOfRange { field, found, min, max }.into()));
        }
        let bearing = bearing_of(bench)?;
        let model = Model::load(image).map_err(|error| Refusal::Image { cause: error.cause() })?;
        if model.header().bearing != bearing {
            return Err(Refusal::Image { cause: WRONG_BEARING });
        }
        let configuration = filter_configuration(bearing, bench, monitor);
        let setup = Self {
            filter: FilterModel::new(&configuration).map_err(|error| out_of_range(&error))?,
            envelope: Envelope::new(monitor),
            journal_radius_m: configuration.journal_radius_m,
            sample_period_us: bench.sample_period_us,
            crank_vertical_nrad: monitor.crank_vertical_nrad,
            uses_networks: bench.contact == ContactSource::Network,
            blend_n: blend_n(&model),
        };
        Ok((setup, model))
    }

    /// Takes over what depends on the model.
    pub(super) fn set_model(&mut self, model: &Model<'static>) {
        self.blend_n = blend_n(model);
    }

    /// Converts a calibrated sample. If the motion in it is not usable, the journal's position is
    /// NaN, which the filter leaves out.
    #[inline]
    pub(super) fn measurement(&self, frame: &SensorFrame, load_n: f32, is_usable: bool) -> Measurement {
        let angle_nrad = frame.shaft_angle_nrad.wrapping_sub(self.crank_vertical_nrad);
        Measurement {
            journal_y_m: if is_usable { frame.journal_y_nm as f32 * NANO } else { f32::NAN },
            journal_z_m: frame.journal_z_nm as f32 * NANO,
            shaft_angle_rad: angle_nrad as f32 * NANO,
            load_force_n: load_n,
            drive_force_n: None,
        }
    }

    /// Converts an estimate to the inputs of the networks; values beyond their integers saturate.
    #[inline]
    pub(super) fn sample(estimate: &FilterEstimate) -> Sample {
        Sample {
            radial_clearance_nm: (estimate.clearance_m * 1e9) as u32,
            deformation_pm: (estimate.deformation_m * 1e12) as i32,
            deformation_rate_nm_s: (estimate.deformation_rate_m_s * 1e9) as i32,
            approach_speed_nm_s: (estimate.approach_speed_m_s * 1e9) as u32,
            sliding_speed_nm_s: (estimate.sliding_speed_m_s * 1e9) as i32,
        }
    }
}

/// Share of the largest force of the training set at which half of the networks' difference from
/// the law is taken: several times their mean error.
const BLEND_SHARE: f32 = 0.01;

fn blend_n(model: &Model<'_>) -> f32 {
    let high_n = model.header().normal_force_high_mn as f32 * 1e-3;
    if high_n > 1.0 { BLEND_SHARE * high_n } else { BLEND_SHARE }
}

/// Returns the configuration of the filter for a bench.
pub fn filter_configuration(
    bearing: BearingMaterial,
    bench: &BenchConfiguration,
    monitor: &MonitorConfiguration,
) -> FilterConfiguration {
    let share = |per_mille: u16| f32::from(per_mille) * 1e-3;
    // A declared exactness is limited, so that the covariance stays positive.
    let positive = |value: f32, least: f32| if value > least { value } else { least };
    let damping_per_mille = match monitor.damping_per_mille {
        0 => bearing.damping_per_mille() as f32,
        given => f32::from(given),
    };
    FilterConfiguration {
        sample_period_s: bench.sample_period_us as f32 * 1e-6,
        mass_kg: monitor.mass_g as f32 * 1e-3,
        inertia_kg_m2: monitor.inertia_g_m2 as f32 * 1e-3,
        drive_lever_m: monitor.drive_lever_um as f32 * 1e-6,
        load_lever_m: monitor.load_lever_um as f32 * 1e-6,
        journal_radius_m: bench.journal_radius_nm as f32 * NANO,
        radial_clearance_m: bench.radial_clearance_nm as f32 * NANO,
        effective_modulus_pa: monitor.effective_modulus_kpa as f32 * 1e3,
        dissipation_factor: damping_per_mille * 1e-3,
        friction: friction(bearing, share(monitor.friction_level_per_mille)),
        latch_floor_m_s: bench.latch_floor_um_s as f32 * 1e-6,
        stroke_m: f32::from(monitor.stroke_mm) * 1e-3,
        period_s: f32::from(monitor.drive_period_ms) * 1e-3,
        noise: SensorNoise {
            position_m: f32::from(monitor.journal_noise_nm) * NANO,
            angle_rad: monitor.angle_noise_nrad as f32 * NANO,
            drive_force_n: 1.0,
        },
        uncertainty: Uncertainty {
            mass_share: share(monitor.mass_deviation_per_mille),
            inertia_share: share(monitor.inertia_deviation_per_mille),
            clearance_m: positive(monitor.clearance_deviation_nm as f32 * NANO, 1e-8),
            stiffness_share: positive(share(monitor.stiffness_deviation_per_mille), 1e-4),
            friction_share: positive(share(monitor.friction_deviation_per_mille), 1e-4),
            lever_share: f32::from(monitor.lever_deviation_ppht) * 1e-5,
        },
    }
}

/// Returns the friction law of a material at a level.
fn friction(bearing: BearingMaterial, level: f32) -> FrictionLaw<f32> {
    let law = bearing.friction_law();
    FrictionLaw {
        coulomb_coefficient: law.coulomb_coefficient as f32 * level,
        static_coefficient: law.static_coefficient as f32 * level,
        stribeck_speed_m_s: law.stribeck_speed_m_s as f32,
        shape: law.shape,
        viscous_slope_s_m: law.viscous_slope_s_m as f32 * level,
        viscous_onset_m_s: law.viscous_onset_m_s as f32,
        regularisation_m_s: law.regularisation_m_s as f32,
    }
}

/// Returns the refusal for a value that the filter does not accept: a stroke beyond the crank. The
/// ranges of the fields exclude every other.
fn out_of_range(error: &FilterError) -> Refusal {
    let millimetres = |value: f32| (value * 1e3) as i64;
    let (found, min, max) = (millimetres(error.found), millimetres(error.low), millimetres(error.high));
    let field = Field::Monitor(MonitorField::Stroke);
    Refusal::Configuration(OutOfRange { field, found, min, max }.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Estimator;
    use crate::configuration::BENCH_B;
    use inference::shipped;
    use link::Reasons;

    const GOOD: BenchConfiguration = BENCH_B.bench;

    fn refusal(bench: BenchConfiguration) -> Option<Refusal> {
        Estimator::new(shipped(BearingMaterial::Babbitt), &bench, &BENCH_B.monitor).err()
    }

    #[test]
    fn a_valid_configuration_is_accepted() {
        assert_eq!(refusal(GOOD), None);
    }

    #[test]
    fn values_out_of_range_are_refused_by_name_and_limits() {
        let out_of_range = |bench| match refusal(bench) {
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
    fn a_stroke_beyond_the_crank_is_refused() {
        let monitor = MonitorConfiguration { stroke_mm: 601, ..BENCH_B.monitor };
        let refusal = Estimator::new(shipped(BearingMaterial::Babbitt), &GOOD, &monitor).err();
        let reason = OutOfRange { field: Field::Monitor(MonitorField::Stroke), found: 601, min: 1, max: 600 };
        assert_eq!(refusal, Some(Refusal::Configuration(reason.into())));
    }

    #[test]
    fn images_that_are_damaged_or_for_the_other_bearing_are_refused() {
        assert_eq!(
            refusal(BenchConfiguration { bearing: 1, ..GOOD }),
            Some(Refusal::Image { cause: WRONG_BEARING })
        );
        let short = Estimator::new(&[1, 2, 3], &GOOD, &BENCH_B.monitor).err();
        assert_eq!(short, Some(Refusal::Image { cause: 3 }));
    }
}
