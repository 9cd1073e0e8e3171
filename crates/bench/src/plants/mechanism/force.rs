//! Springs, dampers and loads of a mechanism.

use super::body::{Frame, Marker, dot, frame, scaled, subtract, wrench};

/// Spring and damper between two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spring {
    pub(crate) first: Marker,
    pub(crate) second: Marker,
    pub(crate) kind: SpringKind,
    /// Stiffness in N/m or N m/rad.
    pub(crate) stiffness: f64,
    /// Damping in N s/m or N m s/rad.
    pub(crate) damping: f64,
}

/// Measure of a spring's extension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SpringKind {
    /// Distance of the two points, over a free length in m.
    Linear(f64),
    /// Angle of the second body from the first, over a free angle in rad.
    Torsional(f64),
}

/// A spring at one state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extension {
    pub(super) bodies: [Option<usize>; 2],
    /// Direction of the extension on the coordinates of both bodies.
    pub(super) direction: [[f64; 3]; 2],
    /// Extension in m or rad, and its rate.
    pub(super) extension: f64,
    pub(super) rate: f64,
}

impl Spring {
    pub(super) fn at(&self, frames: &[Frame]) -> Extension {
        let bodies = [self.first.body, self.second.body];
        match self.kind {
            SpringKind::Linear(free_length_m) => {
                let [p1, p2] = [self.first, self.second].map(|end| end.at(frame(frames, end.body)));
                let distance = subtract(p2.position_m, p1.position_m);
                let length = dot(distance, distance).sqrt();
                let n = if length > 0.0 { scaled(distance, 1.0 / length) } else { [0.0; 2] };
                Extension {
                    bodies,
                    direction: [scaled(wrench(n, p1.arm_m), -1.0), wrench(n, p2.arm_m)],
                    extension: length - free_length_m,
                    rate: dot(n, subtract(p2.velocity_m_s, p1.velocity_m_s)),
                }
            }
            SpringKind::Torsional(free_angle_rad) => {
                let (first, second) = (frame(frames, bodies[0]), frame(frames, bodies[1]));
                Extension {
                    bodies,
                    direction: [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]],
                    extension: second.angle_rad - first.angle_rad - free_angle_rad,
                    rate: second.speed_rad_s - first.speed_rad_s,
                }
            }
        }
    }
}

/// Force and torque on a body, constant in the axes of the ground after a ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Load {
    pub(crate) at: Marker,
    /// Force in N.
    pub(crate) force_n: [f64; 2],
    /// Torque in N m.
    pub(crate) torque_nm: f64,
    /// Length of the raised-cosine ramp at the start in s; 0 for none.
    pub(crate) ramp_s: f64,
}

impl Load {
    /// Load of 0 at the centre of mass of a body.
    pub(super) fn at_centre(body: usize) -> Self {
        Self {
            at: Marker { body: Some(body), local_m: [0.0; 2] },
            force_n: [0.0; 2],
            torque_nm: 0.0,
            ramp_s: 0.0,
        }
    }

    /// Generalised force on the body, and its power in W.
    pub(super) fn at_state(&self, time_s: f64, frames: &[Frame]) -> ([f64; 3], f64) {
        let share = if time_s < self.ramp_s {
            0.5 * (1.0 - (core::f64::consts::PI * time_s / self.ramp_s).cos())
        } else {
            1.0
        };
        let body = frame(frames, self.at.body);
        let point = self.at.at(body);
        let force = scaled(self.force_n, share);
        let mut on_body = wrench(force, point.arm_m);
        on_body[2] += self.torque_nm * share;
        let torque_w = self.torque_nm * share * body.speed_rad_s;
        (on_body, dot(force, point.velocity_m_s) + torque_w)
    }
}
