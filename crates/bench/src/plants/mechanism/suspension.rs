//! Joints with the ground, and with driven bodies, in closed form.
//!
//! A body that a revolute or prismatic joint connects with the ground has one coordinate `s`, its
//! angle or its displacement from the start, and needs no multiplier for that joint. The
//! accelerations of its coordinates are `q'' = bias + c s''` with the direction `c` of the
//! coordinate (velocity transformation, Kim and Vanderploeg, J. Mech. Trans. Autom. Des. 108,
//! 1986). A drive of that joint prescribes `s`: the body has no coordinate left. A body on a pivot
//! of such a driven body has one coordinate, too. Every other body has three.

use super::body::{Body, Frame, Marker, Point, add, dot, dot3, perpendicular, scaled};
use super::joint::DriveMotion;
use crate::signals::Motion;

/// Joint of a body that is solved in closed form.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) enum Support {
    /// None.
    #[default]
    Free,
    /// Revolute joint.
    Pivot {
        /// Pivot on the ground or on a driven body.
        on: Marker,
        /// Centre of mass from the pivot in the axes of the body, in m.
        centre_m: [f64; 2],
    },
    /// Prismatic joint with the ground.
    Slide {
        /// Unit vector of the axis.
        axis: [f64; 2],
    },
}

/// Freedom of a body in its mechanism.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Suspension {
    pub(crate) support: Support,
    /// Prescribed change of the coordinate, and 1 or -1 for its sense.
    pub(crate) drive: Option<(DriveMotion, f64)>,
    /// The body at the start.
    start: Frame,
    /// Reciprocal masses of its coordinates.
    inverse: [f64; 3],
    /// Index of its first coordinate.
    pub(super) first: usize,
}

/// Accelerations of a body per unit of a generalised force on it.
#[derive(Clone, Copy, Debug)]
pub(super) enum Mobility {
    /// Reciprocal masses of a free body.
    Free([f64; 3]),
    /// Direction of the one coordinate, and its reciprocal generalised mass.
    Along([f64; 3], f64),
    /// A driven body.
    Prescribed,
}

impl Mobility {
    /// Acceleration due to a generalised force.
    #[inline]
    pub(super) fn acceleration(&self, force: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Free(inverse) => std::array::from_fn(|k| inverse[k] * force[k]),
            Self::Along(direction, inverse) => scaled(*direction, inverse * dot3(*direction, force)),
            Self::Prescribed => [0.0; 3],
        }
    }
}

impl Suspension {
    /// A body without support.
    pub(super) fn new(body: &Body) -> Self {
        let start = Frame::new(body.start, body.start_rate);
        let inverse = body.masses().map(|mass| 1.0 / mass);
        Self { support: Support::Free, drive: None, start, inverse, first: 0 }
    }

    /// Returns whether a drive along an axis, or of the angle without one, drives the coordinate.
    pub(super) fn takes_drive(&self, axis: Option<[f64; 2]>) -> bool {
        let is_own = match (self.support, axis) {
            (Support::Pivot { .. }, None) => true,
            (Support::Slide { axis: own }, Some(axis)) => own == axis,
            _ => false,
        };
        is_own && self.drive.is_none()
    }

    /// Returns whether the motion is prescribed.
    #[inline]
    pub(super) const fn is_driven(&self) -> bool {
        self.drive.is_some()
    }

    /// Pivot of the body, if it has one.
    #[inline]
    pub(super) const fn pivot(&self) -> Option<Marker> {
        match self.support {
            Support::Pivot { on, .. } => Some(on),
            _ => None,
        }
    }

    /// Number of coordinates.
    #[inline]
    pub(super) const fn coordinates(&self) -> usize {
        match (self.support, self.drive) {
            (Support::Free, _) => 3,
            (_, None) => 1,
            (_, Some(_)) => 0,
        }
    }

    /// Prescribed motion of the coordinate at a time; at rest without a drive.
    #[inline]
    pub(super) fn motion(&self, time_s: f64) -> Motion {
        let Some((drive, sense)) = &self.drive else { return Motion::default() };
        let Motion { value, rate, acceleration } = drive.at(time_s);
        Motion { value: sense * value, rate: sense * rate, acceleration: sense * acceleration }
    }

    /// The body under a prescribed motion, with its coordinates and their rates, and with the
    /// carrier of its pivot.
    #[inline]
    pub(super) fn frame(&self, motion: &Motion, carrier: &Frame, values: &[f64], rates: &[f64]) -> Frame {
        let triple = |v: &[f64]| <[f64; 3]>::try_from(v).unwrap_or([f64::NAN; 3]);
        let (value, rate) = match (values, rates) {
            ([value], [rate]) => (*value, *rate),
            ([], []) => (motion.value, motion.rate),
            _ => return Frame::new(triple(values), triple(rates)),
        };
        match self.support {
            Support::Pivot { on, centre_m } => {
                let pivot = on.at(carrier);
                let mut frame = Frame::new([0.0, 0.0, self.start.angle_rad + value], [0.0, 0.0, rate]);
                let arm_m = frame.turned(centre_m);
                frame.velocity_m_s = add(pivot.velocity_m_s, frame.velocity_at(arm_m));
                frame.position_m = add(pivot.position_m, arm_m);
                frame
            }
            Support::Slide { axis } => {
                let mut frame = self.start;
                frame.position_m = add(frame.position_m, scaled(axis, value));
                frame.velocity_m_s = scaled(axis, rate);
                frame.speed_rad_s = 0.0;
                frame
            }
            Support::Free => Frame::new([f64::NAN; 3], [f64::NAN; 3]),
        }
    }

