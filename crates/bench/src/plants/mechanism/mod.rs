//! Planar mechanism with ideal joints and clearance joints.
//!
//! `M q'' = f + G^T l`, `G q'' = c - 2 a (G v + g_t) - a^2 g` over `x, y, angle` of the bodies: the
//! constraints `g(q, t) = 0` of ideal joints and drives are differentiated twice, and errors are
//! reduced at the rate `a` (Baumgarte 1972). Joints with the ground are solved in closed form
//! (`suspension`). Clearance joints, guides with clearance and backlash are contacts with a normal
//! and a friction law; the integrator locates their onsets and separations and latches the approach
//! speed.
//!
//! States: the coordinates that the joints with the ground leave each body, their rates, the works
//! of the energy balance (`energy`), and a deflection for each contact whose friction law has
//! bristles. SI. Not modelled: flexible bodies, motion out of the plane, friction in ideal joints,
//! impacts on ideal joints other than through contacts.

mod body;
mod builder;
mod contact;
mod described;
mod energy;
mod force;
mod held;
mod hold;
mod joint;
mod run;
mod solve;
mod suspension;

pub(crate) use body::Body;
pub(crate) use builder::Builder;
pub use energy::MechanismEnergy;
pub use held::HeldForces;
pub(crate) use joint::DriveMotion;
pub use run::{BodyState, ContactState, MechanismRun, Snapshot};
pub(crate) use run::{Resumed, RunOptions};

use super::energy::elastic_energy_j;
use crate::signals::Motion;
use body::{Frame, add_to, dot3, frame};
use contact::{Contact, Touch};
use energy::{Flows, QUADRATURES};
use force::{Load, Spring};
use held::Held;
use joint::{IdealJoint, Row};
use solve::Solver;
use suspension::{Mobility, Support, Suspension};

/// Share of the largest required rate or acceleration by which a constraint may be missed at the
/// start; rounding of dependent constraints leaves a ten-thousandth of it.
const CONTRADICTION: f64 = 1e-6;

/// Place of a drive.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Drive {
    /// Joint of this body with the ground.
    Ground(usize),
    /// Constraint of this index.
    Row(usize),
}

/// A mechanism, ready to be integrated once it is [`completed`](Self::completed).
#[derive(Clone, Debug, Default)]
pub(crate) struct Mechanism {
    pub(crate) bodies: Vec<Body>,
    /// Freedom of each body.
    suspensions: Vec<Suspension>,
    /// Joints that are not solved in closed form.
    pub(crate) joints: Vec<IdealJoint>,
    /// Drives without backlash, in the order of the description.
    drives: Vec<Drive>,
    pub(crate) contacts: Vec<Contact>,
    /// Constraints that close every contact at the start.
    pub(crate) closing: Vec<IdealJoint>,
    pub(crate) springs: Vec<Spring>,
    pub(crate) loads: Vec<Load>,
    /// Acceleration of gravity in m/s2.
    pub(crate) gravity_m_s2: [f64; 2],
    /// Rate in 1/s at which errors of the constraints are reduced.
    pub(crate) stabilisation_per_s: f64,
    masses: Vec<[f64; 3]>,
    coordinates: usize,
    /// Bodies in the order of their evaluation: those that may carry a pivot first.
    order: Vec<usize>,
}

/// Memory of one evaluation: all frames, forces and accelerations of a state.
#[derive(Clone, Debug, Default)]
struct Evaluation {
    motions: Vec<Motion>,
    frames: Vec<Frame>,
    mobilities: Vec<Mobility>,
    force: Vec<[f64; 3]>,
    accelerations: Vec<[f64; 3]>,
    rows: Vec<Row>,
    solver: Solver,
    /// Held action of each contact whose forces do not come from its laws.
    held: Vec<Option<Held>>,
}

