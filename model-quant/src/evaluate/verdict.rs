//! Result of the verification of one network of one bearing.

use super::goals::{COLLISION_MAE_SHARE, COLLISION_R2, FRICTION_R2, Goal};
use super::held_out::HeldOut;
use super::peers::PeerVerdict;
use serde::Serialize;

/// Upper ends in N of the normal-force bands for which errors are given. The first band begins at
/// 0, and a last band ends at the model's range.
pub(crate) const BANDS_N: [f64; 5] = [100.0, 1000.0, 3000.0, 7000.0, 14_000.0];

/// Errors of one network in one band of the law's normal force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Band {
    /// Upper end of the band in N.
    pub up_to_n: f64,
    /// Rows in the band.
    pub rows: usize,
    /// Mean magnitude of the law's force in N.
    pub mean_force_n: f64,
    /// Mean absolute error of the float networks in N.
    pub mae_float_n: f64,
    /// Mean absolute error of the image in N.
    pub mae_n: f64,
    /// Largest absolute error of the image in N.
    pub largest_n: f64,
    /// Mean absolute difference between image and float networks in N.
    pub mae_quantisation_n: f64,
    /// Largest absolute difference between image and float networks in N.
    pub largest_quantisation_n: f64,
}

/// Verification result of one network of one bearing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdict {
    /// Name of the bearing.
    pub bearing: &'static str,
    /// `collision` or `friction`.
    pub network: &'static str,
    /// R^2 of the float networks against the law.
    pub r2_float: f64,
    /// R^2 of the image against the law.
    pub r2_quantised: f64,
    /// Mean absolute error of the image against the law in N.
    pub mae_n: f64,
    /// Mean absolute error of the image as a torque in N m on the bench's bearing radius; for the
    /// friction network only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mae_nm: Option<f64>,
    /// 99th percentile of the law's force in N.
    pub p99_force_n: f64,
    /// Mean absolute error of the image divided by that percentile.
    pub mae_share_of_p99: f64,
    /// Largest absolute error of the image against the law in N.
    pub largest_n: f64,
    /// Mean absolute difference between image and float networks in N.
    pub mae_quantisation_n: f64,
    /// Largest absolute difference between image and float networks in N.
    pub largest_quantisation_n: f64,
    /// Median relative error of the image at the bench's working points.
    pub working_error_median: f64,
    /// 95th percentile of that relative error.
    pub working_error_p95: f64,
    /// Largest force in N that the image gives without contact.
    pub zero_contact_output: f64,
    /// True if the checksum at the end of the image matches its bytes.
    pub image_crc_ok: bool,
    /// True if the image was made from this checkpoint.
    pub image_matches_checkpoint: bool,
    /// Share of the rows in which an activation was clipped.
    pub saturated_share: f64,
    /// Number of test rows.
    pub rows: usize,
    /// Errors in each band.
    pub bands: Vec<Band>,
    /// Errors over the contacts of held-out bench runs, if measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub held_out: Option<HeldOut>,
    /// Figures compared with their goals.
    pub goals: Vec<Goal>,
    /// Comparison with other runtimes on the same parameters.
    pub peers: Vec<PeerVerdict>,
}

impl Verdict {
    pub(super) fn with_goals(mut self) -> Self {
        self.goals = goals(&self);
        self
    }

    /// Adds the errors over held-out bench runs and their goals.
    #[must_use]
    pub(crate) fn with_held_out(self, held_out: HeldOut) -> Self {
        Self { held_out: Some(held_out), ..self }.with_goals()
    }
}

/// Compares an image's figures with the goals of its network: on the test rows and, if measured, on
/// the held-out runs.
fn goals(verdict: &Verdict) -> Vec<Goal> {
    let held_out = verdict.held_out.as_ref().map(|found| &found.image);
    let mut goals = Vec::new();
    if verdict.network == "collision" {
        goals.push(Goal::at_least("R^2, test rows", verdict.r2_quantised, COLLISION_R2));
        let share = "mean absolute error over the 99th percentile, test rows";
        goals.push(Goal::at_most(share, verdict.mae_share_of_p99, COLLISION_MAE_SHARE));
        if let Some(found) = held_out {
            goals.push(Goal::at_least("R^2, held-out bench runs", found.r2, COLLISION_R2));
            let share = "mean absolute error over the 99th percentile, held-out bench runs";
            goals.push(Goal::at_most(share, found.mae_share_of_p99, COLLISION_MAE_SHARE));
        }
    } else {
        goals.push(Goal::at_least("R^2, test rows", verdict.r2_quantised, FRICTION_R2));
        if let Some(found) = held_out {
            goals.push(Goal::at_least("R^2, held-out bench runs", found.r2, FRICTION_R2));
        }
    }
    goals.push(Goal::at_most("largest output without contact, N", verdict.zero_contact_output, 0.0));
    goals
}
