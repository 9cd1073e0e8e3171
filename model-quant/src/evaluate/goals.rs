//! Accuracy goals of the networks.

use serde::Serialize;

/// Minimum R^2 of the collision network against the law.
pub(crate) const COLLISION_R2: f64 = 0.9999;
/// Maximum mean absolute error of the collision network divided by the 99th percentile of the
/// force.
pub(crate) const COLLISION_MAE_SHARE: f64 = 0.003;
/// Minimum R^2 of the friction network against the friction without noise.
pub(crate) const FRICTION_R2: f64 = 0.999;

/// A figure compared with its goal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Goal {
    /// Name of the figure.
    pub figure: &'static str,
    /// Measured value.
    pub value: f64,
    /// `>=` or `<=`.
    pub relation: &'static str,
    /// Limit of the goal.
    pub limit: f64,
    /// True if the value meets the limit.
    pub met: bool,
}

impl Goal {
    pub(super) fn at_least(figure: &'static str, value: f64, limit: f64) -> Self {
        Self { figure, value, relation: ">=", limit, met: value >= limit }
    }

    pub(super) fn at_most(figure: &'static str, value: f64, limit: f64) -> Self {
        Self { figure, value, relation: "<=", limit, met: value <= limit }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nan_meets_no_goal() {
        assert!(!Goal::at_least("a", f64::NAN, 0.5).met && !Goal::at_most("a", f64::NAN, 0.5).met);
        assert!(Goal::at_least("a", 0.5, 0.5).met && Goal::at_most("a", 0.5, 0.5).met);
        assert!(!Goal::at_least("a", 0.4, 0.5).met && !Goal::at_most("a", 0.6, 0.5).met);
    }
}