    /// Direction of the one coordinate on the coordinates of the body; 0 for a free body.
    #[inline]
    pub(super) fn direction(&self, frame: &Frame) -> [f64; 3] {
        match self.support {
            Support::Free => [0.0; 3],
            Support::Pivot { centre_m, .. } => {
                let [x, y] = perpendicular(frame.turned(centre_m));
                [x, y, 1.0]
            }
            Support::Slide { axis: [x, y] } => [x, y, 0.0],
        }
    }

    /// Supports the body.
    pub(super) fn attach(&mut self, body: &Body, support: Support) {
        self.support = support;
        // The generalised mass of an angle or a displacement does not change with it.
        let direction = self.direction(&self.start);
        self.inverse = [1.0 / dot3(direction, body.impulse(direction)); 3];
    }

    /// Mobility of the body.
    #[inline]
    pub(super) fn mobility(&self, frame: &Frame) -> Mobility {
        match (self.support, self.drive) {
            (Support::Free, _) => Mobility::Free(self.inverse),
            (_, Some(_)) => Mobility::Prescribed,
            (_, None) => Mobility::Along(self.direction(frame), self.inverse[0]),
        }
    }

    /// Acceleration of the body without a force and without an acceleration of its coordinate.
    /// `carrier` is the pivot's body with its acceleration.
    #[inline]
    fn bias(&self, frame: &Frame, carrier: (&Frame, [f64; 3])) -> [f64; 3] {
        let Support::Pivot { on, centre_m } = self.support else { return [0.0; 3] };
        let arm_m = frame.turned(centre_m);
        let square = frame.speed_rad_s * frame.speed_rad_s;
        let Point { arm_m: pivot_m, centripetal_m_s2, .. } = on.at(carrier.0);
        let [ax, ay, angular] = carrier.1;
        [
            ax - angular * pivot_m[1] + centripetal_m_s2[0] - square * arm_m[0],
            ay + angular * pivot_m[0] + centripetal_m_s2[1] - square * arm_m[1],
            0.0,
        ]
    }

    /// Acceleration of the body under a generalised force, without the constraints of other joints.
    #[inline]
    pub(super) fn acceleration(
        &self,
        body: &Body,
        (frame, carrier): (&Frame, (&Frame, [f64; 3])),
        (motion, mobility): (&Motion, &Mobility),
        force: [f64; 3],
    ) -> [f64; 3] {
        let bias = self.bias(frame, carrier);
        let own = match mobility {
            Mobility::Prescribed => scaled(self.direction(frame), motion.acceleration),
            _ => {
                let inertia = body.impulse(bias);
                mobility.acceleration(std::array::from_fn(|k| force[k] - inertia[k]))
            }
        };
        std::array::from_fn(|k| bias[k] + own[k])
    }

    /// Rates of the body per unit rate of a drive: that of its coordinate, or of the carrier of its
    /// pivot. None if the drive does not move it.
    #[inline]
    pub(super) fn driven_direction(
        &self,
        is_own: bool,
        frame: &Frame,
        carrier: (usize, &Frame, &Self),
    ) -> Option<[f64; 3]> {
        if is_own {
            return Some(self.direction(frame));
        }
        let on = self.pivot().filter(|on| on.body == Some(carrier.0))?;
        let [x, y, angle] = carrier.2.direction(carrier.1);
        let [arm_x, arm_y] = on.at(carrier.1).arm_m;
        Some([x - angle * arm_y, y + angle * arm_x, 0.0])
    }

    /// Coordinates of the body, or their rates, from those of its centre of mass and its angle.
    #[inline]
    pub(super) fn reduced(&self, of_body: [f64; 3], out: &mut [f64]) {
        match (self.support, out) {
            (Support::Free, out @ [_, _, _]) => out.copy_from_slice(&of_body),
            (Support::Pivot { .. }, [out]) => *out = of_body[2],
            (Support::Slide { axis }, [out]) => *out = dot(axis, [of_body[0], of_body[1]]),
            _ => {}
        }
    }

    /// The nearest rates to the described ones in the measure of kinetic energy that the support
    /// and its drive allow. `at_rest` is the body with coordinates that do not change.
    pub(super) fn start_rates(&self, body: &Body, at_rest: &Frame) -> [f64; 3] {
        let (direction, motion, carried) = (self.direction(at_rest), self.motion(0.0), at_rest.rates());
        match (self.support, self.drive) {
            (Support::Free, _) => body.start_rate,
            (_, Some(_)) => scaled(direction, motion.rate),
            (_, None) => {
                let momentum = body.impulse(direction);
                let missing = std::array::from_fn(|k| body.start_rate[k] - carried[k]);
                let rate = dot3(momentum, missing) / dot3(momentum, direction);
                std::array::from_fn(|k| carried[k] + rate * direction[k])
            }
        }
    }
}
