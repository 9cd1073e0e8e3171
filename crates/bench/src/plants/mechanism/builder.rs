//! Construction of a mechanism in its position at the start: all points are given in the axes of
//! the ground and become fixed to their bodies.

use super::body::{Body, Frame, Marker, dot, frame, perpendicular, subtract};
use super::contact::{Contact, ContactKind};
use super::force::{Load, Spring, SpringKind};
use super::joint::{Constraint, DriveMotion, IdealJoint};
use super::suspension::{Support, Suspension};
use super::{Drive, Mechanism};
use crate::plants::contact_laws::{BearingFriction, JointLaw};

/// Body of a mechanism, or `None` for the ground.
pub(crate) type BodyIndex = Option<usize>;

/// Normal law of a contact, with its friction law if it has friction.
pub(crate) type Laws = (JointLaw, Option<BearingFriction>);

/// Parts of a mechanism so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Builder {
    mechanism: Mechanism,
    frames: Vec<Frame>,
    /// Revolute joints that become constraints, unless one of the bodies is driven.
    pivots: Vec<([BodyIndex; 2], [f64; 2])>,
}

impl Builder {
    /// A mechanism without bodies under a gravity in m/s2. Errors of its constraints are reduced at
    /// a rate in 1/s.
    pub(crate) fn new(gravity_m_s2: [f64; 2], stabilisation_per_s: f64) -> Self {
        let mechanism = Mechanism { gravity_m_s2, stabilisation_per_s, ..Mechanism::default() };
        Self { mechanism, ..Self::default() }
    }

    /// Adds a body.
    pub(crate) fn body(&mut self, body: Body) -> BodyIndex {
        self.frames.push(Frame::new(body.start, body.start_rate));
        self.mechanism.suspensions.push(Suspension::new(&body));
        self.mechanism.bodies.push(body);
        Some(self.mechanism.bodies.len() - 1)
    }

    /// Adds a uniform bar between two points, with its speed in rad/s and the velocity of its
    /// centre. Its moment of inertia about the centre may be another one.
    pub(crate) fn bar(
        &mut self,
        mass_kg: f64,
        inertia_kg_m2: Option<f64>,
        ends_m: [[f64; 2]; 2],
        start_rate: [f64; 3],
    ) -> BodyIndex {
        let along = subtract(ends_m[1], ends_m[0]);
        let centre = [0.5 * (ends_m[0][0] + ends_m[1][0]), 0.5 * (ends_m[0][1] + ends_m[1][1])];
        self.body(Body {
            mass_kg,
            inertia_kg_m2: inertia_kg_m2.unwrap_or(mass_kg * dot(along, along) / 12.0),
            start: [centre[0], centre[1], along[1].atan2(along[0])],
            start_rate,
        })
    }

    /// Marker of a body at a point.
    pub(crate) fn marker(&self, body: BodyIndex, at_m: [f64; 2]) -> Marker {
        let frame = frame(&self.frames, body);
        Marker { body, local_m: frame.turned_back(subtract(at_m, frame.position_m)) }
    }

    /// Centre of mass of a body at the start.
    pub(crate) fn centre_m(&self, body: BodyIndex) -> [f64; 2] {
        frame(&self.frames, body).position_m
    }

    fn angle_rad(&self, body: BodyIndex) -> f64 {
        frame(&self.frames, body).angle_rad
    }

    /// Joint of two bodies at one point, with its constraint.
    fn joint(&self, [first, second]: [BodyIndex; 2], at_m: [f64; 2], constraint: Constraint) -> IdealJoint {
        let (first, second) = (self.marker(first, at_m), self.marker(second, at_m));
        IdealJoint { first, second, constraint, drive: None }
    }

    fn coincident(&self, bodies: [BodyIndex; 2], at_m: [f64; 2]) -> [IdealJoint; 2] {
        [[1.0, 0.0], [0.0, 1.0]].map(|axis| self.joint(bodies, at_m, Constraint::Coincident(axis)))
    }

    fn angle(&self, bodies: [BodyIndex; 2], at_m: [f64; 2]) -> IdealJoint {
        let start_rad = self.angle_rad(bodies[1]) - self.angle_rad(bodies[0]);
        self.joint(bodies, at_m, Constraint::Angle { start_rad })
    }

    fn component(&self, bodies: [BodyIndex; 2], at_m: [f64; 2], direction: [f64; 2]) -> IdealJoint {
        let direction = frame(&self.frames, bodies[0]).turned_back(direction);
        self.joint(bodies, at_m, Constraint::Component { direction, start_m: 0.0 })
    }

    /// Supports a body in closed form and returns true; false if another joint supports it.
    fn support(&mut self, body: usize, support: Support) -> bool {
        let Some(suspension) = self.mechanism.suspensions.get_mut(body) else { return false };
        let is_free = matches!(suspension.support, Support::Free);
        if is_free {
            suspension.attach(&self.mechanism.bodies[body], support);
        }
        is_free
    }

