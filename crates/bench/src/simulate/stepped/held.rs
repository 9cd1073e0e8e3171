//! Steps of the transmission bench under a bearing force that is held over each of them.

use crate::integrate::{ContactAngles, ContactPlant, Impact, IntegrationError};
use crate::plants::transmission::{
    BearingForces, ContactView, OnShaft, STATES, Snapshot, State, Transmission,
};
use serde::{Deserialize, Serialize};

/// Contact whose force is held over each step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HeldContact {
    /// Approach speed at the onset of the contact in m/s; none in a gap.
    latched_m_s: Option<f64>,
    /// Period in contact so far; none in a gap.
    pub impact: Option<Impact>,
}

impl HeldContact {
    /// Latched approach speed in m/s; 0 in a gap.
    pub fn latched_m_s(&self) -> f64 {
        self.latched_m_s.unwrap_or_default()
    }

    /// Opens or closes the latch for a view, writes the latched speed into it, and returns the
    /// period in contact that has ended.
    pub fn switch(
        &mut self,
        time_s: f64,
        view: &mut ContactView,
        angles: impl FnOnce() -> ContactAngles,
    ) -> Option<Impact> {
        let touches = view.deformation_m > 0.0;
        view.latched_m_s = self.latched_m_s();
        if touches == self.latched_m_s.is_some() {
            return None;
        }
        if touches {
            view.latched_m_s = view.rate_m_s.max(0.0);
            self.latched_m_s = Some(view.latched_m_s);
            self.impact = Some(Impact {
                onset_s: time_s,
                peak_s: time_s,
                approach_speed_m_s: view.latched_m_s,
                angles: angles(),
                ..Impact::default()
            });
            return None;
        }
        (self.latched_m_s, view.latched_m_s) = (None, 0.0);
        let mut ended = self.impact.take()?;
        ended.separation_s = Some(time_s);
        ended.separation_speed_m_s = -view.rate_m_s;
        Some(ended)
    }

    /// Adds a step with a normal force to the open period in contact.
    pub fn measure(&mut self, (time_s, step_s): (f64, f64), view: &ContactView, normal_n: f64) {
        let Some(impact) = &mut self.impact else { return };
        impact.max_deformation_m = impact.max_deformation_m.max(view.deformation_m);
        let work_j = normal_n * view.rate_m_s * step_s;
        impact.energy_lost_j += work_j;
        impact.compression_work_j += work_j.max(0.0);
        if normal_n > impact.peak_force_n {
            (impact.peak_force_n, impact.peak_s) = (normal_n, time_s);
        }
    }
}

/// State of the bench under a held force between two steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::simulate) struct HeldMemory {
    pub(super) state: State,
    /// Rates at the state, which extrapolate it to the middle of the next step.
    rates: State,
    pub(in crate::simulate) contact: HeldContact,
}

/// Readings of one step under a held force.
pub(in crate::simulate) struct Moment {
    /// State of the bench at the start of the step, with the forces held from then on.
    pub(in crate::simulate) snapshot: Snapshot,
    /// Losses up to the start of the step in J, as in [`crate::simulate::Run`].
    pub(in crate::simulate) losses_j: [f64; 3],
    /// Loss of holding the force over the step in J.
    pub(in crate::simulate) hold_loss_j: f64,
    /// Contact that ended at the start of the step.
    pub(in crate::simulate) ended: Option<Impact>,
}

impl HeldMemory {
    /// Bench at its start, in a gap.
    pub(in crate::simulate) fn start(plant: &Transmission, time_s: f64) -> Self {
        let (state, mut rates) = (plant.initial_state(time_s), [0.0; STATES]);
        plant.dynamics(time_s, &state, &OnShaft::default(), &mut rates);
        Self { state, rates, contact: HeldContact::default() }
    }

    /// State reached.
    pub(in crate::simulate) fn state(&self) -> &State {
        &self.state
    }

    /// Takes a step. `force` reads the contact once, extrapolated to the middle of the step; its
    /// components are held in the direction of the contact there, with the description's effects
    /// on friction applied.
    pub(in crate::simulate) fn step(
        &mut self,
        plant: &Transmission,
        time_s: f64,
        step_s: f64,
        force: &mut dyn FnMut(&ContactView) -> BearingForces,
    ) -> Result<Moment, IntegrationError> {
        let stopped = |reason: &str| IntegrationError::Stopped { time_s, reason: reason.into() };
        let half = 0.5 * step_s;
        let middle: State = std::array::from_fn(|i| self.state[i] + half * self.rates[i]);
        let geometry = plant.geometry(time_s + half, &middle);
        let mut view = plant.view(&geometry, 0.0);
        let state = &self.state;
        let ended = self.contact.switch(time_s, &mut view, || plant.angles(time_s, state));
        let forces = plant.with_effects(time_s + half, &middle, &view, force(&view));
        if !(forces.normal_n.is_finite() && forces.friction_n.is_finite()) {
            return Err(stopped("the bearing force is not finite"));
        }
        self.contact.measure((time_s, step_s), &view, forces.normal_n);
        let snapshot = plant.snapshot(time_s, &self.state, self.contact.latched_m_s(), forces);
        let losses_j = plant.losses_j(&self.state);
        let bearing = plant.on_shaft_at(&geometry, &forces);
        let hold_loss_j;
        (self.state, self.rates, hold_loss_j) = runge_kutta(plant, &bearing, time_s, &self.state, step_s);
        if self.state.iter().all(|v| v.is_finite()) {
            Ok(Moment { snapshot, losses_j, hold_loss_j, ended })
        } else {
            Err(stopped("the state is no longer finite"))
        }
    }
}

/// Takes one step of the classical fourth-order Runge-Kutta method under a held bearing force, and
/// returns the state, its rates under that force, and the loss of holding it in J. Every
/// communication step begins with another force, so a library's stepper would have to be set up
/// anew each time.
fn runge_kutta(
    plant: &Transmission,
    bearing: &OnShaft,
    time_s: f64,
    state: &State,
    step_s: f64,
) -> (State, State, f64) {
    let rates = |time_s: f64, state: &State| {
        let mut rates = [0.0; STATES];
        let hold_loss_w = plant.dynamics(time_s, state, bearing, &mut rates);
        (rates, hold_loss_w)
    };
    let half = 0.5 * step_s;
    let along = |rates: &State, by: f64| -> State { std::array::from_fn(|i| state[i] + by * rates[i]) };
    let (first, loss_1) = rates(time_s, state);
    let (second, loss_2) = rates(time_s + half, &along(&first, half));
    let (third, loss_3) = rates(time_s + half, &along(&second, half));
    let (fourth, loss_4) = rates(time_s + step_s, &along(&third, step_s));
    let sum = |i: usize| first[i] + 2.0 * (second[i] + third[i]) + fourth[i];
    // The last stage's rates equal those of the end up to the method's own order.
    let hold_loss_j = step_s / 6.0 * (loss_1 + 2.0 * (loss_2 + loss_3) + loss_4);
    (std::array::from_fn(|i| state[i] + step_s / 6.0 * sum(i)), fourth, hold_loss_j)
}
