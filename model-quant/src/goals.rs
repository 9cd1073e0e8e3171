//! The goals that a pair of networks is held against, and whether it meets them.

use crate::verify::Verdict;
use serde::Serialize;

/// Least R^2 of the collision network against the law.
pub const COLLISION_R2: f64 = 0.9999;
/// Largest mean absolute error of the collision network over the 99th percentile of the force.
pub const COLLISION_MAE_SHARE: f64 = 0.003;
/// Least R^2 of the friction network against the friction without noise.
pub const FRICTION_R2: f64 = 0.999;

/// A figure held against its goal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Goal {
    /// Name of the figure.
    pub figure: &'static str,
    /// What was found.
    pub value: f64,
    /// `>=` or `<=`.
    pub relation: &'static str,
    /// What was asked for.
    pub limit: f64,
    /// Whether it is met.
    pub met: bool,
}

impl Goal {
    fn at_least(figure: &'static str, value: f64, limit: f64) -> Self {
        Self { figure, value, relation: ">=", limit, met: value >= limit }
    }

    fn at_most(figure: &'static str, value: f64, limit: f64) -> Self {
        Self { figure, value, relation: "<=", limit, met: value <= limit }
    }
}

/// Holds an image's figures against the goals of its network: on the test rows, and on the held-out runs where they were
/// measured.
pub fn goals(verdict: &Verdict) -> Vec<Goal> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_meets_nothing() {
        assert!(!Goal::at_least("a", f64::NAN, 0.5).met && !Goal::at_most("a", f64::NAN, 0.5).met);
        assert!(Goal::at_least("a", 0.5, 0.5).met && Goal::at_most("a", 0.5, 0.5).met);
        assert!(!Goal::at_least("a", 0.4, 0.5).met && !Goal::at_most("a", 0.6, 0.5).met);
    }
}
