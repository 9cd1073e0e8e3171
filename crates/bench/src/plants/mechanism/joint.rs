//! Ideal joints and drives of a mechanism as constraints `g(q, t) = 0`.
//!
//! Each constraint has its value `g`, its Jacobian `G` on the coordinates of two bodies, its
//! partial time derivative and the value of `G q''` that its second time derivative requires. The
//! expressions follow from differentiating `g` twice (Nikravesh, Computer-Aided Analysis of
//! Mechanical Systems, 1988, section 4).

use super::body::{Frame, Marker, Pair, dot, dot3, frame, perpendicular, scaled, subtract, wrench};
use crate::signals::Motion;
use core::f64::consts::TAU;

/// Prescribed motion of a drive: `speed t + amplitude sin(wt) + (stroke/2)(1 - cos wt)`, in rad or
/// m, `w = 2 pi/period`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct DriveMotion {
    /// Constant speed in rad/s or m/s.
    pub(crate) speed: f64,
    /// Amplitude of the sine in rad or m.
    pub(crate) amplitude: f64,
    /// One-sided stroke in rad or m.
    pub(crate) stroke: f64,
    /// Period of sine and stroke in s.
    pub(crate) period_s: f64,
}

impl DriveMotion {
    /// Motion at a time.
    #[inline]
    pub(crate) fn at(&self, time_s: f64) -> Motion {
        if self.amplitude == 0.0 && self.stroke == 0.0 {
            return Motion { value: self.speed * time_s, rate: self.speed, acceleration: 0.0 };
        }
        let w = TAU / self.period_s;
        let (sin, cos) = (w * time_s).sin_cos();
        let (a, half) = (self.amplitude, 0.5 * self.stroke);
        Motion {
            value: self.speed * time_s + a * sin + half * (1.0 - cos),
            rate: self.speed + w * (a * cos + half * sin),
            acceleration: w * w * (half * cos - a * sin),
        }
    }
}

/// A constraint at one state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub(crate) bodies: [Option<usize>; 2],
    /// Jacobian on the coordinates of both bodies.
    pub(crate) jacobian: [[f64; 3]; 2],
    /// Value `g` in m or rad.
    pub(crate) value: f64,
    /// Partial derivative of `g` by time: minus the drive's speed.
    pub(crate) drive_rate: f64,
    /// Required value of `G q''`.
    pub(crate) target: f64,
}

/// Kind of a constraint between two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Constraint {
    /// Coinciding points, along an axis of the ground.
    Coincident([f64; 2]),
    /// Component of the distance along a direction of the first body.
    Component {
        /// Direction in the axes of the first body.
        direction: [f64; 2],
        /// Component at the start in m.
        start_m: f64,
    },
    /// Angle of the second body from the first.
    Angle {
        /// Angle at the start in rad.
        start_rad: f64,
    },
    /// Distance of the points.
    Distance {
        /// Length in m.
        length_m: f64,
    },
}

/// A constraint of a mechanism, with the motion of its drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct IdealJoint {
    pub(crate) first: Marker,
    pub(crate) second: Marker,
    pub(crate) constraint: Constraint,
    /// Prescribed change; without one the constraint keeps its value.
    pub(crate) drive: Option<DriveMotion>,
}

impl Row {
    /// Jacobian times accelerations or rates of the bodies.
    #[inline]
    pub(crate) fn applied(&self, values: impl Fn(usize) -> [f64; 3]) -> f64 {
        let sides = self.bodies.iter().zip(self.jacobian);
        sides.map(|(body, jacobian)| body.map_or(0.0, |body| dot3(jacobian, values(body)))).sum()
    }
}

impl IdealJoint {
    /// The constraint at a time and a state of all bodies.
    #[inline]
    pub(crate) fn row(&self, time_s: f64, frames: &[Frame]) -> Row {
        self.row_of_pair(time_s, [frame(frames, self.first.body), frame(frames, self.second.body)])
    }

