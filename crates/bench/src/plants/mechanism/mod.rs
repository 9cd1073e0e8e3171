//! Planar mechanism with ideal joints and clearance joints.
//!
//! `M q'' + G^T l = f`, `G q'' = c - 2 a (G v + g_t) - a^2 g` over the coordinates `x, y, angle` of
//! the bodies: the constraints `g(q, t) = 0` of ideal joints and drives are differentiated twice,
//! and errors are reduced at the rate `a` (Baumgarte 1972). Clearance joints, guides with clearance
//! and backlash are contacts with a normal and a friction law; the integrator locates their onsets
//! and separations and latches the approach speed.
//!
//! States: coordinates, rates, the works of the energy balance (`energy`), and a deflection for
//! each contact whose friction law has bristles. SI. Not modelled: flexible bodies, motion out of
//! the plane, friction in ideal joints, impacts on ideal joints other than through contacts.

mod body;
mod builder;
mod contact;
mod described;
mod energy;
mod force;
mod joint;
mod run;
mod solve;

pub(crate) use body::Body;
pub(crate) use builder::Builder;
pub use energy::MechanismEnergy;
pub(crate) use joint::DriveMotion;
pub(crate) use run::RunOptions;
pub use run::{BodyState, ContactState, MechanismRun, Snapshot};

use super::energy::elastic_energy_j;
use body::Frame;
use contact::{Contact, Touch};
use energy::{Flows, QUADRATURES};
use force::{Load, Spring};
use joint::{IdealJoint, Row};
use solve::{applied, constrain};

/// Share of the largest required rate or acceleration by which a constraint may be missed at the
/// start; rounding of dependent constraints leaves a ten-thousandth of it.
const CONTRADICTION: f64 = 1e-6;

/// A mechanism, ready to be integrated once it is [`completed`](Self::completed).
#[derive(Clone, Debug, Default)]
pub(crate) struct Mechanism {
    pub(crate) bodies: Vec<Body>,
    pub(crate) joints: Vec<IdealJoint>,
    pub(crate) contacts: Vec<Contact>,
    /// Constraints that close every contact at the start.
    pub(crate) closing: Vec<IdealJoint>,
    pub(crate) springs: Vec<Spring>,
    pub(crate) loads: Vec<Load>,
    /// Acceleration of gravity in m/s2.
    pub(crate) gravity_m_s2: [f64; 2],
    /// Rate in 1/s at which errors of the constraints are reduced.
    pub(crate) stabilisation_per_s: f64,
    inverse: Vec<[f64; 3]>,
}

impl Mechanism {
    /// Completes a mechanism: numbers the bristles in the order of the contacts, and inverts the
    /// masses.
    pub(crate) fn completed(mut self) -> Self {
        let mut bristles = 0;
        for contact in &mut self.contacts {
            contact.bristle = contact.has_bristles().then_some(bristles);
            bristles += usize::from(contact.has_bristles());
        }
        let inverse = |body: &Body| [1.0 / body.mass_kg, 1.0 / body.mass_kg, 1.0 / body.inertia_kg_m2];
        self.inverse = self.bodies.iter().map(inverse).collect();
        self
    }

    /// Number of coordinates.
    fn coordinates(&self) -> usize {
        3 * self.bodies.len()
    }

    /// Index of the first work in a state.
    fn works(&self) -> usize {
        2 * self.coordinates()
    }

    /// Number of states.
    pub(crate) fn states(&self) -> usize {
        self.works() + QUADRATURES + self.contacts.iter().filter(|c| c.bristle.is_some()).count()
    }

    /// Frames of all bodies at a state.
    pub(crate) fn frames(&self, state: &[f64]) -> Vec<Frame> {
        let (q, v) = state.split_at(self.coordinates().min(state.len()));
        let triple = |values: &[f64], body: usize| {
            std::array::from_fn(|k| values.get(3 * body + k).copied().unwrap_or(f64::NAN))
        };
        (0..self.bodies.len()).map(|body| Frame::new(triple(q, body), triple(v, body))).collect()
    }

    /// Deflection of a contact's bristles in m; 0 without bristles.
    fn bristle_m(&self, contact: &Contact, state: &[f64]) -> f64 {
        let index = contact.bristle.map(|index| self.works() + QUADRATURES + index);
        index.and_then(|index| state.get(index)).copied().unwrap_or_default()
    }

    /// Constraints at a time and a state.
    fn rows(&self, time_s: f64, frames: &[Frame]) -> Vec<Row> {
        self.joints.iter().map(|joint| joint.row(time_s, frames)).collect()
    }

