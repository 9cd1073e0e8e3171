//! The plant reduced to the states that the sensors' true signals depend on, for the hundreds of
//! simulations of a diagnosis.
//!
//! The works and losses of the energy balance are quadratures without feedback, and most effects
//! with a memory are absent. The rigid plant without memories moves [`PLAIN`] of the [`STATES`]
//! states. Equations and tolerances of the remaining states do not change.

use super::{BREAKAWAY, BRISTLE, LOAD_ANGLE, LOAD_SPEED, RISE, STATES, State, Transmission};
use crate::integrate::{ContactAngles, ContactPlant, ContactReading, Slip, Tolerances, Touch};

/// Number of moving states of a rigid plant without memories: journal position and velocity.
pub(crate) const PLAIN: usize = 4;
/// Number of moving states of any plant: journal, crank, bristles, load crank, age of standstill,
/// temperature.
pub(crate) const MOVING: usize = 11;

const PLACES: [usize; MOVING] = [0, 1, 2, 3, 4, 5, BRISTLE, LOAD_ANGLE, LOAD_SPEED, BREAKAWAY, RISE];

/// A plant that integrates the first `N` of its moving states.
pub(crate) struct Reduced<'a, const N: usize>(pub(crate) &'a Transmission);

impl Transmission {
    /// Returns whether only the first [`PLAIN`] states move.
    pub(crate) fn is_plain(&self) -> bool {
        let extension = &self.extension;
        let memories = extension.breakaway.is_some() || extension.thermal.is_some();
        let bristles = self.friction_law.has_state() || extension.presliding_distance_m > 0.0;
        self.compliance.is_none() && self.shaft.is_none() && !memories && !bristles
    }
}

impl<const N: usize> Reduced<'_, N> {
    /// Returns all states; those that are left out are 0.
    pub(crate) fn expand(&self, state: &[f64; N]) -> State {
        let mut full = [0.0; STATES];
        for (value, place) in state.iter().zip(PLACES) {
            full[place] = *value;
        }
        full
    }

    /// Returns the moving states.
    pub(crate) fn reduce(&self, full: &State) -> [f64; N] {
        let mut state = [0.0; N];
        for (value, place) in state.iter_mut().zip(PLACES) {
            *value = full[place];
        }
        state
    }

    /// Error control that holds each state as tightly as in a run with all states, whose norm is a
    /// mean over them.
    pub(crate) fn tolerances(&self, relative: f64) -> Tolerances<N> {
        let full = self.0.tolerances(relative);
        let share = (STATES as f64 / N as f64).sqrt();
        let absolute = self.reduce(&full.absolute).map(|size| size * share);
        Tolerances { relative: full.relative * share, absolute, largest_step_s: full.largest_step_s }
    }
}

impl<const N: usize> ContactPlant<N> for Reduced<'_, N> {
    fn derivative(&self, time_s: f64, state: &[f64; N], touch: Option<Touch>, derivative: &mut [f64; N]) {
        let (plant, full) = (self.0, self.expand(state));
        let mut rates = [0.0; STATES];
        plant.rates::<false>(time_s, &full, &plant.geometry(time_s, &full), touch, &mut rates);
        *derivative = self.reduce(&rates);
    }

    fn deformation(&self, time_s: f64, state: &[f64; N]) -> (f64, f64) {
        self.0.deformation(time_s, &self.expand(state))
    }

    fn contact(&self, time_s: f64, state: &[f64; N], latched_m_s: f64) -> ContactReading {
        self.0.contact(time_s, &self.expand(state), latched_m_s)
    }

    fn angles(&self, time_s: f64, state: &[f64; N]) -> ContactAngles {
        self.0.angles(time_s, &self.expand(state))
    }

    fn has_slip_ended(&self, time_s: f64, state: &[f64; N], touch: Touch) -> bool {
        self.0.has_slip_ended(time_s, &self.expand(state), touch)
    }

    fn next_slip(&self, time_s: f64, state: &mut [f64; N], touch: Touch) -> Slip {
        let mut full = self.expand(state);
        let slip = self.0.next_slip(time_s, &mut full, touch);
        *state = self.reduce(&full);
        slip
    }
}
