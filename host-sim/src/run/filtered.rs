//! The Kalman filter on the sensor samples of a run, beside the controller.
//!
//! It runs in this process: the controller's tick does not contain the filter yet. The
//! configuration follows from the bench's description, with its sensors and declared deviations.

use crate::cli::error::CliError;
use crate::run::force::SAMPLE_RATE_HZ;
use crate::run::sensing::Sampled;
use crate::run::summary::{after_start, rms};
use bench::Channel;
use bench::description::TransmissionBench;
use bench::plants::transmission::{Snapshot, Transmission};
use contact::{Dissipation, FrictionLaw, Material, effective_modulus_pa};
use controller::filter::{
    Filter, FilterConfiguration, FilterEstimate, Measurement, SensorNoise, Uncertainty,
};
use link::EstimateFrame;
use serde::Serialize;
use std::fmt::Write as _;

/// Name of the table of estimates.
pub(crate) const FILE_NAME: &str = "estimates.csv";

/// Errors of the filter in a run, after the start.
#[derive(Clone, Debug, Serialize)]
pub struct FilterSummary {
    /// Rms error of the force vector, N.
    pub force_rms_error_n: f64,
    /// Largest error of the force vector, N.
    pub force_max_error_n: f64,
    /// Rms error of the friction torque, N m.
    pub torque_rms_error_nm: f64,
    /// Share of the samples whose error of the force is within two reported deviations.
    pub inside_2sd: f64,
    /// Tracked clearance at the end, m.
    pub clearance_m: f64,
    /// Its standard deviation, m.
    pub clearance_sd_m: f64,
    /// Tracked stiffness at the end, as a multiple of the described one.
    pub stiffness_factor: f64,
    /// Its standard deviation.
    pub stiffness_sd: f64,
    /// Tracked friction at the end, as a multiple of the described one.
    pub friction_factor: f64,
    /// Its standard deviation.
    pub friction_sd: f64,
    /// Share of the samples in which the innovations are larger than model and sensors explain.
    pub unfit_share: f64,
}

impl FilterSummary {
    /// Compares estimates with a run; `None` without a sample after the start.
    pub(crate) fn new(
        bench: &TransmissionBench,
        truth: &[Snapshot],
        estimates: &[FilterEstimate],
    ) -> Option<Self> {
        let counted = after_start(bench, truth);
        let estimates = estimates.get(truth.len() - counted.len()..)?;
        let last = estimates.last()?;
        let errors: Vec<f64> = estimates
            .iter()
            .zip(counted)
            .map(|(e, s)| (f64::from(e.force_y_n) - s.force_y_n).hypot(f64::from(e.force_z_n) - s.force_z_n))
            .collect();
        let torques = estimates
            .iter()
            .zip(counted)
            .map(|(e, s)| f64::from(e.friction_torque_nm) - s.friction_torque_nm);
        let share = |count: usize| count as f64 / errors.len() as f64;
        let is_inside = |(error, e): &(&f64, &FilterEstimate)| **error <= 2.0 * f64::from(e.force_sd_n);
        Some(Self {
            force_rms_error_n: rms(errors.iter().copied()),
            force_max_error_n: errors.iter().copied().fold(0.0, f64::max),
            torque_rms_error_nm: rms(torques),
            inside_2sd: share(errors.iter().zip(estimates).filter(is_inside).count()),
            clearance_m: last.clearance_m.into(),
            clearance_sd_m: last.clearance_sd_m.into(),
            stiffness_factor: last.stiffness_factor.into(),
            stiffness_sd: last.stiffness_sd.into(),
            friction_factor: last.friction_factor.into(),
            friction_sd: last.friction_sd.into(),
            unfit_share: share(estimates.iter().filter(|e| !e.fits).count()),
        })
    }
}

/// Follows the samples of a run. A sample with a channel that is missing or at its rail is
/// predicted.
///
/// # Errors
///
/// The description is outside the filter's range.
pub(crate) fn follow(
    bench: &TransmissionBench,
    samples: &[Sampled],
) -> Result<Vec<FilterEstimate>, CliError> {
    let configuration = configuration(bench, noise(bench), declared(bench))?;
    let mut filter = Filter::new(&configuration).map_err(|e| CliError::Input(format!("filter: {e}")))?;
    let estimate = |sampled: &Sampled| {
        let Sampled { frame, status } = sampled;
        let scaled = |count: i32, unit: f64| (f64::from(count) * unit) as f32;
        let is_intact = status.missing_bits() | status.rail_bits() == 0;
        filter.step(&Measurement {
            journal_y_m: if is_intact { scaled(frame.journal_y_nm, 1e-9) } else { f32::NAN },
            journal_z_m: scaled(frame.journal_z_nm, 1e-9),
            shaft_angle_rad: scaled(frame.shaft_angle_nrad, 1e-9),
            load_force_n: scaled(frame.load_force_mn, 1e-3),
            drive_force_n: None,
        })
    };
    Ok(samples.iter().map(estimate).collect())
}

/// Returns the noise of the described sensors: white noise and resolution.
fn noise(bench: &TransmissionBench) -> SensorNoise {
    let of = |channel: Channel| {
        let sensor = bench.common.sensors.get(&channel).copied().unwrap_or_default();
        sensor.noise.hypot(sensor.resolution / 12.0_f64.sqrt())
    };
    SensorNoise {
        // A sample has steps of a nanometre.
        position_m: of(Channel::JournalY).max(of(Channel::JournalZ)).max(1e-9) as f32,
        angle_rad: of(Channel::ShaftAngle).max(1e-7) as f32,
        drive_force_n: of(Channel::DriveForce).max(1e-2) as f32,
    }
}

