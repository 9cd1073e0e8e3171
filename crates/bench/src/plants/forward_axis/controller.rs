//! Controller of a simulated motion, and the quantities that it and the axis integrate.
//!
//! The structure is that of [`Drive`]. Units: those of the description.

use super::root::MAX_SPEED;
use crate::description::Drive;
use crate::signals::Motion;

/// Maximum position, and maximum of an integral.
const MAX_POSITION: f64 = 1e12;

/// Quantities that are integrated.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct State {
    pub(super) position: f64,
    pub(super) speed: f64,
    pub(super) effort: f64,
    /// Integral of the position error.
    pub(super) integral: f64,
    /// Integral of the speed error.
    pub(super) speed_integral: f64,
}

impl State {
    /// Extrapolates from an earlier state through this one.
    pub(super) fn beyond(&self, earlier: &Self, share: f64) -> Self {
        let on = |from: f64, to: f64| from + share * (to - from);
        Self {
            position: on(earlier.position, self.position),
            speed: on(earlier.speed, self.speed),
            effort: on(earlier.effort, self.effort),
            integral: on(earlier.integral, self.integral),
            speed_integral: on(earlier.speed_integral, self.speed_integral),
        }
    }

    pub(super) fn limited(self) -> Self {
        let within = |value: f64, max: f64| value.clamp(-max, max);
        Self {
            position: within(self.position, MAX_POSITION),
            speed: within(self.speed, MAX_SPEED),
            effort: self.effort,
            integral: within(self.integral, MAX_POSITION),
            speed_integral: within(self.speed_integral, MAX_POSITION),
        }
    }
}

/// Output of the controller, in volts or its own unit.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Output {
    /// Without the limit of the effort.
    pub(super) unlimited: f64,
    /// With the limit of the effort.
    pub(super) limited: f64,
    /// 1 or -1 if the limit acts, else 0.
    pub(super) saturation: f64,
    pub(super) position_error: f64,
    pub(super) speed_error: f64,
}

/// Output of the controller for an order and a state.
pub(super) fn controller(drive: &Drive, order: &Motion, state: &State) -> Output {
    let position_error = order.value - state.position;
    let outer = drive.kp * position_error + drive.ki * state.integral - drive.kd * state.speed
        + drive.speed_feedforward * order.rate;
    let speed_error = outer - state.speed;
    let output = if drive.speed_gain > 0.0 {
        drive.speed_gain * speed_error + drive.speed_ki * state.speed_integral
    } else {
        outer
    };
    let max = if drive.effort_limit > 0.0 { drive.effort_limit / drive.gain } else { f64::INFINITY };
    let limited = output.clamp(-max, max);
    let saturation = if limited == output { 0.0 } else { output.signum() };
    Output { unlimited: output, limited, saturation, position_error, speed_error }
}
