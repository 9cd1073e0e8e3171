//! Contacts of a mechanism: clearance joints, guides with clearance, backlash of a drive.
//!
//! Every contact has a deformation `d`, its normal direction `N` and its tangent `T` on the
//! coordinates of two bodies, so that `d' = N v + d_t` (`d_t` is the rate of a drive) and the
//! sliding speed is `T v`. The normal force `F` acts as `-F N`, the friction force as `+F_f T`.
//! Both act on the two bodies at their own contact points, so their power is exactly `-F d' + F d_t
//! + F_f T v`.

use super::body::{Frame, Marker, add, dot, dot3, frame, perpendicular, scaled, subtract, wrench};
use super::joint::IdealJoint;
use crate::plants::contact_laws::{BearingFriction, JointLaw};

/// Geometry of a contact between two bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ContactKind {
    /// Journal of the second body in a bearing of the first.
    Journal {
        /// Bearing centre.
        bearing: Marker,
        /// Journal centre.
        journal: Marker,
        /// Bearing radius in m.
        bearing_radius_m: f64,
        /// Journal radius in m.
        journal_radius_m: f64,
    },
    /// Corner of a slider against one wall of a straight guide.
    Corner {
        /// Point on the middle line of the guide.
        guide: Marker,
        /// Outward normal of the wall in the axes of the guide's body.
        normal: [f64; 2],
        /// Distance of the wall from the middle line in m.
        half_width_m: f64,
        /// Corner of the slider.
        corner: Marker,
    },
    /// Flank of a drive with backlash.
    Flank {
        /// Driven coordinate.
        driven: IdealJoint,
        /// 1 or -1: the flank against which the coordinate runs in this direction.
        side: f64,
        /// Radius of the flanks in m; 1 for a displacement.
        radius_m: f64,
        /// Half of the play in m.
        half_play_m: f64,
    },
}

/// Contact of a mechanism with its laws.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    pub(crate) kind: ContactKind,
    pub(crate) law: JointLaw,
    /// Friction law; none for a frictionless contact.
    pub(crate) friction: Option<BearingFriction>,
    /// Index of the deflection of the friction law's bristles, if it has one.
    pub(crate) bristle: Option<usize>,
}

/// A contact at one state.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Touch {
    pub(crate) bodies: [Option<usize>; 2],
    pub(crate) normal: [[f64; 3]; 2],
    pub(crate) tangent: [[f64; 3]; 2],
    /// Deformation in m, negative in a gap.
    pub(crate) depth_m: f64,
    /// Its rate in m/s.
    pub(crate) rate_m_s: f64,
    /// Part of the rate that comes from a drive, in m/s.
    pub(crate) drive_rate_m_s: f64,
    /// Sliding speed in m/s.
    pub(crate) sliding_m_s: f64,
    /// Direction of the contact in rad from the first axis.
    pub(crate) angle_rad: f64,
}

impl ContactKind {
    /// The contact at a time and a state of the bodies.
    pub(crate) fn at(&self, time_s: f64, frames: &[Frame]) -> Touch {
        match self {
            Self::Journal { bearing, journal, bearing_radius_m, journal_radius_m } => {
                let (b, j) = (bearing.at(frames), journal.at(frames));
                let distance = subtract(j.position_m, b.position_m);
                let length = dot(distance, distance).sqrt();
                let n = if length > 0.0 { scaled(distance, 1.0 / length) } else { [0.0; 2] };
                let arms =
                    [add(b.arm_m, scaled(n, *bearing_radius_m)), add(j.arm_m, scaled(n, *journal_radius_m))];
                let depth = length - (bearing_radius_m - journal_radius_m);
                Touch::at_point(frames, [bearing.body, journal.body], n, arms, depth)
            }
            Self::Corner { guide, normal, half_width_m, corner } => {
                let (g, c) = (guide.at(frames), corner.at(frames));
                let body = frame(frames, guide.body);
                let n = body.turned(*normal);
                let depth = dot(n, subtract(c.position_m, g.position_m)) - half_width_m;
                let arms = [subtract(c.position_m, body.position_m), c.arm_m];
                Touch::at_point(frames, [guide.body, corner.body], n, arms, depth)
            }
            Self::Flank { driven, side, radius_m, half_play_m } => {
                let row = driven.row(time_s, frames);
                let factor = side * radius_m;
                let normal = row.jacobian.map(|j| scaled(j, factor));
                let drive_rate_m_s = factor * row.drive_rate;
                Touch {
                    bodies: row.bodies,
                    normal,
                    depth_m: factor * row.value - half_play_m,
                    rate_m_s: along(&normal, row.bodies, frames) + drive_rate_m_s,
                    drive_rate_m_s,
                    angle_rad: if *side > 0.0 { 0.0 } else { core::f64::consts::PI },
                    ..Touch::default()
                }
            }
        }
    }
}

impl Touch {
    /// Contact at a point of each body, at arms from the centres of mass; `n` points from the
    /// second body into the first.
    fn at_point(
        frames: &[Frame],
        bodies: [Option<usize>; 2],
        n: [f64; 2],
        arms: [[f64; 2]; 2],
        depth_m: f64,
    ) -> Self {
        let t = perpendicular(n);
        let on = |d: [f64; 2]| [scaled(wrench(d, arms[0]), -1.0), wrench(d, arms[1])];
        let (normal, tangent) = (on(n), on(t));
        Self {
            bodies,
            normal,
            tangent,
            depth_m,
            rate_m_s: along(&normal, bodies, frames),
            drive_rate_m_s: 0.0,
            sliding_m_s: along(&tangent, bodies, frames),
            angle_rad: n[1].atan2(n[0]),
        }
    }
}

/// Rate of both bodies along a direction of their coordinates.
fn along(direction: &[[f64; 3]; 2], bodies: [Option<usize>; 2], frames: &[Frame]) -> f64 {
    direction.iter().zip(bodies).map(|(d, body)| dot3(*d, frame(frames, body).rates())).sum()
}

impl Contact {
    /// Normal force and friction force in N, with the latched approach speed and the deflection of
    /// the bristles.
    pub(crate) fn forces_n(&self, touch: &Touch, latched_m_s: f64, bristle_m: f64) -> (f64, f64) {
        let normal = self.law.law.force_n(touch.depth_m, touch.rate_m_s, latched_m_s);
        let friction = self.friction.map_or(0.0, |law| law.force_n(normal, touch.sliding_m_s, bristle_m));
        (normal, friction)
    }

    /// Returns whether the friction law has a deflection.
    pub(crate) fn has_bristles(&self) -> bool {
        self.friction.is_some_and(|law| law.has_state())
    }
}