    /// State at the start: the described position, and rates that satisfy every constraint, those
    /// of closed contacts too if `is_closed`. Of all such rates they are the nearest to the
    /// described ones in the measure of kinetic energy (Gauss' principle).
    pub(crate) fn initial_state(&self, is_closed: bool) -> Vec<f64> {
        let mut state = vec![0.0; self.states()];
        for (i, body) in self.bodies.iter().enumerate() {
            state[3 * i..3 * i + 3].copy_from_slice(&body.start);
        }
        let mut rates: Vec<f64> = self.bodies.iter().flat_map(|body| body.start_rate).collect();
        let frames = self.frames(&state);
        let mut rows = self.rows(0.0, &frames);
        if is_closed {
            rows.extend(self.closing.iter().map(|joint| joint.row(0.0, &frames)));
        }
        let target: Vec<f64> = rows.iter().map(|row| -row.drive_rate).collect();
        constrain(&rows, &self.inverse, &target, &mut rates);
        let coordinates = self.coordinates();
        state[coordinates..2 * coordinates].copy_from_slice(&rates);
        state
    }

    /// Returns true if no rates, or no accelerations, satisfy all ideal joints and drives at the
    /// start: two drives of one joint, or a drive of a mechanism without a degree of freedom.
    pub(crate) fn is_contradictory(&self) -> bool {
        let rows = self.rows(0.0, &self.frames(&self.initial_state(false)));
        let is_missed = |target: Vec<f64>| {
            let mut found = vec![0.0; self.coordinates()];
            constrain(&rows, &self.inverse, &target, &mut found);
            let size = target.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            let missed =
                |(row, target): (&Row, &f64)| (applied(row, &found) - target).abs() > CONTRADICTION * size;
            rows.iter().zip(&target).any(missed)
        };
        is_missed(rows.iter().map(|row| -row.drive_rate).collect())
            || is_missed(rows.iter().map(|row| row.target).collect())
    }

    /// Computes the derivative of a state, with the latched approach speed of each contact, `None`
    /// in a gap.
    pub(crate) fn state_derivative(
        &self,
        time_s: f64,
        state: &[f64],
        latched_m_s: &[Option<f64>],
        derivative: &mut [f64],
    ) {
        let coordinates = self.coordinates();
        let frames = self.frames(state);
        let mut flows = Flows::default();
        let mut force = vec![0.0; coordinates];
        self.add_applied(time_s, &frames, &mut force, &mut flows);
        for (contact, latched) in self.contacts.iter().zip(latched_m_s) {
            let touch = contact.kind.at(time_s, &frames);
            let bristle_m = self.bristle_m(contact, state);
            if let (Some(index), Some(law)) = (contact.bristle, &contact.friction) {
                // Without a load a bristle keeps its deflection.
                let rate = latched.map_or(0.0, |_| law.rate_m_s(touch.sliding_m_s, bristle_m));
                derivative[self.works() + QUADRATURES + index] = rate;
            }
            let Some(latched) = *latched else { continue };
            let (normal_n, friction_n) = contact.forces_n(&touch, latched, bristle_m);
            add_forces(&mut force, &touch, normal_n, friction_n);
            let elastic_n = contact.law.elastic.force_n(touch.depth_m);
            let drive_w = normal_n * touch.drive_rate_m_s;
            flows.drive_work += drive_w;
            flows.absolute_work += drive_w.abs();
            flows.contact_damping += (normal_n - elastic_n) * touch.rate_m_s;
            flows.friction_heat -= friction_n * touch.sliding_m_s;
        }
        let accelerations = self.accelerate(time_s, &frames, state, force, &mut flows);
        derivative[..coordinates].copy_from_slice(&state[coordinates..2 * coordinates]);
        derivative[coordinates..2 * coordinates].copy_from_slice(&accelerations);
        derivative[2 * coordinates..2 * coordinates + QUADRATURES].copy_from_slice(&flows.to_array());
    }

    /// Adds gravity, springs and loads.
    fn add_applied(&self, time_s: f64, frames: &[Frame], force: &mut [f64], flows: &mut Flows) {
        for (i, body) in self.bodies.iter().enumerate() {
            force[3 * i] += body.mass_kg * self.gravity_m_s2[0];
            force[3 * i + 1] += body.mass_kg * self.gravity_m_s2[1];
        }
        for spring in &self.springs {
            let at = spring.at(frames);
            let tension = spring.stiffness * at.extension + spring.damping * at.rate;
            for (body, direction) in at.bodies.into_iter().zip(at.direction) {
                add_to(force, body, direction, -tension);
            }
            flows.damper_heat += spring.damping * at.rate * at.rate;
        }
        for load in &self.loads {
            let (on_body, power_w) = load.at_state(time_s, frames);
            add_to(force, load.at.body, on_body, 1.0);
            flows.load_work += power_w;
            flows.absolute_work += power_w.abs();
        }
    }