impl Mechanism {
    /// Completes a mechanism: numbers the coordinates of the bodies and the bristles of the
    /// contacts.
    pub(crate) fn completed(mut self) -> Self {
        let mut bristles = 0;
        for contact in &mut self.contacts {
            contact.bristle = contact.has_bristles().then_some(bristles);
            bristles += usize::from(contact.has_bristles());
        }
        self.coordinates = 0;
        for suspension in &mut self.suspensions {
            suspension.first = self.coordinates;
            self.coordinates += suspension.coordinates();
        }
        let (first, then): (Vec<usize>, Vec<usize>) =
            (0..self.bodies.len()).partition(|i| self.suspensions[*i].is_driven());
        self.order = [first, then].concat();
        self.masses = self.bodies.iter().map(Body::masses).collect();
        self
    }

    /// Adds a load at the centre of mass of each body, in their order, and returns the index of the
    /// first one.
    pub(crate) fn add_external_loads(&mut self) -> usize {
        let first = self.loads.len();
        let loads = (0..self.bodies.len()).map(Load::at_centre);
        self.loads.extend(loads);
        first
    }

    /// Index of the first work in a state.
    fn works(&self) -> usize {
        2 * self.coordinates
    }

    /// Number of states.
    pub(crate) fn states(&self) -> usize {
        self.works() + QUADRATURES + self.contacts.iter().filter(|c| c.bristle.is_some()).count()
    }

    /// Memory for evaluations.
    fn evaluation(&self) -> Evaluation {
        let held = vec![None; self.contacts.len()];
        Evaluation { solver: Solver::new(self.joints.iter()), held, ..Evaluation::default() }
    }

    /// Frame of a body under a prescribed motion at a state, with the carrier of its pivot.
    #[inline]
    fn frame(&self, body: usize, motion: &Motion, carrier: &Frame, state: &[f64]) -> Frame {
        let suspension = &self.suspensions[body];
        let own = suspension.first..suspension.first + suspension.coordinates();
        let rates = own.start + self.coordinates..own.end + self.coordinates;
        suspension.frame(motion, carrier, &state[own], &state[rates])
    }

    /// Frame of one body at a state.
    fn single_frame(&self, body: usize, time_s: f64, state: &[f64]) -> Frame {
        let suspension = &self.suspensions[body];
        let carrier = suspension.pivot().and_then(|on| on.body);
        let carrier = carrier.map(|body| self.single_frame(body, time_s, state));
        self.frame(body, &suspension.motion(time_s), carrier.as_ref().unwrap_or(&Frame::GROUND), state)
    }

    /// Frames of all bodies at a state.
    pub(crate) fn frames(&self, time_s: f64, state: &[f64]) -> Vec<Frame> {
        (0..self.bodies.len()).map(|body| self.single_frame(body, time_s, state)).collect()
    }

    /// Frames of the two bodies of a contact at a state.
    fn pair(&self, contact: &Contact, time_s: f64, state: &[f64]) -> [Frame; 2] {
        let frame = |body| self.single_frame(body, time_s, state);
        contact.kind.bodies().map(|body| body.map_or(Frame::GROUND, frame))
    }

    /// Deflection of a contact's bristles in m; 0 without bristles.
    fn bristle_m(&self, contact: &Contact, state: &[f64]) -> f64 {
        let index = contact.bristle.map(|index| self.works() + QUADRATURES + index);
        index.and_then(|index| state.get(index)).copied().unwrap_or_default()
    }

    /// State at the start: the described position, and rates that satisfy every constraint, those
    /// of closed contacts too if `is_closed`. Of all such rates they are the nearest to the
    /// described ones in the measure of kinetic energy (Gauss' principle).
    pub(crate) fn initial_state(&self, is_closed: bool) -> Vec<f64> {
        let mut state = vec![0.0; self.states()];
        for (body, suspension) in self.bodies.iter().zip(&self.suspensions) {
            if let Support::Free = suspension.support {
                state[suspension.first..suspension.first + 3].copy_from_slice(&body.start);
            }
        }
        let frames = self.frames(0.0, &state);
        let joints = || self.joints.iter().chain(if is_closed { &self.closing[..] } else { &[] });
        let rows: Vec<Row> = joints().map(|joint| joint.row(0.0, &frames)).collect();
        let bodies = self.bodies.iter().zip(&self.suspensions).zip(&frames);
        let mut rates: Vec<[f64; 3]> = bodies.map(|((body, s), at)| s.start_rates(body, at)).collect();
        let mobilities = self.mobilities(&frames);
        let masses = (&mobilities[..], &self.masses[..]);
        Solver::new(joints()).constrain(&rows, masses, |row| -row.drive_rate, &mut rates);
        let (_, own) = state.split_at_mut(self.coordinates);
        for (suspension, rates) in self.suspensions.iter().zip(rates) {
            let range = suspension.first..suspension.first + suspension.coordinates();
            suspension.reduced(rates, &mut own[range]);
        }
        state
    }

