//! Accuracy of networks and estimator on the bench, condition by condition.
//!
//! * [`in_the_loop`]: change of a run when the networks replace the law, and the share of the held
//!   step in that change.
//! * [`estimate`]: the estimator with noisy sensors against the bench's true force, compared with
//!   the analytic law and the float networks at the estimated contact.
//! * [`gap`]: forces without contact.
//! * [`goals`] evaluates the results, and [`summary`] extracts the figures of the model cards.
//! * [`worlds`]: estimators in an independent simulator whose parameters differ from the described
//!   ones.
//! * [`conditions`]: the paper's conditions and held-out ones, on which no setting of the networks
//!   was chosen.
//!
//! Limits: the reference is the analytic law on the simulated bench, and the sensors' noise is
//! white. Shares refer to the run's own figures: a run with little oscillation can have a large
//! share, so the newtons are given as well.

pub mod conditions;
pub mod estimate;
pub mod gap;
pub mod goals;
pub mod in_the_loop;
pub(crate) mod pictures;
pub(crate) mod report;
pub mod summary;
pub mod worlds;

use crate::cli::error::CliError;
use crate::cli::parallel;
use conditions::Condition;
use estimate::EstimateAccuracy;
use gap::GapAccuracy;
pub(crate) use goals::Outcome;
use in_the_loop::LoopAccuracy;
use schemars::JsonSchema;
use serde::Serialize;

/// Results at one condition.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Accuracy {
    /// The condition.
    #[serde(flatten)]
    pub condition: Condition,
    /// Networks in place of the law.
    pub in_the_loop: LoopAccuracy,
    /// The estimator with its sensors.
    pub estimate: EstimateAccuracy,
    /// Without contact.
    pub gap: GapAccuracy,
}

/// Options of the measurement.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Communication step of the networks, s.
    pub step_s: f64,
    /// Seed of the sensors' noise; every condition has its own stream.
    pub seed: u64,
    /// Threads; 0 uses one per core. The result does not depend on it.
    pub threads: usize,
}

/// Measures all conditions; `finished` is called after each.
pub fn measure(
    conditions: &[Condition],
    settings: Settings,
    finished: impl Fn() + Sync,
) -> Result<Vec<Accuracy>, CliError> {
    parallel::map(settings.threads, conditions, |_, condition| {
        let law = condition.law_run()?;
        let followed = estimate::follow(condition, &law, Some(settings.seed))?;
        let accuracy = Accuracy {
            condition: *condition,
            in_the_loop: in_the_loop::measure(condition, &law, settings.step_s)?,
            estimate: EstimateAccuracy::from_ticks(&followed, &estimate::follow(condition, &law, None)?),
            gap: gap::measure(condition, &law)?,
        };
        finished();
        Ok(accuracy)
    })
}

#[cfg(test)]
mod tests {
    use super::estimate::Errors;
    use super::in_the_loop::Change;
    use super::*;
    use bench::BearingMaterial;

    pub(super) fn accuracy(held_out: bool) -> Accuracy {
        let change = Change::default();
        let errors = Errors::default();
        Accuracy {
            condition: Condition {
                bearing: BearingMaterial::Babbitt,
                clearance_mm: 0.5,
                load_kn: 10.0,
                period_s: 1.0,
                held_out,
                index: 0,
            },
            in_the_loop: LoopAccuracy {
                peak_contact_force_n: 1000.0,
                oscillation_rms_n: 100.0,
                network: change,
                network_double_step: change,
                held_law: change,
                held_law_double_step: change,
                outside_training_share: 0.0,
                without_contact_n: 0.0,
            },
            estimate: EstimateAccuracy {
                force_full_scale_n: 1000.0,
                torque_full_scale_nm: 10.0,
                network: errors,
                float_network: errors,
                law: errors,
                perfect_sensors: errors,
                law_perfect_sensors: errors,
                outside_training_share: 0.0,
                suspect_share: 0.0,
            },
            gap: GapAccuracy { network_n: 0.0, float_network_n: 0.0, samples: 1 },
        }
    }

    /// Results are the same on any number of threads, and the seed changes the sensors alone.
    #[test]
    fn results_do_not_depend_on_threads_and_the_seed_changes_the_sensors_only() {
        let conditions: Vec<Condition> =
            conditions::all().into_iter().filter(|c| c.held_out && c.clearance_mm == 0.7).take(2).collect();
        let settings = Settings { step_s: 2e-5, seed: 1, threads: 1 };
        let text = |settings| serde_json::to_string(&measure(&conditions, settings, || {}).unwrap()).unwrap();
        let one = text(settings);
        assert_eq!(one, text(Settings { threads: 2, ..settings }));
        let other = measure(&conditions, Settings { seed: 2, ..settings }, || {}).unwrap();
        let one: Vec<Accuracy> = measure(&conditions, settings, || {}).unwrap();
        for (a, b) in one.iter().zip(&other) {
            assert_eq!(a.in_the_loop.network, b.in_the_loop.network);
            assert_eq!(a.estimate.perfect_sensors, b.estimate.perfect_sensors);
            assert_ne!(a.estimate.network, b.estimate.network);
            assert!(a.estimate.law_perfect_sensors.force_rms_n < a.estimate.law.force_rms_n);
        }
    }
}
