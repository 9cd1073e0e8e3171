//! Figures of the estimator in a run: its errors, its cost and the controller's counters.

use crate::controller::Losses;
use crate::run::exchange::ExchangeResult;
use crate::run::impacts::ImpactSummary;
use crate::run::magnitude::{after_start, peak};
use crate::run::same_signals::{Forces, OnSignals};
use bench::description::TransmissionBench;
use bench::integrate::Impact;
use bench::plants::transmission::Snapshot;
use bench::statistics::rms;
use controller::emulator::TICKS_PER_INSTRUCTION;
use controller::flags::{MODEL_MISFIT, SENSOR_FAULT};
use inference::Flags;
use link::{Counters, EstimateFrame};
use schemars::JsonSchema;
use serde::Serialize;

/// Results of the estimator.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct EstimatorSummary {
    /// Transport: `native`, `emulated` or `attached`.
    pub controller: &'static str,
    /// Rms error of the estimated normal force, after the start.
    pub force_rms_error_n: f64,
    /// Largest true normal force after the start: reference value of the error.
    pub force_full_scale_n: f64,
    /// Number of sensor frames.
    pub ticks: u64,
    /// Ticks that took longer than the sample period.
    pub deadline_misses: u64,
    /// Minimum instructions per tick; null unless the controller is emulated.
    pub instructions_per_tick_min: Option<u64>,
    /// Mean instructions per tick; null unless the controller is emulated.
    pub instructions_per_tick_mean: Option<f64>,
    /// Maximum instructions per tick; null unless the controller is emulated.
    pub instructions_per_tick_max: Option<u64>,
    /// Exchanged frames per second, there and back.
    pub exchanges_per_s: f64,
    /// Number of estimates that differ in any bit between the native and the emulated controller;
    /// null unless both ran.
    pub native_emulated_bit_differences: Option<u64>,
    /// The same for the attached controller.
    pub native_attached_bit_differences: Option<u64>,
    /// Figures of the estimate with its deviations, after the start.
    #[serde(flatten)]
    pub tracked: Tracked,
    /// Number of restarts after which the controller was configured again.
    pub restarts: u64,
    /// Share of the ticks with a flag of the training range.
    pub outside_training_share: f64,
    /// Share of the ticks with a sensor or timing flag.
    pub suspect_share: f64,
    /// Differences from the bench, after the start.
    pub against_truth: Differences,
    /// Differences from the float networks at the estimated contact, after the start: the effect of
    /// quantisation and of what the filter has learnt.
    pub against_float: Differences,
    /// Differences from the described law at the estimated contact, after the start: the effect of
    /// the networks and of what the filter has learnt.
    pub against_law: Differences,
    /// Impacts that the controller recorded.
    pub impacts: ImpactSummary,
    /// Counters of the controller.
    #[schemars(with = "std::collections::BTreeMap<String, serde_json::Value>")]
    pub counters: Counters,
    /// Losses on the line.
    pub losses: Losses,
}

/// Errors of force vector and torque against the reported deviations, and what was learnt about the
/// bearing. Held estimates have no deviation and do not count as covered.
#[derive(Clone, Copy, Debug, Default, Serialize, JsonSchema)]
pub struct Tracked {
    /// Rms error of the force vector, N.
    pub vector_rms_error_n: f64,
    /// Largest error of the force vector, N.
    pub vector_max_error_n: f64,
    /// Rms error of the friction torque, N m.
    pub torque_rms_error_nm: f64,
    /// Largest true friction torque, N m.
    pub torque_full_scale_nm: f64,
    /// Share of the ticks whose force error is within two reported deviations.
    pub inside_2sd: f64,
    /// The same of the torque.
    pub torque_inside_2sd: f64,
    /// Tracked clearance at the end, m.
    pub clearance_m: f64,
    /// Its deviation, m.
    pub clearance_sd_m: f64,
    /// Tracked stiffness at the end, as a multiple of the described one.
    pub stiffness_factor: f64,
    /// Its deviation.
    pub stiffness_sd: f64,
    /// Tracked friction at the end, as a multiple of the described one.
    pub friction_factor: f64,
    /// Its deviation.
    pub friction_sd: f64,
    /// Share of the ticks in which the model does not fit the samples.
    pub misfit_share: f64,
}

impl Tracked {
    /// Compares estimates with the truth.
    fn new(truth: &[Snapshot], estimates: &[EstimateFrame]) -> Self {
        let Some(last) = estimates.last() else { return Self::default() };
        let pairs = || estimates.iter().zip(truth);
        let force = |(e, s): (&EstimateFrame, &Snapshot)| {
            (f64::from(e.force_y_n) - s.force_y_n).hypot(f64::from(e.force_z_n) - s.force_z_n)
        };
        let torque =
            |(e, s): (&EstimateFrame, &Snapshot)| f64::from(e.friction_torque_nm) - s.friction_torque_nm;
        let share = |count: usize| count as f64 / estimates.len() as f64;
        let is_covered =
            |error: f64, deviation: f32| deviation.is_finite() && error.abs() <= 2.0 * f64::from(deviation);
        let misfits = estimates.iter().filter(|e| Flags::from_bits(e.flags).contains(MODEL_MISFIT));
        Self {
            vector_rms_error_n: rms(pairs().map(force)),
            vector_max_error_n: pairs().map(force).fold(0.0, f64::max),
            torque_rms_error_nm: rms(pairs().map(torque)),
            torque_full_scale_nm: peak(truth, |s| s.friction_torque_nm),
            inside_2sd: share(pairs().filter(|pair| is_covered(force(*pair), pair.0.force_sd_n)).count()),
            torque_inside_2sd: share(
                pairs().filter(|pair| is_covered(torque(*pair), pair.0.friction_torque_sd_nm)).count(),
            ),
            clearance_m: last.clearance_m.into(),
            clearance_sd_m: last.clearance_sd_m.into(),
            stiffness_factor: last.stiffness_factor.into(),
            stiffness_sd: last.stiffness_sd.into(),
            friction_factor: last.friction_factor.into(),
            friction_sd: last.friction_sd.into(),
            misfit_share: share(misfits.count()),
        }
    }
}

