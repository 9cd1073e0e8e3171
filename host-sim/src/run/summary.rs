//! The figures of a run, with the stable names of the machine-readable output.

use crate::fmu::plant_unit::PlantFigures;
use crate::run::estimator_summary::EstimatorSummary;
use crate::run::force::{ForceSource, ForcedRun, Tilt};
use crate::run::magnitude::{after_start, peak};
use crate::run::servo::ServoFigures;
use bench::BearingMaterial;
use bench::description::{FrictionSection, TransmissionBench};
use bench::integrate::Impact;
use bench::plants::transmission::Snapshot;
use bench::signals::Motion;
use bench::simulate::peaks::Peak;
use bench::simulate::settled::Settled;
use bench::statistics::{mean, rms};
use bench::sticking_plants;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Window of the moving mean that is subtracted before the oscillation is measured, s.
const OSCILLATION_MEAN_S: f64 = 0.020;
/// Window of the oscillation, in periods before and after the first sign change of the angular
/// acceleration.
const OSCILLATION_WINDOW: (f64, f64) = (0.02, 0.13);

/// Figures of a run, reproducible to the bit. Peaks count from the end of the load's ramp. Each has
/// a numerical error bar, see [`ForcedRun::peaks`]; none where the coarser runs failed.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema, Deserialize)]
pub struct Figures {
    /// Bearing material.
    #[schemars(with = "String")]
    pub bearing: BearingMaterial,
    /// Radial clearance, mm.
    pub clearance_mm: f64,
    /// Load along +Y, kN.
    pub load_kn: f64,
    /// Source of the bearing force.
    pub force: ForceSource,
    /// Largest normal force.
    pub peak_contact_force_n: f64,
    /// Largest force along Y by magnitude.
    pub peak_force_y_n: f64,
    /// Largest force along Z by magnitude.
    pub peak_force_z_n: f64,
    /// Largest friction torque by magnitude.
    pub peak_friction_torque_nm: f64,
    /// Largest deformation.
    pub max_deformation_m: f64,
    /// Rms of the contact force less its 20 ms moving mean, around the first sign change of the
    /// angular acceleration; null with the plant of another program.
    #[schemars(with = "Option<f64>")]
    pub oscillation_rms_n: f64,
    /// Number of contacts.
    pub contacts: usize,
    /// Sticking of the contact; absent with a friction law that does not stick.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sticking: Option<Sticking>,
    /// Energy residual relative to the drive's absolute work; none with the plant of another
    /// program.
    pub energy_residual_rel: Option<f64>,
    /// Share of the contact samples outside the networks' training range.
    pub outside_training_share: f64,
    /// Error bars of the peaks, in their units.
    pub error_bars: PerPeak,
    /// Times of the peaks, s.
    #[serde(default)]
    pub peak_times_s: PerPeak,
}

/// Number and duration of the times when a contact sticks, in a run with located events.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema, Deserialize)]
pub struct Sticking {
    /// Number of times.
    pub count: usize,
    /// Sum of the times, s.
    pub total_s: f64,
}

impl Sticking {
    /// Sums over the impacts; none with a friction law that does not stick.
    pub(crate) fn new(friction: Option<&FrictionSection>, impacts: &[Impact]) -> Option<Self> {
        sticking_plants(friction?.law?.0.entry().name)?;
        let count = impacts.iter().map(|impact| impact.sticks).sum();
        Some(Self { count, total_s: impacts.iter().map(|impact| impact.stuck_s).sum() })
    }
}

/// A number for each peak, under the names of the peaks; none where it is unknown.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema, Deserialize)]
pub struct PerPeak {
    /// Number of the normal force.
    pub peak_contact_force_n: Option<f64>,
    /// Number of the force along Y.
    pub peak_force_y_n: Option<f64>,
    /// Number of the force along Z.
    pub peak_force_z_n: Option<f64>,
    /// Number of the friction torque.
    pub peak_friction_torque_nm: Option<f64>,
    /// Number of the deformation.
    pub max_deformation_m: Option<f64>,
}

