//! Valid ranges of the monitor's configuration.

use core::ops::RangeInclusive;

use link::track::{MonitorConfiguration, MonitorField};

/// A field, its value and its valid range.
type Ranged = (MonitorField, i64, RangeInclusive<i64>);

/// Returns every field of a configuration with its value and valid range.
#[must_use]
pub fn ranges(monitor: &MonitorConfiguration) -> [Ranged; 29] {
    use MonitorField as Field;
    // More than half of a quantity is not an error but another bench.
    let per_mille = 0..=500;
    [
        // 1 kg to 100 t.
        (Field::Mass, monitor.mass_g.into(), 1_000..=100_000_000),
        (Field::Inertia, monitor.inertia_g_m2.into(), 1..=1_000_000_000),
        // 10 mm to 10 m.
        (Field::DriveLever, monitor.drive_lever_um.into(), 10_000..=10_000_000),
        (Field::LoadLever, monitor.load_lever_um.into(), 0..=10_000_000),
        // 10 MPa to 1 TPa.
        (Field::EffectiveModulus, monitor.effective_modulus_kpa.into(), 10_000..=1_000_000_000),
        (Field::Damping, monitor.damping_per_mille.into(), 0..=10_000),
        (Field::StiffnessDeviation, monitor.stiffness_deviation_per_mille.into(), per_mille.clone()),
        (Field::InertiaDeviation, monitor.inertia_deviation_per_mille.into(), per_mille.clone()),
        (Field::MassDeviation, monitor.mass_deviation_per_mille.into(), per_mille),
        (Field::LeverDeviation, monitor.lever_deviation_ppht.into(), 0..=10_000),
        (Field::ClearanceDeviation, monitor.clearance_deviation_nm.into(), 0..=1_000_000),
        (Field::FrictionDeviation, monitor.friction_deviation_per_mille.into(), 0..=500),
        (Field::FrictionLevel, monitor.friction_level_per_mille.into(), 100..=4_000),
        (Field::Stroke, monitor.stroke_mm.into(), 1..=20_000),
        (Field::DrivePeriod, monitor.drive_period_ms.into(), 50..=65_535),
        (Field::JournalNoise, monitor.journal_noise_nm.into(), 1..=8_000),
        (Field::AngleNoise, monitor.angle_noise_nrad.into(), 100..=10_000_000),
        // Below 16 units the limit is coarser than its steps.
        (Field::JournalNoiseLimit, monitor.journal_noise_limit_nm.into(), 16..=1_000_000),
        (Field::AngleNoiseLimit, monitor.angle_noise_limit_nrad.into(), 16..=1_000_000_000),
        (Field::LoadNoiseLimit, monitor.load_noise_limit_mn.into(), 16..=1_000_000_000),
        (Field::LoadStuckSamples, monitor.load_stuck_samples.into(), 0..=65_535),
        (Field::JournalRail, monitor.journal_rail_nm.into(), 1_000..=i64::from(i32::MAX)),
        (Field::LoadRail, monitor.load_rail_mn.into(), 1_000..=i64::from(i32::MAX)),
        (Field::EnvelopeShare, monitor.envelope_per_mille.into(), 10..=10_000),
        (Field::EnvelopeFloor, monitor.envelope_floor_n.into(), 0..=65_535),
        // The histories of both networks must have passed.
        (Field::RecoverySamples, monitor.recovery_samples.into(), 10..=65_535),
        (Field::LostSamples, monitor.lost_samples.into(), 1..=i64::from(u32::MAX - 1)),
        (Field::WearLimit, monitor.wear_limit_nm.into(), 1_000..=5_000_000),
        (Field::WearHysteresis, monitor.wear_hysteresis_nm.into(), 0..=1_000_000),
    ]
}