/// Returns the declared deviations, with the smallest that the filter accepts for what is declared
/// as exact.
fn declared(bench: &TransmissionBench) -> Uncertainty {
    let of = |name: &str| bench.common.uncertain.get(name).copied().unwrap_or_default();
    let share = |name: &str, value: f64| of(name) / value;
    let lever = share("geometry.drive_lever_radius_m", bench.geometry.drive_lever_radius_m)
        .max(share("geometry.load_lever_radius_m", bench.geometry.load_lever_radius_m));
    Uncertainty {
        mass_share: share("shaft.mass_kg", bench.shaft.mass_kg) as f32,
        inertia_share: share("shaft.inertia_kg_m2", bench.shaft.inertia_kg_m2) as f32,
        clearance_m: of("bearing.radial_clearance_m").max(1e-8) as f32,
        stiffness_share: share("bearing.youngs_modulus_pa", bench.bearing.youngs_modulus_pa).max(1e-4) as f32,
        friction_share: share("friction.level", bench.friction.level).max(1e-4) as f32,
        lever_share: lever as f32,
    }
}

/// Returns the filter's configuration for a described bench.
///
/// # Errors
///
/// The material is impossible.
pub fn configuration(
    bench: &TransmissionBench,
    noise: SensorNoise,
    uncertainty: Uncertainty,
) -> Result<FilterConfiguration, CliError> {
    let plant = Transmission::new(bench, bench.drive_profile(), bench.load_profile());
    let elastic = Material::new(bench.bearing.youngs_modulus_pa, bench.bearing.poisson_ratio)
        .map_err(|e| CliError::Input(format!("bearing: {e}")))?;
    let law = bench.friction_law();
    Ok(FilterConfiguration {
        sample_period_s: (1.0 / SAMPLE_RATE_HZ) as f32,
        mass_kg: bench.shaft.mass_kg as f32,
        inertia_kg_m2: bench.shaft.inertia_kg_m2 as f32,
        drive_lever_m: bench.geometry.drive_lever_radius_m as f32,
        load_lever_m: bench.geometry.load_lever_radius_m as f32,
        journal_radius_m: plant.journal_radius_m() as f32,
        radial_clearance_m: plant.radial_clearance_m() as f32,
        effective_modulus_pa: effective_modulus_pa(&elastic, &Material::STEEL) as f32,
        dissipation_factor: Dissipation::ZhiyingQishao.factor(bench.bearing.restitution) as f32,
        friction: FrictionLaw {
            coulomb_coefficient: law.coulomb_coefficient as f32,
            static_coefficient: law.static_coefficient as f32,
            stribeck_speed_m_s: law.stribeck_speed_m_s as f32,
            shape: law.shape,
            viscous_slope_s_m: law.viscous_slope_s_m as f32,
            viscous_onset_m_s: law.viscous_onset_m_s as f32,
            regularisation_m_s: law.regularisation_m_s as f32,
        },
        latch_floor_m_s: bench.contact.latch_floor_m_s as f32,
        stroke_m: bench.drive.stroke_m as f32,
        period_s: bench.drive.period_s as f32,
        noise,
        uncertainty,
    })
}

/// Formats the estimates of filter and controller as CSV: a row for each sample.
///
/// Forces, deviations and factors are the filter's; `contact_angle_rad`, `flags`, `saturated` and
/// the columns that begin with `controller` are the controller's.
pub(crate) fn to_csv(estimates: &[FilterEstimate], frames: &[EstimateFrame]) -> String {
    let mut text = String::from(
        "sequence,t_s,normal_force_n,normal_force_sd_n,force_y_n,force_z_n,force_sd_n,friction_torque_nm,\
         friction_torque_sd_nm,deformation_m,clearance_m,clearance_sd_m,stiffness_factor,stiffness_sd,\
         friction_factor,friction_sd,fits,converging,contact_angle_rad,flags,saturated,\
         controller_normal_force_n,controller_force_y_n,controller_force_z_n,\
         controller_friction_torque_nm\n",
    );
    for (e, frame) in estimates.iter().zip(frames) {
        let numbers = [
            e.normal_force_n,
            e.normal_force_sd_n,
            e.force_y_n,
            e.force_z_n,
            e.force_sd_n,
            e.friction_torque_nm,
            e.friction_torque_sd_nm,
            e.deformation_m,
            e.clearance_m,
            e.clearance_sd_m,
            e.stiffness_factor,
            e.stiffness_sd,
            e.friction_factor,
            e.friction_sd,
        ];
        let controller = [frame.normal_force_n, frame.force_y_n, frame.force_z_n, frame.friction_torque_nm];
        // Writing to text does not fail.
        let _ = write!(text, "{},{:.6}", frame.sequence, f64::from(frame.time_us) * 1e-6);
        numbers.iter().for_each(|number| {
            let _ = write!(text, ",{number:e}");
        });
        let _ = write!(text, ",{},{}", u8::from(e.fits), u8::from(e.is_converging));
        let _ = write!(text, ",{:e},{},{}", frame.contact_angle_rad, frame.flags, frame.saturated);
        controller.iter().for_each(|number| {
            let _ = write!(text, ",{number:e}");
        });
        text.push('\n');
    }
    text
}
