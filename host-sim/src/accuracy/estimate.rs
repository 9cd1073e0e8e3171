//! The estimator behind its sensors: its force and torque against the bench's, beside other laws on the same signals.
//!
//! The run is the analytic law's, sampled at the controller's rate and read through the noisy sensors. The estimator
//! conditions them; on the contact that comes out, three things are evaluated: the quantised networks (the estimator's own
//! estimate), the float networks, and the analytic law itself. So the law's error is that of the signals alone, and what
//! the networks do better or worse is theirs. Errors count from the end of the load's ramp on.

use super::conditions::{Condition, LawRun};
use crate::error::CliError;
use crate::estimator::controller_configuration;
use crate::force::SAMPLE_RATE_HZ;
use crate::same_signals::{self, Forces};
use crate::sensing;
use crate::summary::{peak, rms};
use bench::Bench;
use bench::transmission::{Snapshot, Transmission};
use firmware::flags::SENSOR_FAULT;
use inference::Flags;
use serde::Serialize;

/// One tick of the estimator beside the truth.
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Of the normal force, N.
    pub force_rms_n: f64,
    /// The same over the run's largest normal force.
    pub force_share: f64,
    /// Of the friction torque, N m.
    pub torque_rms_nm: f64,
    /// The same over the run's largest friction torque.
    pub torque_share: f64,
}

/// How the estimator did at a condition.
#[derive(Clone, Copy, Debug, Serialize)]
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
    /// The estimator behind perfect sensors: what remains are its delays and its networks.
    pub perfect_sensors: Errors,
    /// The law on the signals of perfect sensors: what remains are the delays.
    pub law_perfect_sensors: Errors,
    /// Share of the ticks outside the networks' training range.
    pub outside_training_share: f64,
    /// Share of the ticks that carry a sensor or timing flag.
    pub suspect_share: f64,
}

/// Lets the estimator follow the run with the law; without a seed its sensors are perfect.
pub fn follow(condition: &Condition, law: &LawRun, seed: Option<u64>) -> Result<Vec<Tick>, CliError> {
    let mut bench = law.bench.clone();
    if seed.is_none() {
        bench.sensors.clear();
    }
    let samples = &law.forced.run.samples;
    let plant = Transmission::new(&bench, bench.drive_profile(), bench.load_profile());
    let configuration = controller_configuration(&plant, &bench, SAMPLE_RATE_HZ)?;
    let seed = seed.unwrap_or_default().wrapping_add(condition.index);
    let start_s = bench.load.ramp_s;
    let frames = sensing::frames(&Bench::Transmission(Box::new(bench.clone())), samples, seed);
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
    /// Sums up what was followed behind noisy and behind perfect sensors.
    pub fn of(noisy: &[Tick], perfect: &[Tick]) -> Self {
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
            network: Errors::of(noisy, scales, |tick| tick.network),
            float_network: Errors::of(noisy, scales, |tick| tick.float_network),
            law: Errors::of(noisy, scales, |tick| tick.law),
            perfect_sensors: Errors::of(perfect, scales, |tick| tick.network),
            law_perfect_sensors: Errors::of(perfect, scales, |tick| tick.law),
            outside_training_share: share(Flags::OUTSIDE_TRAINING),
            suspect_share: share(SENSOR_FAULT),
        }
    }

    /// Whether the analytic law errs less than the networks on the same signals.
    pub fn law_wins(&self) -> bool {
        self.law.force_rms_n < self.network.force_rms_n
    }
}

impl Errors {
    fn of(ticks: &[Tick], [force_n, torque_nm]: [f64; 2], read: fn(&Tick) -> Forces) -> Self {
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
    use bench::transmission::BearingForces;

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
        let found = EstimateAccuracy::of(&noisy, &perfect);
        assert_eq!((found.force_full_scale_n, found.torque_full_scale_nm), (1000.0, 20.0));
        let expected = (0.5 * (30.0_f64.powi(2) + 40.0_f64.powi(2))).sqrt();
        assert!((found.network.force_rms_n - expected).abs() < 1e-9);
        assert!((found.network.force_share - expected / 1000.0).abs() < 1e-12);
        assert!((found.network.torque_rms_nm - 0.5_f64.sqrt()).abs() < 1e-9);
        assert!(found.law_wins() && found.perfect_sensors == Errors::default());
    }
}