    fn mobilities(&self, frames: &[Frame]) -> Vec<Mobility> {
        self.suspensions.iter().zip(frames).map(|(suspension, frame)| suspension.mobility(frame)).collect()
    }

    /// Returns true if no rates, or no accelerations, satisfy all ideal joints and drives at the
    /// start: two drives of one joint, or a drive of a mechanism without a degree of freedom.
    pub(crate) fn is_contradictory(&self) -> bool {
        let frames = self.frames(0.0, &self.initial_state(false));
        let rows: Vec<Row> = self.joints.iter().map(|joint| joint.row(0.0, &frames)).collect();
        let mobilities = self.mobilities(&frames);
        let is_missed = |mut found: Vec<[f64; 3]>, target: fn(&Row) -> f64| {
            let size = |row: &Row| target(row).abs() + row.applied(|body| found[body]).abs();
            let size = rows.iter().map(size).fold(0.0, f64::max);
            let masses = (&mobilities[..], &self.masses[..]);
            Solver::new(self.joints.iter()).constrain(&rows, masses, target, &mut found);
            let missed = |row: &Row| (row.applied(|body| found[body]) - target(row)).abs();
            rows.iter().any(|row| missed(row) > CONTRADICTION * size)
        };
        let state = self.initial_state(false);
        let still = [&state[..self.coordinates], &vec![0.0; self.states() - self.coordinates]].concat();
        let rates = self.frames(0.0, &still).iter().map(Frame::rates).collect();
        let mut evaluation = self.evaluation();
        evaluation.place(self, 0.0, &state);
        evaluation.accelerate_freely(self);
        is_missed(rates, |row| -row.drive_rate) || is_missed(evaluation.accelerations, |row| row.target)
    }

    /// Computes the derivative of a state, with the latched approach speed of each contact, `None`
    /// in a gap.
    fn state_derivative(
        &self,
        (time_s, state): (f64, &[f64]),
        latched_m_s: &[Option<f64>],
        evaluation: &mut Evaluation,
        derivative: &mut [f64],
    ) {
        let flows =
            self.evaluate((time_s, state), latched_m_s, self.stabilisation_per_s, evaluation, derivative);
        let coordinates = self.coordinates;
        derivative[..coordinates].copy_from_slice(&state[coordinates..2 * coordinates]);
        for (suspension, acceleration) in self.suspensions.iter().zip(&evaluation.accelerations) {
            let first = coordinates + suspension.first;
            let own = first..first + suspension.coordinates();
            suspension.reduced(*acceleration, &mut derivative[own]);
        }
        derivative[2 * coordinates..2 * coordinates + QUADRATURES].copy_from_slice(&flows.to_array());
    }