    /// Accelerations under the applied forces and the constraints; adds the work of the drives.
    fn accelerate(
        &self,
        time_s: f64,
        frames: &[Frame],
        state: &[f64],
        force: Vec<f64>,
        flows: &mut Flows,
    ) -> Vec<f64> {
        let mut accelerations = force;
        for (value, inverse) in accelerations.iter_mut().zip(self.inverse.iter().flatten()) {
            *value *= inverse;
        }
        let rows = self.rows(time_s, frames);
        let rates = state.get(self.coordinates()..).unwrap_or_default();
        let a = self.stabilisation_per_s;
        let target: Vec<f64> = rows
            .iter()
            .map(|row| row.target - 2.0 * a * (applied(row, rates) + row.drive_rate) - a * a * row.value)
            .collect();
        let multipliers = constrain(&rows, &self.inverse, &target, &mut accelerations);
        for (row, multiplier) in rows.iter().zip(&multipliers) {
            let drive_w = -multiplier * row.drive_rate;
            flows.drive_work += drive_w;
            flows.absolute_work += drive_w.abs();
        }
        accelerations
    }

    /// Forces and torques of the constraints in N and N m, in the order of the joints.
    pub(crate) fn multipliers(&self, time_s: f64, state: &[f64], latched_m_s: &[Option<f64>]) -> Vec<f64> {
        let frames = self.frames(state);
        let mut force = vec![0.0; self.coordinates()];
        self.add_applied(time_s, &frames, &mut force, &mut Flows::default());
        for (contact, latched) in self.contacts.iter().zip(latched_m_s) {
            let Some(latched) = *latched else { continue };
            let touch = contact.kind.at(time_s, &frames);
            let (normal_n, friction_n) = contact.forces_n(&touch, latched, self.bristle_m(contact, state));
            add_forces(&mut force, &touch, normal_n, friction_n);
        }
        let mut free: Vec<f64> =
            force.iter().zip(self.inverse.iter().flatten()).map(|(f, i)| f * i).collect();
        let rows = self.rows(time_s, &frames);
        let target: Vec<f64> = rows.iter().map(|row| row.target).collect();
        constrain(&rows, &self.inverse, &target, &mut free)
    }

    /// Kinetic energy of a state in J.
    pub(crate) fn kinetic_j(&self, state: &[f64]) -> f64 {
        let frames = self.frames(state);
        let of_body = |(body, frame): (&Body, &Frame)| {
            let [vx, vy, w] = frame.rates();
            0.5 * (body.mass_kg * (vx * vx + vy * vy) + body.inertia_kg_m2 * w * w)
        };
        self.bodies.iter().zip(&frames).map(of_body).sum()
    }

    /// Energy of gravity, springs and contacts in a state, in J.
    pub(crate) fn potential_j(&self, time_s: f64, state: &[f64]) -> f64 {
        let frames = self.frames(state);
        let mut sum = 0.0;
        for (body, frame) in self.bodies.iter().zip(&frames) {
            let [x, y] = frame.position_m;
            sum -= body.mass_kg * (self.gravity_m_s2[0] * x + self.gravity_m_s2[1] * y);
        }
        for spring in &self.springs {
            sum += 0.5 * spring.stiffness * spring.at(&frames).extension.powi(2);
        }
        for contact in &self.contacts {
            sum += elastic_energy_j(&contact.law.elastic, contact.kind.at(time_s, &frames).depth_m);
        }
        sum
    }

    /// Terms of the energy balance between two states.
    pub(crate) fn balance(
        &self,
        (start_s, first): (f64, &[f64]),
        (end_s, last): (f64, &[f64]),
    ) -> MechanismEnergy {
        let work = |i: usize| last[self.works() + i] - first[self.works() + i];
        let kinetic = [self.kinetic_j(first), self.kinetic_j(last)];
        MechanismEnergy {
            drive_work_j: work(0),
            absolute_work_j: work(1),
            load_work_j: work(2),
            damper_heat_j: work(3),
            contact_damping_j: work(4),
            friction_heat_j: work(5),
            kinetic_change_j: kinetic[1] - kinetic[0],
            potential_change_j: self.potential_j(end_s, last) - self.potential_j(start_s, first),
            kinetic_j: kinetic[0].max(kinetic[1]),
        }
    }
}

/// Adds a generalised force to a body; the ground takes it without effect.
fn add_to(force: &mut [f64], body: Option<usize>, direction: [f64; 3], size: f64) {
    if let Some(on_body) = body.and_then(|body| force.get_mut(3 * body..3 * body + 3)) {
        for (sum, component) in on_body.iter_mut().zip(direction) {
            *sum += size * component;
        }
    }
}

/// Adds normal and friction force of a contact to both bodies.
fn add_forces(force: &mut [f64], touch: &Touch, normal_n: f64, friction_n: f64) {
    for (side, body) in touch.bodies.into_iter().enumerate() {
        add_to(force, body, touch.normal[side], -normal_n);
        add_to(force, body, touch.tangent[side], friction_n);
    }
}