    /// Supports a body in closed form on a pivot of the ground or of a driven body.
    fn support_on(&mut self, carrier: BodyIndex, body: BodyIndex, at_m: [f64; 2]) -> bool {
        let suspensions = &self.mechanism.suspensions;
        let is_fixed = carrier.is_none_or(|carrier| suspensions[carrier].is_driven());
        let Some(body) = body.filter(|_| is_fixed) else { return false };
        let frame = &self.frames[body];
        let centre_m = frame.turned_back(subtract(frame.position_m, at_m));
        self.support(body, Support::Pivot { on: self.marker(carrier, at_m), centre_m })
    }

    /// Adds a revolute joint at a point.
    pub(crate) fn revolute(&mut self, bodies: [BodyIndex; 2], at_m: [f64; 2]) {
        let is_of_ground = of_ground(bodies).is_some_and(|(body, _)| self.support_on(None, Some(body), at_m));
        if !is_of_ground {
            self.pivots.push((bodies, at_m));
        }
    }

    /// Adds a prismatic joint: the second body slides along an axis of the first and keeps its
    /// angle to it.
    pub(crate) fn prismatic(&mut self, bodies: [BodyIndex; 2], at_m: [f64; 2], axis: [f64; 2]) {
        if of_ground(bodies).is_some_and(|(body, _)| self.support(body, Support::Slide { axis })) {
            return;
        }
        let joint = [self.component(bodies, at_m, perpendicular(axis)), self.angle(bodies, at_m)];
        self.mechanism.joints.extend(joint);
    }

    /// Adds a pin of the second body in a straight slot of the first.
    pub(crate) fn slot(&mut self, bodies: [BodyIndex; 2], at_m: [f64; 2], axis: [f64; 2]) {
        self.mechanism.joints.push(self.component(bodies, at_m, perpendicular(axis)));
    }

    /// Joins two bodies rigidly.
    pub(crate) fn weld(&mut self, bodies: [BodyIndex; 2], at_m: [f64; 2]) {
        let joint = self.coincident(bodies, at_m);
        self.mechanism.joints.extend(joint);
        self.mechanism.joints.push(self.angle(bodies, at_m));
    }

    /// Adds a massless rod between a point of the first body and one of the second.
    pub(crate) fn rod(&mut self, bodies: [BodyIndex; 2], ends_m: [[f64; 2]; 2]) {
        let along = subtract(ends_m[1], ends_m[0]);
        let constraint = Constraint::Distance { length_m: dot(along, along).sqrt() };
        let (first, second) = (self.marker(bodies[0], ends_m[0]), self.marker(bodies[1], ends_m[1]));
        self.mechanism.joints.push(IdealJoint { first, second, constraint, drive: None });
    }

    /// The driven coordinate of a joint: the angle between the bodies, or with an axis the
    /// displacement along it.
    fn driven(
        &self,
        bodies: [BodyIndex; 2],
        at_m: [f64; 2],
        axis: Option<[f64; 2]>,
        motion: DriveMotion,
    ) -> IdealJoint {
        let coordinate = match axis {
            Some(axis) => self.component(bodies, at_m, axis),
            None => self.angle(bodies, at_m),
        };
        IdealJoint { drive: Some(motion), ..coordinate }
    }

    /// Drives the angle between two bodies, or with an axis the displacement along it.
    pub(crate) fn drive(
        &mut self,
        bodies: [BodyIndex; 2],
        at_m: [f64; 2],
        axis: Option<[f64; 2]>,
        motion: DriveMotion,
    ) {
        if let Some((body, sense)) = of_ground(bodies)
            && let Some(suspension) = self.mechanism.suspensions.get_mut(body)
            && suspension.takes_drive(axis)
        {
            suspension.drive = Some((motion, sense));
            self.mechanism.drives.push(Drive::Ground(body));
            return;
        }
        self.mechanism.drives.push(Drive::Row(self.mechanism.joints.len()));
        self.mechanism.joints.push(self.driven(bodies, at_m, axis, motion));
    }

    /// Drives a coordinate as [`Self::drive`] does, through flanks at a radius with a total play,
    /// both in m.
    pub(crate) fn drive_with_backlash(
        &mut self,
        (bodies, at_m, axis): ([BodyIndex; 2], [f64; 2], Option<[f64; 2]>),
        motion: DriveMotion,
        (play_m, radius_m): (f64, f64),
        laws: Laws,
    ) {
        let driven = self.driven(bodies, at_m, axis, motion);
        for side in [1.0, -1.0] {
            let kind = ContactKind::Flank { driven, side, radius_m, half_play_m: 0.5 * play_m };
            self.contact(kind, laws);
        }
        self.mechanism.closing.push(driven);
    }