    /// The constraint at a time and a state of its two bodies.
    #[inline]
    pub(crate) fn row_of_pair(&self, time_s: f64, [first, second]: Pair<'_>) -> Row {
        let drive = self.drive.map(|drive| drive.at(time_s)).unwrap_or_default();
        let (p1, p2) = (self.first.at(first), self.second.at(second));
        let distance = subtract(p2.position_m, p1.position_m);
        let rate = subtract(p2.velocity_m_s, p1.velocity_m_s);
        let centripetal = subtract(p2.centripetal_m_s2, p1.centripetal_m_s2);
        let along = |d: [f64; 2]| [scaled(wrench(d, p1.arm_m), -1.0), wrench(d, p2.arm_m)];
        let (jacobian, value, curvature) = match self.constraint {
            Constraint::Coincident(axis) => (along(axis), dot(axis, distance), dot(axis, centripetal)),
            Constraint::Component { direction, start_m } => {
                let e = first.turned(direction);
                let across = perpendicular(e);
                let w = first.speed_rad_s;
                let mut jacobian = along(e);
                jacobian[0][2] += dot(across, distance);
                let curvature = dot(e, centripetal) + 2.0 * w * dot(across, rate) - w * w * dot(e, distance);
                (jacobian, dot(e, distance) - start_m, curvature)
            }
            Constraint::Angle { start_rad } => {
                let angle = second.angle_rad - first.angle_rad;
                ([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]], angle - start_rad, 0.0)
            }
            Constraint::Distance { length_m } => {
                let value = 0.5 * (dot(distance, distance) / length_m - length_m);
                let curvature = (dot(rate, rate) + dot(distance, centripetal)) / length_m;
                (along(scaled(distance, 1.0 / length_m)), value, curvature)
            }
        };
        Row {
            bodies: [self.first.body, self.second.body],
            jacobian,
            value: value - drive.value,
            drive_rate: -drive.rate,
            target: drive.acceleration - curvature,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Jacobian and target are the derivatives of the value along a motion.
    #[test]
    fn the_derivatives_of_every_constraint_match_its_value() {
        let (first, second) =
            (Marker { body: Some(0), local_m: [0.3, -0.2] }, Marker { body: Some(1), local_m: [-0.1, 0.4] });
        let drive = DriveMotion { speed: 0.7, amplitude: 0.2, stroke: 0.3, period_s: 2.0 };
        let start = [[0.1, 0.2, 0.3], [0.9, -0.4, 1.1]];
        let rates = [[0.4, -0.3, 1.7], [-0.6, 0.8, -2.1]];
        // A motion with constant rates, so that `G q''` is 0.
        let frames = |t: f64| -> [Frame; 2] {
            let at = |i: usize| Frame::new(std::array::from_fn(|k| start[i][k] + t * rates[i][k]), rates[i]);
            [at(0), at(1)]
        };
        for constraint in [
            Constraint::Coincident([0.6, 0.8]),
            Constraint::Component { direction: [0.8, -0.6], start_m: 0.1 },
            Constraint::Angle { start_rad: 0.2 },
            Constraint::Distance { length_m: 0.5 },
        ] {
            let joint = IdealJoint { first, second, constraint, drive: Some(drive) };
            let (t, h) = (0.37, 1e-4);
            let value = |t: f64| joint.row(t, &frames(t)).value;
            let row = joint.row(t, &frames(t));
            let rate: f64 = (0..2).map(|i| dot3(row.jacobian[i], rates[i])).sum();
            let difference = (value(t + h) - value(t - h)) / (2.0 * h);
            assert!((rate + row.drive_rate - difference).abs() < 1e-7, "{constraint:?} {rate} {difference}");
            let second = (value(t + h) - 2.0 * value(t) + value(t - h)) / (h * h);
            assert!((row.target + second).abs() < 1e-6, "{constraint:?} {} {second}", row.target);
        }
    }
}
