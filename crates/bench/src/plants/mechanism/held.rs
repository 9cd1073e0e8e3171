//! Contacts of a mechanism whose forces are held over a communication step, as networks give them.
//!
//! At the start of each step the contact is read at the middle of the step, to which the state is
//! extrapolated with its rates, as on the transmission bench. The forces and their directions on
//! both bodies are constant over the step. Their powers are those on the moving bodies, so the
//! energy balance closes whatever the source gives.

use super::body::{Frame, add_to, dot3, frame, scaled};
use super::contact::{Contact, Touch};
use super::energy::Flows;
use crate::plants::transmission::{BearingForces, ContactView};

/// Source of held contact forces.
pub struct HeldForces<'a> {
    /// Communication step in s.
    pub step_s: f64,
    /// True for each contact, in the order of a run, whose forces come from the source.
    pub contacts: Vec<bool>,
    /// Forces of a contact from its view, called once in every step.
    pub force: &'a mut dyn FnMut(usize, &ContactView) -> BearingForces,
}

/// Action of a contact that is held.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    pub(super) forces: BearingForces,
    normal: [[f64; 3]; 2],
    friction: [[f64; 3]; 2],
}

impl Held {
    pub(super) fn new(forces: BearingForces, touch: &Touch) -> Self {
        Self {
            forces,
            normal: touch.normal.map(|direction| scaled(direction, -forces.normal_n)),
            friction: touch.tangent.map(|direction| scaled(direction, forces.friction_n)),
        }
    }

    /// Adds the action to the forces on both bodies, and its losses.
    pub(super) fn act(
        &self,
        contact: &Contact,
        time_s: f64,
        frames: &[Frame],
        force: &mut [[f64; 3]],
        flows: &mut Flows,
    ) {
        let bodies = contact.kind.bodies();
        let pair = bodies.map(|body| frame(frames, body));
        for side in 0..2 {
            add_to(force, bodies[side], self.normal[side], 1.0);
            add_to(force, bodies[side], self.friction[side], 1.0);
        }
        let power =
            |action: &[[f64; 3]; 2]| dot3(action[0], pair[0].rates()) + dot3(action[1], pair[1].rates());
        let (depth_m, rate_m_s) = contact.kind.deformation(time_s, pair);
        flows.contact_damping -= power(&self.normal) + contact.law.elastic.force_n(depth_m) * rate_m_s;
        flows.friction_heat -= power(&self.friction);
    }
}