    /// Computes forces and accelerations at a state; writes the rates of the bristles.
    fn evaluate(
        &self,
        (time_s, state): (f64, &[f64]),
        latched_m_s: &[Option<f64>],
        stabilisation_per_s: f64,
        evaluation: &mut Evaluation,
        derivative: &mut [f64],
    ) -> Flows {
        let mut flows = Flows::default();
        evaluation.place(self, time_s, state);
        self.add_applied(time_s, &evaluation.frames, &mut evaluation.force, &mut flows);
        for (i, (contact, latched)) in self.contacts.iter().zip(latched_m_s).enumerate() {
            if let Some(held) = &evaluation.held[i] {
                held.act(contact, time_s, &evaluation.frames, &mut evaluation.force, &mut flows);
                continue;
            }
            let bristle = contact.bristle.map(|index| self.works() + QUADRATURES + index);
            let Some(latched) = *latched else {
                // Without a load a bristle keeps its deflection.
                bristle.into_iter().for_each(|index| derivative[index] = 0.0);
                continue;
            };
            let bodies = contact.kind.bodies();
            let touch = contact.kind.at(time_s, bodies.map(|body| frame(&evaluation.frames, body)));
            let bristle_m = self.bristle_m(contact, state);
            if let (Some(index), Some(law)) = (bristle, &contact.friction) {
                derivative[index] = law.rate_m_s(touch.sliding_m_s, bristle_m);
            }
            let (normal_n, friction_n) = contact.forces_n(&touch, latched, bristle_m);
            add_forces(&mut evaluation.force, bodies, &touch, normal_n, friction_n);
            let elastic_n = contact.law.elastic.force_n(touch.depth_m);
            flows.add_drive(normal_n * touch.drive_rate_m_s);
            flows.contact_damping += (normal_n - elastic_n) * touch.rate_m_s;
            flows.friction_heat -= friction_n * touch.sliding_m_s;
        }
        evaluation.accelerate(self, time_s, stabilisation_per_s);
        for drive in &self.drives {
            let rate = match *drive {
                Drive::Ground(body) => evaluation.motions[body].rate * self.sense(body),
                Drive::Row(row) => -evaluation.rows[row].drive_rate,
            };
            flows.add_drive(self.drive_force(drive, evaluation) * rate);
        }
        flows
    }

    /// Sense of the drive of a body's joint with the ground.
    fn sense(&self, body: usize) -> f64 {
        self.suspensions[body].drive.map_or(1.0, |(_, sense)| sense)
    }

    /// Force or torque of a drive in N or N m on its coordinate after an evaluation: its
    /// multiplier, or by the principle of virtual power what the bodies that it carries need.
    fn drive_force(&self, drive: &Drive, evaluation: &Evaluation) -> f64 {
        let multipliers = evaluation.solver.multipliers();
        let body = match *drive {
            Drive::Row(row) => return multipliers[row],
            Drive::Ground(body) => body,
        };
        let carrier = (body, &evaluation.frames[body], &self.suspensions[body]);
        let mut force = 0.0;
        for (i, suspension) in self.suspensions.iter().enumerate() {
            let direction = suspension.driven_direction(i == body, &evaluation.frames[i], carrier);
            let Some(direction) = direction else { continue };
            force += dot3(direction, self.bodies[i].impulse(evaluation.accelerations[i]));
            force -= dot3(direction, evaluation.force[i]);
            for (row, multiplier) in evaluation.rows.iter().zip(multipliers) {
                for (side, jacobian) in row.bodies.into_iter().zip(row.jacobian) {
                    if side == Some(i) {
                        force -= dot3(direction, jacobian) * multiplier;
                    }
                }
            }
        }
        force * self.sense(body)
    }

