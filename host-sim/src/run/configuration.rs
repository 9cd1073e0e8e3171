//! Configuration of a controller for a bench, as a user would set it.

use crate::cli::error::CliError;
use bench::Channel;
use bench::description::TransmissionBench;
use bench::plants::transmission::Transmission;
use contact::{Dissipation, Material, effective_modulus_pa};
use link::track::MonitorConfiguration;
use link::{BenchConfiguration, ContactSource, ControllerConfiguration};

/// Converts a value to a count of units, at most the largest of its type.
fn count(value: f64, unit: f64) -> u32 {
    // `as` saturates.
    (value / unit).round() as u32
}

/// The same with 16 bits.
fn short(value: f64, unit: f64) -> u16 {
    (value / unit).round() as u16
}

/// Returns the part of the configuration that describes bearing and samples.
fn bench_configuration(
    plant: &Transmission,
    bench: &TransmissionBench,
    rate_hz: f64,
    contact: ContactSource,
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
        contact,
    })
}

/// Returns the noise of a described sensor: white noise and resolution.
fn noise(bench: &TransmissionBench, channel: Channel) -> f64 {
    let sensor = bench.common.sensors.get(&channel).copied().unwrap_or_default();
    sensor.noise.hypot(sensor.resolution / 12.0_f64.sqrt())
}

/// Returns the complete configuration for a bench; limits and calibration have their defaults.
///
/// # Errors
///
/// A value of the description is out of the configuration's range.
pub fn controller_configuration(
    plant: &Transmission,
    bench: &TransmissionBench,
    rate_hz: f64,
    contact: ContactSource,
) -> Result<ControllerConfiguration, CliError> {
    let configuration = bench_configuration(plant, bench, rate_hz, contact)?;
    let max_s = f64::from(u16::MAX) * 1e-3;
    if bench.drive.period_s > max_s {
        let found = bench.drive.period_s;
        return Err(CliError::Input(format!("drive.period_s: found {found}; expected at most {max_s}")));
    }
    let bearing = Material::new(bench.bearing.youngs_modulus_pa, bench.bearing.poisson_ratio)
        .map_err(|e| CliError::Input(format!("bearing: {e}")))?;
    let declared = |name: &str| bench.common.uncertain.get(name).copied().unwrap_or_default();
    let share = |name: &str, value: f64| declared(name) / value;
    let lever = share("geometry.drive_lever_radius_m", bench.geometry.drive_lever_radius_m)
        .max(share("geometry.load_lever_radius_m", bench.geometry.load_lever_radius_m));
    let position_m = noise(bench, Channel::JournalY).max(noise(bench, Channel::JournalZ));
    let monitor = MonitorConfiguration {
        mass_g: count(bench.shaft.mass_kg, 1e-3),
        inertia_g_m2: count(bench.shaft.inertia_kg_m2, 1e-3),
        drive_lever_um: count(bench.geometry.drive_lever_radius_m, 1e-6),
        load_lever_um: count(bench.geometry.load_lever_radius_m, 1e-6),
        effective_modulus_kpa: count(effective_modulus_pa(&bearing, &Material::STEEL), 1e3),
        damping_per_mille: short(Dissipation::ZhiyingQishao.factor(bench.bearing.restitution), 1e-3),
        stiffness_deviation_per_mille: short(
            share("bearing.youngs_modulus_pa", bench.bearing.youngs_modulus_pa),
            1e-3,
        ),
        inertia_deviation_per_mille: short(share("shaft.inertia_kg_m2", bench.shaft.inertia_kg_m2), 1e-3),
        mass_deviation_per_mille: short(share("shaft.mass_kg", bench.shaft.mass_kg), 1e-3),
        lever_deviation_ppht: short(lever, 1e-5),
        clearance_deviation_nm: count(declared("bearing.radial_clearance_m"), 1e-9),
        friction_deviation_per_mille: short(share("friction.level", bench.friction.level), 1e-3),
        friction_level_per_mille: short(bench.friction.level, 1e-3),
        stroke_mm: short(bench.drive.stroke_m, 1e-3).max(1),
        drive_period_ms: short(bench.drive.period_s, 1e-3),
        // A sample has steps of a nanometre and a nanoradian.
        journal_noise_nm: short(position_m, 1e-9).max(1),
        angle_noise_nrad: count(noise(bench, Channel::ShaftAngle), 1e-9).max(100),
        ..controller::configuration::BENCH_B.monitor
    };
    Ok(ControllerConfiguration::new(configuration, monitor))
}

/// Returns the configuration for a host that waits for each estimate: late ones are marked and
/// counted, but do not trip the controller.
///
/// # Errors
///
/// A value of the description is out of the configuration's range.
pub fn lockstep_configuration(
    plant: &Transmission,
    bench: &TransmissionBench,
    rate_hz: f64,
    contact: ContactSource,
) -> Result<ControllerConfiguration, CliError> {
    let mut configuration = controller_configuration(plant, bench, rate_hz, contact)?;
    configuration.limits.deadline_trip_count = 0;
    Ok(configuration)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_period_that_the_controller_cannot_hold_is_an_error_and_not_another_period() {
        let configured = |period_s: f64| {
            let mut bench = TransmissionBench::open("bench-b").expect("a preset");
            bench.drive.period_s = period_s;
            let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
            controller_configuration(&plant, &bench, 1e4, ContactSource::Law)
        };
        assert_eq!(configured(65.0).expect("a configuration").monitor.drive_period_ms, 65_000);
        let error = configured(66.0).expect_err("too long").to_string();
        assert!(error.contains("drive.period_s: found 66"), "{error}");
    }

    #[test]
    fn a_host_that_waits_for_each_estimate_trips_no_controller() {
        let bench = TransmissionBench::open("bench-b").expect("a preset");
        let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
        let waits = lockstep_configuration(&plant, &bench, 1e4, ContactSource::Law).expect("a configuration");
        assert_eq!(waits.limits.deadline_trip_count, 0);
        let mut paced =
            controller_configuration(&plant, &bench, 1e4, ContactSource::Law).expect("a configuration");
        assert_ne!(paced.limits.deadline_trip_count, 0);
        paced.limits.deadline_trip_count = 0;
        assert_eq!(waits, paced, "nothing else differs");
    }
}
