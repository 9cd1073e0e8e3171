//! The estimator with noisy sensors: errors of its force and torque, compared with the law at the
//! same contact.
//!
//! The run uses the analytic law, is sampled at the controller's rate and read through noisy
//! sensors. The estimate is compared with the float networks and with the described law at the
//! contact that the filter has estimated. Both lack the factors that the filter has learnt. Errors
//! count from the end of the load's ramp on.

use super::conditions::{Condition, LawRun};
use crate::cli::error::CliError;
use crate::run::configuration::controller_configuration;
use crate::run::force::SAMPLE_RATE_HZ;
use crate::run::magnitude::peak;
use crate::run::same_signals::{self, Forces};
use crate::run::sensing;
use bench::Bench;
use bench::plants::transmission::{Snapshot, Transmission};
use bench::statistics::rms;
use controller::flags::SENSOR_FAULT;
use inference::Flags;
use link::ContactSource;
use schemars::JsonSchema;
use serde::Serialize;

/// One tick of the estimator with the true values.
#[derive(Clone, Copy, Debug)]
pub struct Tick {
    /// The bench.
    pub truth: Snapshot,
    /// The estimator's own estimate: quantised networks.
    pub network: Forces,
    /// Float networks on the estimator's signals.
    pub float_network: Forces,
    /// The analytic law on the estimator's signals.
    pub law: Forces,
    /// The estimate's flags.
    pub flags: Flags,
}

/// Rms errors of one source of forces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Errors {
    /// Rms error of the normal force, N.
    pub force_rms_n: f64,
    /// The same relative to the run's largest normal force.
    pub force_share: f64,
    /// Rms error of the friction torque, N m.
    pub torque_rms_nm: f64,
    /// The same relative to the run's largest friction torque.
    pub torque_share: f64,
}

/// Results of the estimator at a condition.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct EstimateAccuracy {
    /// Largest true normal force after the start.
    pub force_full_scale_n: f64,
    /// Largest true friction torque after the start.
    pub torque_full_scale_nm: f64,
    /// The estimator.
    pub network: Errors,
    /// Float networks on its signals.
    pub float_network: Errors,
    /// The analytic law on its signals.
    pub law: Errors,
    /// The estimator with perfect sensors: the rest is the error of its delays and networks.
    pub perfect_sensors: Errors,
    /// The law on the signals of perfect sensors: the rest is the error of the delays.
    pub law_perfect_sensors: Errors,
    /// Share of the ticks outside the networks' training range.
    pub outside_training_share: f64,
    /// Share of the ticks with a sensor or timing flag.
    pub suspect_share: f64,
}

/// Follows the run of the law with the estimator; without a seed the sensors are perfect, which the
/// estimator does not know.
pub fn follow(condition: &Condition, law: &LawRun, seed: Option<u64>) -> Result<Vec<Tick>, CliError> {
    let mut bench = law.bench.clone();
    if seed.is_none() {
        bench.common.sensors.clear();
    }
    let samples = &law.forced.run.samples;
    let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
    let configuration = controller_configuration(&plant, &law.bench, SAMPLE_RATE_HZ, ContactSource::Network)?;
    let seed = seed.unwrap_or_default().wrapping_add(condition.index);
    let start_s = bench.load.ramp_s;
    let frames = sensing::frames(&Bench::from(bench.clone()), samples, seed);
    let followed = same_signals::follow(&bench, &configuration, frames.into_iter())?;
    let ticks = followed.into_iter().zip(samples).map(|(on, truth)| Tick {
        truth: *truth,
        network: [f64::from(on.estimate.normal_force_n), f64::from(on.estimate.friction_torque_nm)],
        float_network: on.float_network,
        law: on.law,
        flags: Flags::from_bits(on.estimate.flags),
    });
    Ok(ticks.filter(|tick| tick.truth.time_s >= start_s).collect())
}

impl EstimateAccuracy {
    /// Evaluates the ticks with noisy and with perfect sensors.
    pub(crate) fn from_ticks(noisy: &[Tick], perfect: &[Tick]) -> Self {
        let truth: Vec<Snapshot> = noisy.iter().map(|tick| tick.truth).collect();
        let scales @ [force_n, torque_nm] =
            [peak(&truth, |s| s.forces.normal_n), peak(&truth, |s| s.friction_torque_nm)];
        let share = |flags: Flags| {
            let hits = noisy.iter().filter(|tick| tick.flags.intersects(flags)).count();
            hits as f64 / noisy.len().max(1) as f64
        };
        Self {
            force_full_scale_n: force_n,
            torque_full_scale_nm: torque_nm,
            network: Errors::from_ticks(noisy, scales, |tick| tick.network),
            float_network: Errors::from_ticks(noisy, scales, |tick| tick.float_network),
            law: Errors::from_ticks(noisy, scales, |tick| tick.law),
            perfect_sensors: Errors::from_ticks(perfect, scales, |tick| tick.network),
            law_perfect_sensors: Errors::from_ticks(perfect, scales, |tick| tick.law),
            outside_training_share: share(Flags::OUTSIDE_TRAINING),
            suspect_share: share(SENSOR_FAULT),
        }
    }

    /// Returns whether the analytic law has a smaller error than the networks on the same signals.
    pub fn law_wins(&self) -> bool {
        self.law.force_rms_n < self.network.force_rms_n
    }
}

impl Errors {
    fn from_ticks(ticks: &[Tick], [force_n, torque_nm]: [f64; 2], read: fn(&Tick) -> Forces) -> Self {
        let force_rms_n = rms(ticks.iter().map(|tick| read(tick)[0] - tick.truth.forces.normal_n));
        let torque_rms_nm = rms(ticks.iter().map(|tick| read(tick)[1] - tick.truth.friction_torque_nm));
        Self {
            force_rms_n,
            force_share: force_rms_n / force_n,
            torque_rms_nm,
            torque_share: torque_rms_nm / torque_nm,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bench::plants::transmission::BearingForces;

    fn tick(normal_n: f64, torque_nm: f64, network: Forces, law: Forces) -> Tick {
        let truth = Snapshot {
            forces: BearingForces { normal_n, friction_n: 0.0 },
            friction_torque_nm: torque_nm,
            ..Snapshot::default()
        };
        Tick { truth, network, float_network: network, law, flags: Flags::NONE }
    }

    #[test]
    fn errors_are_held_against_the_runs_own_full_scale() {
        let noisy = [
            tick(1000.0, -20.0, [1030.0, -19.0], [990.0, -20.0]),
            tick(200.0, 5.0, [160.0, 5.0], [200.0, 5.0]),
        ];
        let perfect = [tick(1000.0, -20.0, [1000.0, -20.0], [1000.0, -20.0])];
        let found = EstimateAccuracy::from_ticks(&noisy, &perfect);
        assert_eq!((found.force_full_scale_n, found.torque_full_scale_nm), (1000.0, 20.0));
        let expected = (0.5 * (30.0_f64.powi(2) + 40.0_f64.powi(2))).sqrt();
        assert!((found.network.force_rms_n - expected).abs() < 1e-9);
        assert!((found.network.force_share - expected / 1000.0).abs() < 1e-12);
        assert!((found.network.torque_rms_nm - 0.5_f64.sqrt()).abs() < 1e-9);
        assert!(found.law_wins() && found.perfect_sensors == Errors::default());
    }
}