impl PerPeak {
    /// Reads a number of every peak. An infinite one is unknown.
    fn read(peaks: &[Peak], read: fn(&Peak) -> f64) -> Self {
        let of = |name: &str| peaks.iter().find(|p| p.name == name).map(read).filter(|v| v.is_finite());
        Self {
            peak_contact_force_n: of("peak_contact_force_n"),
            peak_force_y_n: of("peak_force_y_n"),
            peak_force_z_n: of("peak_force_z_n"),
            peak_friction_torque_nm: of("peak_friction_torque_nm"),
            max_deformation_m: of("max_deformation_m"),
        }
    }

    /// Describes the largest error bars of some runs.
    pub(crate) fn largest_bars<'a>(runs: impl Iterator<Item = &'a Figures> + Clone) -> String {
        let largest = |read: fn(&Self) -> Option<f64>, unit: f64| {
            let bar = runs.clone().map(|f| read(&f.error_bars)).try_fold(0.0_f64, |m, b| Some(m.max(b?)));
            bar.map_or_else(|| "unknown".into(), |bar| format!("{:.1e}", bar * unit))
        };
        format!(
            "numerical error bars of the peaks, the largest: contact force {} N, Y {} N, Z {} N, torque {} N \
             m, deformation {} um; from three tolerances, with networks from three communication steps",
            largest(|b| b.peak_contact_force_n, 1.0),
            largest(|b| b.peak_force_y_n, 1.0),
            largest(|b| b.peak_force_z_n, 1.0),
            largest(|b| b.peak_friction_torque_nm, 1.0),
            largest(|b| b.max_deformation_m, 1e6)
        )
    }
}

/// The figures of a run with wall time, energy balance, peaks, estimator and comparison with the
/// law.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Summary {
    /// Figures of the bench.
    #[serde(flatten)]
    pub figures: Figures,
    /// Relative tolerance of the run with the analytic law under error control; none with a held
    /// force. The peaks are read at a tighter one.
    pub tolerance: Option<f64>,
    /// Communication step of a held force, s; none with the analytic law under error control.
    pub communication_step_s: Option<f64>,
    /// Wall time of the bench alone, s.
    pub wall_s: f64,
    /// The same per simulated second.
    pub wall_s_per_simulated_s: f64,
    /// Terms of the energy balance in J, and its relative residual.
    pub energy: serde_json::Map<String, serde_json::Value>,
    /// The run's peaks with their error bars and times.
    pub peaks: Vec<PeakRow>,
    /// Peaks of the analytic law, if the run itself used networks.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub law_peaks: Vec<PeakRow>,
    /// The shaft's tilt, on a bench in two planes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt: Option<Tilt>,
    /// Position error of the rudder servo, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub servo: Option<ServoFigures>,
    /// Settled operation, of a run with at least three cycles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub settled: Option<Settled>,
    /// Unit of another program that was the plant.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plant: Option<PlantFigures>,
    /// Results of the estimator, if there was a controller.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub estimator: Option<EstimatorSummary>,
    /// Comparison with the analytic law, if the run itself used networks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against_law: Option<AgainstLaw>,
}

/// A peak for output.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct PeakRow {
    /// Name of the quantity, unit included.
    pub name: &'static str,
    /// Largest magnitude.
    pub value: f64,
    /// Error bar from the coarser runs; none if they failed.
    pub error_bar: Option<f64>,
    /// Time of the peak, s.
    pub time_s: f64,
}

impl From<&Peak> for PeakRow {
    fn from(&Peak { name, value, error_bar, time_s }: &Peak) -> Self {
        Self { name, value, error_bar: Some(error_bar).filter(|b| b.is_finite()), time_s }
    }
}

/// Difference between a run with networks and the run with the analytic law.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct AgainstLaw {
    /// Peak normal force with the law.
    pub peak_contact_force_n: f64,
    /// Rms difference of the normal force, after the start.
    pub force_rms_difference_n: f64,
    /// Rms difference of the journal's position, after the start.
    pub journal_rms_difference_m: f64,
}

