//! Contacts of a mechanism: clearance joints, guides with clearance, backlash of a drive.
//!
//! Every contact has a deformation `d`, its normal direction `N` and its tangent `T` on the
//! coordinates of two bodies, so that `d' = N v + d_t` (`d_t` is the rate of a drive) and the
//! sliding speed is `T v`. The normal force `F` acts as `-F N`, the friction force as `+F_f T`.
//! Both act on the two bodies at their own contact points, so their power is exactly `-F d' + F d_t
//! + F_f T v`.

use super::body::{Marker, Pair, add, dot, dot3, perpendicular, scaled, subtract, wrench};
use super::joint::IdealJoint;
use crate::integrate::ContactReading;
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

/// Directions and rates of a contact at one state.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Touch {
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
}

/// Contact at a point of each body at one state.
struct Point {
    /// Direction of the second body into the first.
    n: [f64; 2],
    /// Points of contact from the centres of mass.
    arms_m: [[f64; 2]; 2],
    /// Velocity of the second body against the first at the point.
    velocity_m_s: [f64; 2],
    depth_m: f64,
}

impl ContactKind {
    /// Bodies of the contact.
    #[inline]
    pub(crate) const fn bodies(&self) -> [Option<usize>; 2] {
        match self {
            Self::Journal { bearing, journal, .. } => [bearing.body, journal.body],
            Self::Corner { guide, corner, .. } => [guide.body, corner.body],
            Self::Flank { driven, .. } => [driven.first.body, driven.second.body],
        }
    }

    /// Point of contact; none for the flank of a drive.
    #[inline]
    fn point(&self, pair: Pair<'_>) -> Option<Point> {
        let (n, arms_m, depth_m) = match self {
            Self::Journal { bearing, journal, bearing_radius_m, journal_radius_m } => {
                let (b, j) = (bearing.at(pair[0]), journal.at(pair[1]));
                let distance = subtract(j.position_m, b.position_m);
                let length = dot(distance, distance).sqrt();
                let n = if length > 0.0 { scaled(distance, 1.0 / length) } else { [0.0; 2] };
                let arms =
                    [add(b.arm_m, scaled(n, *bearing_radius_m)), add(j.arm_m, scaled(n, *journal_radius_m))];
                (n, arms, length - (bearing_radius_m - journal_radius_m))
            }
            Self::Corner { guide, normal, half_width_m, corner } => {
                let (g, c) = (guide.at(pair[0]), corner.at(pair[1]));
                let n = pair[0].turned(*normal);
                let depth = dot(n, subtract(c.position_m, g.position_m)) - half_width_m;
                (n, [subtract(c.position_m, pair[0].position_m), c.arm_m], depth)
            }
            Self::Flank { .. } => return None,
        };
        let velocity_m_s = subtract(pair[1].velocity_at(arms_m[1]), pair[0].velocity_at(arms_m[0]));
        Some(Point { n, arms_m, velocity_m_s, depth_m })
    }

    /// The contact at a time and a state of its two bodies.
    pub(crate) fn at(&self, time_s: f64, pair: Pair<'_>) -> Touch {
        if let Some(point) = self.point(pair) {
            return point.touch();
        }
        let Self::Flank { driven, side, radius_m, half_play_m } = self else { return Touch::default() };
        let row = driven.row_of_pair(time_s, pair);
        let factor = side * radius_m;
        let drive_rate_m_s = factor * row.drive_rate;
        let rate = dot3(row.jacobian[0], pair[0].rates()) + dot3(row.jacobian[1], pair[1].rates());
        Touch {
            normal: row.jacobian.map(|j| scaled(j, factor)),
            depth_m: factor * row.value - half_play_m,
            rate_m_s: factor * rate + drive_rate_m_s,
            drive_rate_m_s,
            ..Touch::default()
        }
    }

    /// Position of the journal from the centre of its bearing in m, in the axes of the ground; 0
    /// for other contacts.
    pub(crate) fn offset_m(&self, pair: Pair<'_>) -> [f64; 2] {
        match self {
            Self::Journal { bearing, journal, .. } => {
                subtract(journal.at(pair[1]).position_m, bearing.at(pair[0]).position_m)
            }
            _ => [0.0; 2],
        }
    }

    /// Deformation in m, negative in a gap, and its rate in m/s.
    #[inline]
    pub(crate) fn deformation(&self, time_s: f64, pair: Pair<'_>) -> (f64, f64) {
        match self.point(pair) {
            Some(point) => (point.depth_m, dot(point.n, point.velocity_m_s)),
            None => {
                let touch = self.at(time_s, pair);
                (touch.depth_m, touch.rate_m_s)
            }
        }
    }

    /// Direction of the contact in rad from the first axis.
    pub(crate) fn angle_rad(&self, pair: Pair<'_>) -> f64 {
        match (self.point(pair), self) {
            (Some(point), _) => point.n[1].atan2(point.n[0]),
            (None, Self::Flank { side, .. }) if *side < 0.0 => core::f64::consts::PI,
            _ => 0.0,
        }
    }
}

impl Point {
    #[inline]
    fn touch(&self) -> Touch {
        let t = perpendicular(self.n);
        let on = |d: [f64; 2]| [scaled(wrench(d, self.arms_m[0]), -1.0), wrench(d, self.arms_m[1])];
        Touch {
            normal: on(self.n),
            tangent: on(t),
            depth_m: self.depth_m,
            rate_m_s: dot(self.n, self.velocity_m_s),
            drive_rate_m_s: 0.0,
            sliding_m_s: dot(t, self.velocity_m_s),
        }
    }
}

impl Contact {
    /// Normal force and friction force in N, with the latched approach speed and the deflection of
    /// the bristles.
    #[inline]
    pub(crate) fn forces_n(&self, touch: &Touch, latched_m_s: f64, bristle_m: f64) -> (f64, f64) {
        let normal = self.law.law.force_n(touch.depth_m, touch.rate_m_s, latched_m_s);
        let friction = self.friction.map_or(0.0, |law| law.force_n(normal, touch.sliding_m_s, bristle_m));
        (normal, friction)
    }

    /// Deformation, its rate and the normal force.
    #[inline]
    pub(crate) fn reading(&self, time_s: f64, pair: Pair<'_>, latched_m_s: f64) -> ContactReading {
        let (depth_m, rate_m_s) = self.kind.deformation(time_s, pair);
        ContactReading { depth_m, rate_m_s, force_n: self.law.law.force_n(depth_m, rate_m_s, latched_m_s) }
    }

    /// Returns whether the friction law has a deflection.
    pub(crate) fn has_bristles(&self) -> bool {
        self.friction.is_some_and(|law| law.has_state())
    }
}
