//! Rigid bodies of a mechanism and the points fixed to them.
//!
//! A body has the coordinates `x, y` of its centre of mass and its angle, in m and rad, and their
//! rates. The ground is the body `None`: it rests at the origin.

/// Rigid body with its state at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Body {
    /// Mass in kg.
    pub(crate) mass_kg: f64,
    /// Moment of inertia about the centre of mass in kg m2.
    pub(crate) inertia_kg_m2: f64,
    /// Centre of mass in m and angle in rad at the start.
    pub(crate) start: [f64; 3],
    /// Their rates at the start, in m/s and rad/s, before they are made consistent.
    pub(crate) start_rate: [f64; 3],
}

impl Body {
    /// Masses of the three coordinates.
    pub(crate) const fn masses(&self) -> [f64; 3] {
        [self.mass_kg, self.mass_kg, self.inertia_kg_m2]
    }

    /// Momenta at these rates, or forces at these accelerations.
    #[inline]
    pub(crate) fn impulse(&self, [x, y, angle]: [f64; 3]) -> [f64; 3] {
        [self.mass_kg * x, self.mass_kg * y, self.inertia_kg_m2 * angle]
    }
}

/// Position and motion of a body at one state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) position_m: [f64; 2],
    pub(crate) angle_rad: f64,
    sin: f64,
    cos: f64,
    pub(crate) velocity_m_s: [f64; 2],
    pub(crate) speed_rad_s: f64,
}

impl Frame {
    /// The ground.
    pub(crate) const GROUND: Self = Self {
        position_m: [0.0; 2],
        angle_rad: 0.0,
        sin: 0.0,
        cos: 1.0,
        velocity_m_s: [0.0; 2],
        speed_rad_s: 0.0,
    };

    /// Frame of a body with these coordinates and rates.
    #[inline]
    pub(crate) fn new([x, y, angle_rad]: [f64; 3], [vx, vy, speed_rad_s]: [f64; 3]) -> Self {
        let (sin, cos) = angle_rad.sin_cos();
        Self { position_m: [x, y], angle_rad, sin, cos, velocity_m_s: [vx, vy], speed_rad_s }
    }

    /// Rates of the coordinates.
    #[inline]
    pub(crate) fn rates(&self) -> [f64; 3] {
        [self.velocity_m_s[0], self.velocity_m_s[1], self.speed_rad_s]
    }

    /// A direction fixed to the body, in the axes of the ground.
    #[inline]
    pub(crate) fn turned(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.cos * x - self.sin * y, self.sin * x + self.cos * y]
    }

    /// A direction of the ground, in the axes of the body.
    #[inline]
    pub(crate) fn turned_back(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.cos * x + self.sin * y, -self.sin * x + self.cos * y]
    }

    /// Velocity of a point of the body at an arm from the centre of mass.
    #[inline]
    pub(crate) fn velocity_at(&self, arm_m: [f64; 2]) -> [f64; 2] {
        let [vx, vy] = self.velocity_m_s;
        [vx - self.speed_rad_s * arm_m[1], vy + self.speed_rad_s * arm_m[0]]
    }
}

/// Point that is fixed to a body or to the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Marker {
    /// Body; none for the ground.
    pub(crate) body: Option<usize>,
    /// Position in the axes of the body, from its centre of mass, in m.
    pub(crate) local_m: [f64; 2],
}

/// A marker at one state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    /// Position in m.
    pub(crate) position_m: [f64; 2],
    /// Position from the body's centre of mass in m.
    pub(crate) arm_m: [f64; 2],
    /// Velocity in m/s.
    pub(crate) velocity_m_s: [f64; 2],
    /// Acceleration in m/s2 of a body with these rates and no accelerations.
    pub(crate) centripetal_m_s2: [f64; 2],
}

impl Marker {
    /// The marker on its body.
    #[inline]
    pub(crate) fn at(&self, frame: &Frame) -> Point {
        let arm_m = frame.turned(self.local_m);
        let square = frame.speed_rad_s * frame.speed_rad_s;
        Point {
            position_m: add(frame.position_m, arm_m),
            arm_m,
            velocity_m_s: frame.velocity_at(arm_m),
            centripetal_m_s2: [-square * arm_m[0], -square * arm_m[1]],
        }
    }
}

/// Frames of two bodies.
pub(crate) type Pair<'a> = [&'a Frame; 2];

/// Frame of a body, or of the ground.
#[inline]
pub(crate) fn frame(frames: &[Frame], body: Option<usize>) -> &Frame {
    body.and_then(|body| frames.get(body)).unwrap_or(&Frame::GROUND)
}

/// Generalised direction on a body of a unit force along `direction` at an arm.
#[inline]
pub(crate) fn wrench(direction: [f64; 2], arm_m: [f64; 2]) -> [f64; 3] {
    [direction[0], direction[1], cross(arm_m, direction)]
}

#[inline]
pub(crate) fn add(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

#[inline]
pub(crate) fn subtract(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

#[inline]
pub(crate) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[inline]
fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Direction turned by a quarter of a turn.
#[inline]
pub(crate) fn perpendicular([x, y]: [f64; 2]) -> [f64; 2] {
    [-y, x]
}

#[inline]
pub(crate) fn dot3(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(crate) fn scaled<const N: usize>(a: [f64; N], factor: f64) -> [f64; N] {
    a.map(|value| value * factor)
}

/// Adds a generalised force to a body; the ground takes it without effect.
pub(super) fn add_to(force: &mut [[f64; 3]], body: Option<usize>, direction: [f64; 3], size: f64) {
    if let Some(on_body) = body.and_then(|body| force.get_mut(body)) {
        for (sum, component) in on_body.iter_mut().zip(direction) {
            *sum += size * component;
        }
    }
}
