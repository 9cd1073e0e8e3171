//! Networks in place of the law: change of peak force and oscillation, and the part of the held
//! step in it.
//!
//! The networks' force is held over a communication step. The same run with the law held over that
//! step shows the step's part of the change. Both are repeated at twice the step.

use super::conditions::{Condition, LawRun};
use crate::cli::error::CliError;
use crate::run::force::{self, ForceSource, ForcedRun, SAMPLE_RATE_HZ};
use crate::run::summary::Figures;
use schemars::JsonSchema;
use serde::Serialize;

/// Relative change from the error-controlled run with the law.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Change {
    /// Change of the peak contact force.
    pub peak: f64,
    /// Change of the oscillation's rms.
    pub oscillation: f64,
}

/// Results of a condition in the loop.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct LoopAccuracy {
    /// Peak contact force with the law, error-controlled.
    pub peak_contact_force_n: f64,
    /// Oscillation with the law, error-controlled.
    pub oscillation_rms_n: f64,
    /// Quantised networks at the communication step.
    pub network: Change,
    /// Quantised networks at twice the step.
    pub network_double_step: Change,
    /// The law held over the step.
    pub held_law: Change,
    /// The law held over twice the step.
    pub held_law_double_step: Change,
    /// Share of the samples in contact outside the networks' training range.
    pub outside_training_share: f64,
    /// Largest force of the networks without contact, N.
    pub without_contact_n: f64,
}

/// Runs the condition with networks and with the held law.
pub fn measure(condition: &Condition, law: &LawRun, step_s: f64) -> Result<LoopAccuracy, CliError> {
    let figures = |source, forced: &ForcedRun| Figures::from_run(&law.bench, source, forced, SAMPLE_RATE_HZ);
    let truth = figures(ForceSource::Law, &law.forced);
    let run = |source, step_s| {
        let failed = |e| CliError::Work(format!("{}, {}: {e}", condition.name(), ForceSource::name(source)));
        let forced = force::run_bench(&law.bench, source, step_s, || {}).map_err(failed)?;
        let found = figures(source, &forced);
        let change = Change {
            peak: found.peak_contact_force_n / truth.peak_contact_force_n - 1.0,
            oscillation: found.oscillation_rms_n / truth.oscillation_rms_n - 1.0,
        };
        Ok::<_, CliError>((change, forced))
    };
    let (network, forced) = run(ForceSource::QuantisedNet, step_s)?;
    Ok(LoopAccuracy {
        peak_contact_force_n: truth.peak_contact_force_n,
        oscillation_rms_n: truth.oscillation_rms_n,
        network,
        network_double_step: run(ForceSource::QuantisedNet, 2.0 * step_s)?.0,
        held_law: run(ForceSource::HeldLaw, step_s)?.0,
        held_law_double_step: run(ForceSource::HeldLaw, 2.0 * step_s)?.0,
        outside_training_share: forced.outside_training_share,
        without_contact_n: forced.without_contact_n,
    })
}