    /// Adds gravity, springs and loads.
    fn add_applied(&self, time_s: f64, frames: &[Frame], force: &mut [[f64; 3]], flows: &mut Flows) {
        for (body, force) in self.bodies.iter().zip(force.iter_mut()) {
            force[0] += body.mass_kg * self.gravity_m_s2[0];
            force[1] += body.mass_kg * self.gravity_m_s2[1];
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

    /// Forces and torques of the drives in N and N m, in the order of the description.
    fn drive_forces(
        &self,
        time_s: f64,
        state: &[f64],
        latched_m_s: &[Option<f64>],
        evaluation: &mut Evaluation,
    ) -> Vec<f64> {
        let mut unused = vec![0.0; self.states()];
        self.evaluate((time_s, state), latched_m_s, 0.0, evaluation, &mut unused);
        self.drives.iter().map(|drive| self.drive_force(drive, evaluation)).collect()
    }

    /// Kinetic energy of a state in J.
    pub(crate) fn kinetic_j(&self, time_s: f64, state: &[f64]) -> f64 {
        let frames = self.frames(time_s, state);
        let of_body = |(body, frame): (&Body, &Frame)| 0.5 * dot3(body.impulse(frame.rates()), frame.rates());
        self.bodies.iter().zip(&frames).map(of_body).sum()
    }

    /// Energy of gravity, springs and contacts in a state, in J.
    pub(crate) fn potential_j(&self, time_s: f64, state: &[f64]) -> f64 {
        let frames = self.frames(time_s, state);
        let mut sum = 0.0;
        for (body, frame) in self.bodies.iter().zip(&frames) {
            let [x, y] = frame.position_m;
            sum -= body.mass_kg * (self.gravity_m_s2[0] * x + self.gravity_m_s2[1] * y);
        }
        for spring in &self.springs {
            sum += 0.5 * spring.stiffness * spring.at(&frames).extension.powi(2);
        }
        for contact in &self.contacts {
            let pair = contact.kind.bodies().map(|body| frame(&frames, body));
            sum += elastic_energy_j(&contact.law.elastic, contact.kind.deformation(time_s, pair).0);
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
        let kinetic = [self.kinetic_j(start_s, first), self.kinetic_j(end_s, last)];
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

impl Evaluation {
    /// Places the bodies of a state, without forces.
    fn place(&mut self, mechanism: &Mechanism, time_s: f64, state: &[f64]) {
        let count = mechanism.bodies.len();
        self.motions.resize(count, Motion::default());
        self.frames.resize(count, Frame::GROUND);
        self.mobilities.resize(count, Mobility::Prescribed);
        self.accelerations.resize(count, [0.0; 3]);
        for &i in &mechanism.order {
            let suspension = &mechanism.suspensions[i];
            self.motions[i] = suspension.motion(time_s);
            let carrier = frame(&self.frames, suspension.pivot().and_then(|on| on.body));
            self.frames[i] = mechanism.frame(i, &self.motions[i], carrier, state);
            self.mobilities[i] = suspension.mobility(&self.frames[i]);
        }
        self.force.clear();
        self.force.resize(count, [0.0; 3]);
    }

    /// Computes the accelerations under the applied forces without the constraints.
    fn accelerate_freely(&mut self, mechanism: &Mechanism) {
        for &i in &mechanism.order {
            let suspension = &mechanism.suspensions[i];
            let carrier = suspension.pivot().and_then(|on| on.body);
            let at = carrier.map_or([0.0; 3], |body| self.accelerations[body]);
            let place = (&self.frames[i], (frame(&self.frames, carrier), at));
            let freedom = (&self.motions[i], &self.mobilities[i]);
            let body = &mechanism.bodies[i];
            self.accelerations[i] = suspension.acceleration(body, place, freedom, self.force[i]);
        }
    }

    /// Computes accelerations and multipliers under the applied forces.
    fn accelerate(&mut self, mechanism: &Mechanism, time_s: f64, stabilisation_per_s: f64) {
        self.accelerate_freely(mechanism);
        let Self { frames, mobilities, accelerations, rows, solver, .. } = self;
        if mechanism.joints.is_empty() {
            return;
        }
        rows.clear();
        rows.extend(mechanism.joints.iter().map(|joint| joint.row(time_s, frames)));
        let a = stabilisation_per_s;
        let target = |row: &Row| {
            let rate = row.applied(|body| frames[body].rates()) + row.drive_rate;
            row.target - 2.0 * a * rate - a * a * row.value
        };
        solver.constrain(rows, (mobilities, &mechanism.masses), target, accelerations);
    }
}

/// Adds normal and friction force of a contact to both bodies.
fn add_forces(
    force: &mut [[f64; 3]],
    bodies: [Option<usize>; 2],
    touch: &Touch,
    normal_n: f64,
    friction_n: f64,
) {
    for (side, body) in bodies.into_iter().enumerate() {
        add_to(force, body, touch.normal[side], -normal_n);
        add_to(force, body, touch.tangent[side], friction_n);
    }
}
