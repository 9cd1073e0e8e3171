//! Integration of a plant with unilateral contacts: located onset and separation, latched approach
//! speed.
//!
//! The Dormand-Prince 5(4) method of the `differential-equations` crate does the stepping and the
//! dense output. [`integrate`] finds the sign changes of the deformations in each step by bisection
//! on the dense output, restarts the method there and latches the approach speed. Locating the
//! onset reduces the error far more than a small step does. Peaks and work of a contact are
//! measured on the dense output too (`measure`). With a friction law that sticks, the beginning and
//! the end of a slip are located in the same way. The work is bounded: by a number of steps per
//! simulated second, and by [`CHATTER_CONTACTS`] onsets, or as many changes of the slip, of
//! a contact within one largest step.

mod contacts;
mod measure;
mod outcome;
mod plant;

pub use outcome::{CHATTER_CONTACTS, ContactPhase, Impact, Integration, IntegrationError, Pause};
pub(crate) use plant::SlicedPlant;
pub use plant::{ContactAngles, ContactPlant, ContactReading, Slip, Touch};

use contacts::{Contacts, Phase, Start};
use differential_equations::methods::{DormandPrince, ExplicitRungeKutta, Ordinary};
use differential_equations::ode::OrdinaryNumericalMethod;
use differential_equations::prelude::{Error, Interpolation, ODE};
use differential_equations::status::Status;

/// Error control of the integrator.
#[derive(Clone, Debug)]
pub struct Tolerances<const N: usize> {
    /// Relative tolerance of each state.
    pub relative: f64,
    /// Absolute tolerance of each state, in its unit; infinite: not controlled.
    pub absolute: [f64; N],
    /// Largest step in s.
    pub largest_step_s: f64,
}

/// Steps allowed per simulated second, besides a constant allowance.
const STEPS_PER_SECOND: f64 = 4.0e6;
/// Steps allowed for any run.
const STEPS_ALLOWANCE: usize = 2_000_000;
/// Share of the last step with which the method restarts after an event: a new contact is stiffer
/// than the motion for which that step was chosen.
const RESTART_SHARE: f64 = 0.4;

/// The method with `N` states: order 5, seven stages.
type Method<const N: usize> = ExplicitRungeKutta<Ordinary, DormandPrince, f64, [f64; N], 5, 7, 7>;

/// Integrates a plant with one contact over `span_s` and calls `observe(time, state, touch)` at
/// each of the ascending `samples_s` within that span. `in_contact` states whether the run starts
/// in contact, with latched speed 0.
pub fn integrate<P: ContactPlant<N>, const N: usize>(
    plant: &P,
    span_s: (f64, f64),
    initial: [f64; N],
    in_contact: bool,
    samples_s: &[f64],
    tolerances: &Tolerances<N>,
    mut observe: impl FnMut(f64, &[f64; N], Touch),
) -> Result<Integration<N>, IntegrationError> {
    let start = Start::InContact(&[in_contact]);
    integrate_phases(plant, span_s, (initial, start), samples_s, tolerances, &mut |t, s, phase| {
        observe(t, s, phase.touch(0));
    })
}

/// Continues an integration that ended at the start of `span_s`.
pub(crate) fn resume<P: SlicedPlant<N>, const N: usize>(
    plant: &P,
    span_s: (f64, f64),
    (initial, pause): ([f64; N], &Pause),
    tolerances: &Tolerances<N>,
) -> Result<Integration<N>, IntegrationError> {
    let start = Start::Resumed(pause);
    integrate_phases(plant, span_s, (initial, start), &[], tolerances, &mut |_, _, _| {})
}

/// Integrates a plant with any number of contacts, as [`integrate`]: `in_contact` and the latched
/// speeds have one value for each contact.
pub(crate) fn integrate_slices<P: SlicedPlant<N>, const N: usize>(
    plant: &P,
    span_s: (f64, f64),
    initial: [f64; N],
    in_contact: &[bool],
    samples_s: &[f64],
    tolerances: &Tolerances<N>,
    mut observe: impl FnMut(f64, &[f64; N], &[Option<f64>]),
) -> Result<Integration<N>, IntegrationError> {
    let start = Start::InContact(in_contact);
    integrate_phases(plant, span_s, (initial, start), samples_s, tolerances, &mut |t, s, phase| {
        observe(t, s, &phase.latched_m_s);
    })
}