impl Figures {
    /// Computes the figures of a run whose samples have the rate `rate_hz`.
    pub(crate) fn from_run(
        bench: &TransmissionBench,
        force: ForceSource,
        forced: &ForcedRun,
        rate_hz: f64,
    ) -> Self {
        let peak = |name: &str| forced.peaks.iter().find(|p| p.name == name);
        let value = |name: &str| peak(name).map_or(0.0, |p| p.value);
        Self {
            bearing: bench.bearing.material,
            clearance_mm: bench.bearing.radial_clearance_m * 1e3,
            load_kn: bench.load.force_n * 1e-3,
            force,
            peak_contact_force_n: value("peak_contact_force_n"),
            peak_force_y_n: value("peak_force_y_n"),
            peak_force_z_n: value("peak_force_z_n"),
            peak_friction_torque_nm: value("peak_friction_torque_nm"),
            max_deformation_m: value("max_deformation_m"),
            // Its window follows from the described drive.
            oscillation_rms_n: match &forced.plant {
                Some(_) => f64::NAN,
                None => oscillation_rms_n(bench, &forced.run.samples, rate_hz),
            },
            contacts: forced.run.impacts.len(),
            sticking: Sticking::new(Some(&bench.friction), &forced.run.impacts)
                .filter(|_| force == ForceSource::Law),
            energy_residual_rel: forced.plant.is_none().then_some(forced.run.energy_residual_rel),
            outside_training_share: forced.outside_training_share,
            error_bars: PerPeak::read(&forced.peaks, |p| p.error_bar),
            peak_times_s: PerPeak::read(&forced.peaks, |p| p.time_s),
        }
    }
}

impl AgainstLaw {
    /// Compares two runs sample by sample. The sample times of a run with a held force are rounded
    /// to communication steps, so the law's times define the end of the start.
    pub fn compare(bench: &TransmissionBench, run: &[Snapshot], law: &[Snapshot]) -> Self {
        let counted = after_start(bench, law);
        let run = run.get(law.len() - counted.len()..).unwrap_or_default();
        let law = counted;
        Self {
            peak_contact_force_n: peak(law, |s| s.forces.normal_n),
            force_rms_difference_n: rms(run
                .iter()
                .zip(law)
                .map(|(a, b)| a.forces.normal_n - b.forces.normal_n)),
            journal_rms_difference_m: rms(run
                .iter()
                .zip(law)
                .map(|(a, b)| (a.y_m - b.y_m).hypot(a.z_m - b.z_m))),
        }
    }
}

/// Angular acceleration of the crank with the journal centred, rad/s2.
pub(crate) fn ideal_angular_acceleration(bench: &TransmissionBench, time_s: f64) -> f64 {
    angular_acceleration(bench.geometry.drive_lever_radius_m, &bench.drive_profile().at(time_s))
}

/// Angular acceleration of a crank under a motion of the drive, rad/s2.
fn angular_acceleration(lever: f64, motion: &Motion) -> f64 {
    let sin = motion.value / lever;
    let cos = (1.0 - sin * sin).sqrt();
    let speed = motion.rate / (lever * cos);
    (motion.acceleration + lever * sin * speed * speed) / (lever * cos)
}

/// Times of the sign changes of the crank's angular acceleration in the first cycle, with the
/// journal centred, s.
pub(crate) fn acceleration_reversals_s(bench: &TransmissionBench) -> Vec<f64> {
    let step = bench.drive.period_s * 1e-4;
    // A random course is expensive to build, so it is built once.
    let drive = bench.drive_profile();
    let lever_m = bench.geometry.drive_lever_radius_m;
    let acceleration = |i: u32| angular_acceleration(lever_m, &drive.at(f64::from(i) * step));
    (1..10_000)
        .filter(|&i| acceleration(i) * acceleration(i - 1) < 0.0)
        .map(|i| f64::from(i) * step)
        .collect()
}

/// Time of the first of these sign changes, s.
fn first_acceleration_reversal_s(bench: &TransmissionBench) -> Option<f64> {
    acceleration_reversals_s(bench).first().copied()
}