/// Differences of the normal force and the friction torque.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Differences {
    /// Rms of the force difference.
    pub force_rms_n: f64,
    /// Largest force difference.
    pub force_max_n: f64,
    /// Rms of the torque difference.
    pub torque_rms_nm: f64,
    /// Largest torque difference.
    pub torque_max_nm: f64,
}

impl Differences {
    /// Evaluates pairs of a normal force in N and a friction torque in N m.
    pub fn from_pairs(pairs: impl Iterator<Item = [Forces; 2]> + Clone) -> Self {
        let apart = |i: usize| pairs.clone().map(move |[a, b]| a[i] - b[i]);
        let largest = |i: usize| apart(i).fold(0.0, |max: f64, value| max.max(value.abs()));
        Self {
            force_rms_n: rms(apart(0)),
            force_max_n: largest(0),
            torque_rms_nm: rms(apart(1)),
            torque_max_nm: largest(1),
        }
    }
}

impl EstimatorSummary {
    /// Compares the estimates with the true forces and with the alternatives on the same signals.
    pub(crate) fn from_exchange(
        bench: &TransmissionBench,
        (truth, impacts): (&[Snapshot], &[Impact]),
        exchange: &ExchangeResult,
        same_signals: &[OnSignals],
        differences: Option<u64>,
    ) -> Self {
        let counted = after_start(bench, truth);
        let skipped = truth.len() - counted.len();
        let estimates = exchange.estimates.iter().skip(skipped);
        let estimates = estimates.map(|e| [f64::from(e.normal_force_n), f64::from(e.friction_torque_nm)]);
        let on_signals = same_signals.iter().skip(skipped);
        let against_truth = Differences::from_pairs(
            estimates.clone().zip(counted).map(|(e, s)| [e, [s.forces.normal_n, s.friction_torque_nm]]),
        );
        let share = |flags: Flags| {
            let hits =
                exchange.estimates.iter().filter(|e| Flags::from_bits(e.flags).intersects(flags)).count();
            hits as f64 / exchange.estimates.len().max(1) as f64
        };
        let are_instructions = exchange.controller == "emulated";
        let instructions = |ticks: Option<u32>| {
            ticks
                .filter(|&t| are_instructions && t > 0)
                .map(|t| (f64::from(t) / TICKS_PER_INSTRUCTION).round() as u64)
        };
        let ticks = || exchange.estimates.iter().map(|e| e.instruction_ticks);
        Self {
            controller: exchange.controller,
            force_rms_error_n: against_truth.force_rms_n,
            force_full_scale_n: peak(counted, |s| s.forces.normal_n),
            ticks: exchange.estimates.len() as u64,
            deadline_misses: u64::from(exchange.counters.deadline_overruns),
            // The first estimate contains no duration of a tick before it.
            instructions_per_tick_min: instructions(ticks().filter(|&ticks| ticks > 0).min()),
            instructions_per_tick_mean: mean_instructions(&exchange.estimates).filter(|_| are_instructions),
            instructions_per_tick_max: instructions(ticks().max()),
            exchanges_per_s: exchange.estimates.len() as f64 / exchange.wall_s.max(1e-9),
            native_emulated_bit_differences: differences.filter(|_| exchange.controller == "emulated"),
            native_attached_bit_differences: differences.filter(|_| exchange.controller == "attached"),
            tracked: Tracked::new(counted, exchange.estimates.get(skipped..).unwrap_or_default()),
            restarts: exchange.restarts.len() as u64,
            outside_training_share: share(Flags::OUTSIDE_TRAINING),
            suspect_share: share(SENSOR_FAULT),
            against_truth,
            against_float: Differences::from_pairs(
                estimates.clone().zip(on_signals.clone()).map(|(e, on)| [e, on.float_network]),
            ),
            against_law: Differences::from_pairs(estimates.zip(on_signals).map(|(e, on)| [e, on.law])),
            impacts: ImpactSummary::new(exchange, impacts, truth),
            counters: exchange.counters,
            losses: exchange.losses,
        }
    }
}

/// Mean instructions per tick of the emulated controller; none where nothing was counted.
fn mean_instructions(estimates: &[EstimateFrame]) -> Option<f64> {
    let counted = || estimates.iter().map(|e| f64::from(e.instruction_ticks)).filter(|&ticks| ticks > 0.0);
    let count = counted().count();
    (count > 0).then(|| counted().sum::<f64>() / count as f64 / TICKS_PER_INSTRUCTION)
}