/// Integrates as [`integrate_slices`] and observes the phase of all contacts.
fn integrate_phases<P: SlicedPlant<N>, const N: usize>(
    plant: &P,
    (start_s, end_s): (f64, f64),
    (mut initial, begin): ([f64; N], Start<'_>),
    samples_s: &[f64],
    tolerances: &Tolerances<N>,
    observe: &mut dyn FnMut(f64, &[f64; N], &Phase<'_, P>),
) -> Result<Integration<N>, IntegrationError> {
    let limit = STEPS_ALLOWANCE + ((end_s - start_s) * STEPS_PER_SECOND) as usize;
    let mut contacts = Contacts::new(plant, start_s, &mut initial, begin);
    let mut method: Method<N> = ExplicitRungeKutta::dopri5()
        .rtol(tolerances.relative)
        .atol(tolerances.absolute)
        .max_steps(usize::MAX)
        .h_max(tolerances.largest_step_s)
        .h0(begin.first_step_s(end_s - start_s, tolerances.largest_step_s));
    plant.change(start_s, &initial, &contacts.phase.latched_m_s);
    contacts.read_start(start_s, &initial);
    let mut change_s = plant.next_change_s(start_s);
    start(&mut method, &contacts.phase, (start_s, end_s), &initial)?;
    let mut next_sample = samples_s.partition_point(|&t| t < start_s);
    let (mut steps, mut step_s) = (0, method.h0);
    // A step to the end may miss it by rounding, which leaves no interval to integrate.
    while end_s - method.t() > f64::EPSILON * end_s.abs() {
        if steps >= limit {
            return Err(IntegrationError::TooManySteps { steps, limit, time_s: method.t() });
        }
        steps += 1;
        step_s = method.h();
        // A change within rounding of the end would leave no interval to integrate.
        let has_change = end_s - change_s > f64::EPSILON * end_s.abs();
        if !advance(&mut method, &contacts.phase, if has_change { change_s } else { end_s })? {
            continue;
        }
        let (from, reached, last) = (method.t_prev(), method.t(), *method.y());
        let mut state_at =
            |t: f64| method.interpolate(t.clamp(from, reached)).map_err(|e| stopped(t, reason(&e)));
        let event = if contacts.read_end((from, reached), &last) {
            contacts.locate_event((from, reached), &mut state_at)?
        } else {
            None
        };
        let to = event.as_ref().map_or(reached, |(t, _)| *t);
        for t in samples_s.get(next_sample..).unwrap_or_default() {
            if *t > to || (event.is_some() && *t == to) {
                break;
            }
            observe(*t, &state_at(*t)?, &contacts.phase);
            next_sample += 1;
        }
        contacts.measure((from, to), event.as_ref(), &mut state_at)?;
        let is_at_change = has_change && change_s - to <= f64::EPSILON * change_s.abs();
        let mut state = last;
        if let Some((_, located)) = event {
            state = located;
            contacts.switch(to, &mut state, tolerances.largest_step_s)?;
            if to >= end_s {
                return Ok(contacts.end(state, steps, step_s));
            }
            method.h0 = (reached - from).min(end_s - to).max(f64::EPSILON * end_s.abs()) * RESTART_SHARE;
        } else {
            contacts.complete_step();
            if !is_at_change {
                continue;
            }
            method.h0 = method.h().min(end_s - to).max(f64::EPSILON * end_s.abs());
        }
        if is_at_change {
            plant.change(to, &state, &contacts.phase.latched_m_s);
            contacts.read_start(to, &state);
            change_s = plant.next_change_s(change_s);
        }
        start(&mut method, &contacts.phase, (to, end_s), &state)?;
    }
    Ok(contacts.end(*method.y(), steps, step_s))
}

/// Starts the method at a time and a state.
fn start<S: ODE<f64, [f64; N]>, const N: usize>(
    method: &mut Method<N>,
    system: &S,
    (from_s, end_s): (f64, f64),
    state: &[f64; N],
) -> Result<(), IntegrationError> {
    method.init(system, from_s, end_s, state).map_err(|e| stopped(from_s, reason(&e))).map(drop)
}

/// Tries one step, not beyond `end_s`, and returns whether the method accepted it.
fn advance<S: ODE<f64, [f64; N]>, const N: usize>(
    method: &mut Method<N>,
    system: &S,
    end_s: f64,
) -> Result<bool, IntegrationError> {
    let remaining = end_s - method.t();
    if method.h() > remaining {
        method.set_h(remaining);
    }
    match method.step(system) {
        Ok(_) => {}
        // Only a hint that an implicit method might need fewer steps; their number is bounded
        // anyway.
        Err(Error::Stiffness { .. }) => {
            let (time_s, state) = (method.t(), *method.y());
            method.h0 = method.h();
            start(method, system, (time_s, end_s), &state)?;
            return Ok(false);
        }
        Err(e) => return Err(stopped(method.t(), reason(&e))),
    }
    if matches!(method.status(), Status::RejectedStep) {
        return Ok(false);
    }
    if !method.y().iter().all(|v| v.is_finite()) {
        return Err(stopped(method.t_prev(), "the state is no longer finite".into()));
    }
    Ok(true)
}

fn stopped(time_s: f64, reason: String) -> IntegrationError {
    IntegrationError::Stopped { time_s, reason }
}

fn reason<const N: usize>(error: &Error<f64, [f64; N]>) -> String {
    match error {
        Error::StepSize { .. } => "the step size underflowed".into(),
        other => format!("{other:?}"),
    }
}