    /// Adds a revolute joint with clearance. At the start the journal's centre is at an offset from
    /// the bearing's.
    pub(crate) fn clearance(
        &mut self,
        bodies: [BodyIndex; 2],
        at_m: [f64; 2],
        offset_m: [f64; 2],
        [bearing_radius_m, journal_radius_m]: [f64; 2],
        laws: Laws,
    ) {
        let bearing = self.marker(bodies[0], at_m);
        let journal = self.marker(bodies[1], [at_m[0] + offset_m[0], at_m[1] + offset_m[1]]);
        self.contact(ContactKind::Journal { bearing, journal, bearing_radius_m, journal_radius_m }, laws);
        let closing = self.coincident(bodies, at_m).map(|joint| IdealJoint {
            first: bearing,
            second: journal,
            ..joint
        });
        self.mechanism.closing.extend(closing);
    }

    /// Adds a prismatic joint with clearance: a slider of the second body, of a length and a
    /// height, whose corners touch the walls of a guide of the first at a clearance on each side.
    pub(crate) fn guide(
        &mut self,
        bodies: [BodyIndex; 2],
        at_m: [f64; 2],
        axis: [f64; 2],
        [length_m, height_m, clearance_m]: [f64; 3],
        laws: Laws,
    ) {
        let across = perpendicular(axis);
        let guide = self.marker(bodies[0], at_m);
        for (along, side) in [(0.5, 1.0), (-0.5, 1.0), (0.5, -1.0), (-0.5, -1.0)] {
            let corner = std::array::from_fn(|k| {
                at_m[k] + along * length_m * axis[k] + 0.5 * side * height_m * across[k]
            });
            let normal = frame(&self.frames, bodies[0]).turned_back(across.map(|n| side * n));
            let half_width_m = 0.5 * height_m + clearance_m;
            let corner = self.marker(bodies[1], corner);
            self.contact(ContactKind::Corner { guide, normal, half_width_m, corner }, laws);
        }
        let closing = [self.component(bodies, at_m, across), self.angle(bodies, at_m)];
        self.mechanism.closing.extend(closing);
    }

    fn contact(&mut self, kind: ContactKind, (law, friction): Laws) {
        self.mechanism.contacts.push(Contact { kind, law, friction, bristle: None });
    }

    /// Adds a spring with a damper between a point of the first body and one of the second; without
    /// a free length it is free at the start. Units N/m, N s/m, m.
    pub(crate) fn spring(
        &mut self,
        bodies: [BodyIndex; 2],
        ends_m: [[f64; 2]; 2],
        (stiffness, damping): (f64, f64),
        free_length_m: Option<f64>,
    ) {
        let along = subtract(ends_m[1], ends_m[0]);
        let kind = SpringKind::Linear(free_length_m.unwrap_or(dot(along, along).sqrt()));
        let (first, second) = (self.marker(bodies[0], ends_m[0]), self.marker(bodies[1], ends_m[1]));
        self.mechanism.springs.push(Spring { first, second, kind, stiffness, damping });
    }

    /// Adds a torsional spring with a damper, free at the start. Units N m/rad, N m s/rad.
    pub(crate) fn torsional_spring(&mut self, bodies: [BodyIndex; 2], (stiffness, damping): (f64, f64)) {
        let kind = SpringKind::Torsional(self.angle_rad(bodies[1]) - self.angle_rad(bodies[0]));
        let [first, second] = bodies.map(|body| Marker { body, local_m: [0.0; 2] });
        self.mechanism.springs.push(Spring { first, second, kind, stiffness, damping });
    }

    /// Adds a force in N at a point of a body and a torque in N m.
    pub(crate) fn load(
        &mut self,
        body: BodyIndex,
        at_m: [f64; 2],
        (force_n, torque_nm): ([f64; 2], f64),
        ramp_s: f64,
    ) {
        let at = self.marker(body, at_m);
        self.mechanism.loads.push(Load { at, force_n, torque_nm, ramp_s });
    }

    /// The mechanism.
    pub(crate) fn build(mut self) -> Mechanism {
        for (bodies, at_m) in std::mem::take(&mut self.pivots) {
            let [first, second] = bodies;
            let is_between = first.is_some() && second.is_some();
            if is_between && (self.support_on(first, second, at_m) || self.support_on(second, first, at_m)) {
                continue;
            }
            let joint = self.coincident(bodies, at_m);
            self.mechanism.joints.extend(joint);
        }
        self.mechanism.completed()
    }
}

/// The body of a joint with the ground, and 1 if it is the second one, -1 if it is the first.
const fn of_ground(bodies: [BodyIndex; 2]) -> Option<(usize, f64)> {
    match bodies {
        [None, Some(body)] => Some((body, 1.0)),
        [Some(body), None] => Some((body, -1.0)),
        _ => None,
    }
}
