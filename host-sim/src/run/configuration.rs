//! Configuration of a controller for a bench, as a user would set it.

use crate::cli::error::CliError;
use bench::description::TransmissionBench;
use bench::plants::transmission::Transmission;
use contact::{Dissipation, Material, effective_modulus_pa};
use link::track::MonitorConfiguration;
use link::{BenchConfiguration, ControllerConfiguration};

/// Returns the controller's configuration for a bench: nominal values, as a user would set them.
pub fn estimator_configuration(
    plant: &Transmission,
    bench: &TransmissionBench,
    rate_hz: f64,
) -> Result<BenchConfiguration, CliError> {
    let counts = |field: &str, value: f64, unit: f64| {
        let count = (value / unit).round();
        if (1.0..=f64::from(u32::MAX)).contains(&count) {
            Ok(count as u32)
        } else {
            Err(CliError::Input(format!(
                "{field}: found {value}; expected 1 to {} units of {unit}",
                u32::MAX
            )))
        }
    };
    Ok(BenchConfiguration {
        bearing: bench.bearing.material.code(),
        radial_clearance_nm: counts("bearing.radial_clearance_m", plant.radial_clearance_m(), 1e-9)?,
        journal_radius_nm: counts("journal radius", plant.journal_radius_m(), 1e-9)?,
        sample_period_us: counts("sample period", 1.0 / rate_hz, 1e-6)?,
        latch_floor_um_s: counts("contact.latch_floor_m_s", bench.contact.latch_floor_m_s, 1e-6)?,
        // The windows are not yet full when the journal lands, so the controller needs the landing
        // speed.
        unseen_approach_um_s: counts("landing speed", plant.landing_speed_m_s(), 1e-6)?,
    })
}

/// Returns the complete configuration for a bench; limits and calibration have their defaults.
pub fn controller_configuration(
    plant: &Transmission,
    bench: &TransmissionBench,
    rate_hz: f64,
) -> Result<ControllerConfiguration, CliError> {
    let configuration = estimator_configuration(plant, bench, rate_hz)?;
    let default = controller::configuration::BENCH_B.monitor;
    let counts = |value: f64, unit: f64| (value / unit).round() as u32;
    let modulus_pa = |youngs_pa, poisson| {
        Material::new(youngs_pa, poisson).map(|bearing| effective_modulus_pa(&bearing, &Material::STEEL))
    };
    let modulus_pa = modulus_pa(bench.bearing.youngs_modulus_pa, bench.bearing.poisson_ratio)
        .map_err(|e| CliError::Input(format!("bearing: {e}")))?;
    let monitor = MonitorConfiguration {
        mass_g: counts(bench.shaft.mass_kg, 1e-3),
        inertia_g_m2: counts(bench.shaft.inertia_kg_m2, 1e-3),
        drive_lever_um: counts(bench.geometry.drive_lever_radius_m, 1e-6),
        load_lever_um: counts(bench.geometry.load_lever_radius_m, 1e-6),
        effective_modulus_kpa: counts(modulus_pa, 1e3),
        damping_per_mille: counts(Dissipation::ZhiyingQishao.factor(bench.bearing.restitution), 1e-3),
        ..default
    };
    Ok(ControllerConfiguration::new(configuration, monitor))
}