/// Window in which the oscillation after a reversal is measured, s.
pub(crate) fn oscillation_window_s(bench: &TransmissionBench, reversal_s: f64) -> (f64, f64) {
    let period = bench.drive.period_s;
    (reversal_s - OSCILLATION_WINDOW.0 * period, reversal_s + OSCILLATION_WINDOW.1 * period)
}

fn oscillation_rms_n(bench: &TransmissionBench, samples: &[Snapshot], rate_hz: f64) -> f64 {
    first_acceleration_reversal_s(bench)
        .map_or(0.0, |reversal| fluctuation_rms_n(samples, rate_hz, oscillation_window_s(bench, reversal)))
}

/// Rms of the contact force less its 20 ms moving mean, between two times.
pub(crate) fn fluctuation_rms_n(samples: &[Snapshot], rate_hz: f64, (from_s, to_s): (f64, f64)) -> f64 {
    let half = (0.5 * OSCILLATION_MEAN_S * rate_hz).round() as usize;
    let low = samples.partition_point(|s| s.time_s < from_s);
    let high = samples.partition_point(|s| s.time_s <= to_s);
    rms((low..high).filter_map(|i| {
        let window = samples.get(i.checked_sub(half)?..=i + half)?;
        let mean = mean(window.iter().map(|s| s.forces.normal_n));
        Some(samples.get(i)?.forces.normal_n - mean)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::estimator_summary::Differences;
    use crate::run::force::run_bench;

    #[test]
    fn differences_are_those_of_force_and_torque() {
        let pairs = [[[10.0, 1.0], [7.0, 1.5]], [[0.0, -2.0], [4.0, -2.0]]];
        let found = Differences::from_pairs(pairs.into_iter());
        assert_eq!((found.force_max_n, found.torque_max_nm), (4.0, 0.5));
        assert!((found.force_rms_n - 12.5_f64.sqrt()).abs() < 1e-12);
        assert!((found.torque_rms_nm - 0.125_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_run_is_compared_with_the_law_sample_by_sample_at_any_step() {
        let bench = TransmissionBench::open("bench-b").unwrap();
        let law = run_bench(&bench, ForceSource::Law, 1e-5, || {}).unwrap();
        for step_s in [1e-5, 3e-6] {
            let held = run_bench(&bench, ForceSource::HeldLaw, step_s, || {}).unwrap();
            let found = AgainstLaw::compare(&bench, &held.run.samples, &law.run.samples);
            // A shift by one sample would give about 40 N and 2 um.
            assert!(found.force_rms_difference_n < 15.0, "{step_s}: {found:?}");
            assert!(found.journal_rms_difference_m < 8e-7, "{step_s}: {found:?}");
        }
    }

    #[test]
    fn the_reversal_and_the_oscillation_match_the_published_table() {
        for (material, rows) in [
            (BearingMaterial::Babbitt, [(0.1, 94.0), (0.25, 743.0), (0.5, 1034.0), (1.0, 1152.0)]),
            (BearingMaterial::Plastic, [(0.1, 189.0), (0.25, 378.0), (0.5, 523.0), (1.0, 526.0)]),
        ] {
            for (clearance_mm, expected) in rows {
                let mut bench = TransmissionBench::open("bench-b").unwrap();
                bench.set_material(material);
                bench.set_radial_clearance(clearance_mm * 1e-3);
                let reversals = acceleration_reversals_s(&bench);
                assert_eq!(reversals.len(), 2, "{reversals:?}");
                assert!((reversals[0] - 0.266).abs() < 5e-4 && (reversals[1] - 0.734).abs() < 5e-4);
                let forced = run_bench(&bench, ForceSource::Law, 1e-5, || {}).unwrap();
                let found = Figures::from_run(&bench, ForceSource::Law, &forced, 10_000.0).oscillation_rms_n;
                assert!(
                    (found / expected - 1.0).abs() < 0.02,
                    "{material:?} {clearance_mm} mm: {found} for {expected}"
                );
            }
        }
    }
}
