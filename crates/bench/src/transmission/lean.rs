//! The plant with those of its states alone that the sensors' truths depend on: what a diagnosis simulates hundreds of times.
//!
//! The works and losses of the energy balance are quadratures that nothing feeds back, and most effects that have a memory are
//! absent: of [`STATES`] states the rigid plant without memories moves [`PLAIN`]. The same equations, the same tolerance of every
//! state that is left.

use super::{BRISTLE, LOAD_ANGLE, LOAD_SPEED, REST, RISE, STATES, State, Transmission};
use crate::integrate::{ContactAngles, ContactPlant, ContactReading, Tolerances};
use crate::transmission::BearingForces;

/// States of a rigid plant without memories: the journal's place and velocity.
pub(crate) const PLAIN: usize = 4;
/// States of any plant: journal, crank, bristles, load crank, rest, temperature.
pub(crate) const MOVING: usize = 11;

const PLACES: [usize; MOVING] = [0, 1, 2, 3, 4, 5, BRISTLE, LOAD_ANGLE, LOAD_SPEED, REST, RISE];

/// A plant that integrates the first `N` of its moving states.
pub(crate) struct Lean<'a, const N: usize>(pub(crate) &'a Transmission);

impl Transmission {
    /// Whether the first [`PLAIN`] states are all that moves.
    pub(crate) fn is_plain(&self) -> bool {
        let extension = &self.extension;
        let memories = extension.breakaway.is_some() || extension.thermal.is_some();
        let bristles = self.friction_law.has_state() || extension.presliding_distance_m > 0.0;
        self.compliance.is_none() && self.shaft.is_none() && !memories && !bristles
    }
}

impl<const N: usize> Lean<'_, N> {
    /// All states; those that are left out are 0.
    pub(crate) fn whole(&self, state: &[f64; N]) -> State {
        let mut whole = [0.0; STATES];
        for (value, place) in state.iter().zip(PLACES) {
            whole[place] = *value;
        }
        whole
    }

    /// The moving ones of all states.
    pub(crate) fn part(&self, whole: &State) -> [f64; N] {
        let mut state = [0.0; N];
        for (value, place) in state.iter_mut().zip(PLACES) {
            *value = whole[place];
        }
        state
    }

    /// Error control: each state as closely as in a run with all of them, whose norm is a mean over them.
    pub(crate) fn tolerances(&self, relative: f64) -> Tolerances<N> {
        let whole = self.0.tolerances(relative);
        let share = (STATES as f64 / N as f64).sqrt();
        let absolute = self.part(&whole.absolute).map(|size| size * share);
        Tolerances { relative: whole.relative * share, absolute, largest_step_s: whole.largest_step_s }
    }
}

impl<const N: usize> ContactPlant<N> for Lean<'_, N> {
    fn derivative(&self, time_s: f64, state: &[f64; N], latched_m_s: Option<f64>, derivative: &mut [f64; N]) {
        let (plant, whole) = (self.0, self.whole(state));
        let g = plant.geometry(time_s, &whole);
        let forces = latched_m_s
            .map_or(BearingForces::default(), |l| plant.forces_at(time_s, &whole, &plant.view(&g, l)));
        let bearing = plant.on_shaft_at(&g, &forces);
        let mut rates = [0.0; STATES];
        plant.motion::<false>(time_s, &whole, &g, latched_m_s.is_some(), &bearing, &mut rates);
        *derivative = self.part(&rates);
    }

    fn deformation(&self, time_s: f64, state: &[f64; N]) -> (f64, f64) {
        self.0.deformation(time_s, &self.whole(state))
    }

    fn contact(&self, time_s: f64, state: &[f64; N], latched_m_s: f64) -> ContactReading {
        self.0.contact(time_s, &self.whole(state), latched_m_s)
    }

    fn angles(&self, time_s: f64, state: &[f64; N]) -> ContactAngles {
        self.0.angles(time_s, &self.whole(state))
    }
}
