//! Integration of a plant with unilateral contacts: located onset and separation, latched approach speed.
//!
//! Dormand-Prince 5(4) of the `differential-equations` crate does the stepping and the dense output; [`integrate`] finds
//! the sign changes of the deformations in each step by bisection on the dense output, restarts the method there, and
//! latches the approach speed. Locating the onset matters far more for the error than a small step. What a contact came
//! to is measured on the dense output too (`measure`). Work is bounded: by a number of steps for each simulated second,
//! and by [`CHATTER_CONTACTS`] onsets within one largest step.

mod measure;
mod outcome;
mod plant;

pub use outcome::{Impact, Integration, IntegrationError};
pub use plant::{ContactAngles, ContactPlant, ContactReading, SlicedPlant};

use differential_equations::ode::OrdinaryNumericalMethod;
use differential_equations::prelude::{Error, ExplicitRungeKutta, Interpolation, ODE};
use differential_equations::status::Status;
use measure::Span;
use std::collections::VecDeque;

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

/// Steps allowed for each simulated second, beside a constant allowance.
const STEPS_PER_SECOND: f64 = 4.0e6;
const STEPS_ALLOWANCE: usize = 2_000_000;
/// Onsets of one contact within one largest step at which a run counts as chattering.
pub const CHATTER_CONTACTS: usize = 500;
/// Parts of a step at whose ends a grazing contact is noticed.
const PROBES: usize = 4;

struct Latched<'a, P> {
    plant: &'a P,
    /// One for each contact, `None` in a gap.
    speeds_m_s: Vec<Option<f64>>,
}

impl<P: SlicedPlant<N>, const N: usize> ODE<f64, [f64; N]> for Latched<'_, P> {
    fn diff(&self, time_s: f64, state: &[f64; N], derivative: &mut [f64; N]) {
        self.plant.sliced_derivative(time_s, state, &self.speeds_m_s, derivative);
    }
}

/// One contact on its way through a run.
#[derive(Default)]
struct Contact {
    touching: bool,
    /// Index of the open impact.
    impact: usize,
    /// At the start of the step.
    before: ContactReading,
    /// Times of the last onsets.
    onsets: VecDeque<f64>,
}

impl Contact {
    /// Notes an onset and refuses to go on if they follow each other too fast.
    fn guard(&mut self, contact: usize, time_s: f64, window_s: f64) -> Result<(), IntegrationError> {
        self.onsets.push_back(time_s);
        if self.onsets.len() <= CHATTER_CONTACTS {
            return Ok(());
        }
        match self.onsets.pop_front() {
            Some(first) if time_s - first < window_s => Err(IntegrationError::Chattering {
                contact,
                count: CHATTER_CONTACTS,
                window_s: time_s - first,
                time_s,
            }),
            _ => Ok(()),
        }
    }
}

/// Integrates a plant with one contact from `start_s` to `end_s` and calls `observe(time, state, latched)` at every one
/// of the ascending `samples_s` within that span. `in_contact` says whether the run starts in contact (with latched
/// speed 0).
pub fn integrate<P: ContactPlant<N>, const N: usize>(
    plant: &P,
    span_s: (f64, f64),
    initial: [f64; N],
    in_contact: bool,
    samples_s: &[f64],
    tolerances: &Tolerances<N>,
    mut observe: impl FnMut(f64, &[f64; N], f64),
) -> Result<Integration<N>, IntegrationError> {
    integrate_slices(plant, span_s, initial, &[in_contact], samples_s, tolerances, |t, s, latched| {
        observe(t, s, latched.first().copied().flatten().unwrap_or_default());
    })
}

/// As [`integrate`], for a plant with any number of contacts: `in_contact` and the latched speeds are one for each.
pub fn integrate_slices<P: SlicedPlant<N>, const N: usize>(
    plant: &P,
    (start_s, end_s): (f64, f64),
    initial: [f64; N],
    in_contact: &[bool],
    samples_s: &[f64],
    tolerances: &Tolerances<N>,
    mut observe: impl FnMut(f64, &[f64; N], &[Option<f64>]),
) -> Result<Integration<N>, IntegrationError> {
    let limit = STEPS_ALLOWANCE + ((end_s - start_s) * STEPS_PER_SECOND) as usize;
    let mut system = Latched { plant, speeds_m_s: vec![None; plant.slices()] };
    let mut method = ExplicitRungeKutta::dopri5()
        .rtol(tolerances.relative)
        .atol(tolerances.absolute)
        .max_steps(usize::MAX)
        .h_max(tolerances.largest_step_s)
        .h0((end_s - start_s).min(tolerances.largest_step_s) * 1e-3);
    let stopped = |time_s: f64, reason: String| IntegrationError::Stopped { time_s, reason };

    let mut impacts: Vec<Impact> = Vec::new();
    let mut contacts: Vec<Contact> = Vec::with_capacity(plant.slices());
    for slice in 0..plant.slices() {
        let touching = in_contact.get(slice).copied().unwrap_or(false);
        if touching {
            if let Some(speed) = system.speeds_m_s.get_mut(slice) {
                *speed = Some(0.0);
            }
            let angles = plant.slice_angles(slice, start_s, &initial);
            impacts.push(Impact {
                contact: slice,
                onset_s: start_s,
                peak_s: start_s,
                angles,
                ..Impact::default()
            });
        }
        contacts.push(Contact {
            touching,
            impact: impacts.len().saturating_sub(1),
            before: plant.slice_contact(slice, start_s, &initial, 0.0),
            ..Contact::default()
        });
    }
    method.init(&system, start_s, end_s, &initial).map_err(|e| stopped(start_s, reason(&e)))?;
    let mut after: Vec<ContactReading> = Vec::with_capacity(contacts.len());
    let mut next_sample = samples_s.partition_point(|&t| t < start_s);
    let mut steps = 0;
    while method.t() < end_s {
        if steps >= limit {
            return Err(IntegrationError::TooManySteps { steps, limit, time_s: method.t() });
        }
        steps += 1;
        let remaining = end_s - method.t();
        if method.h() > remaining {
            method.set_h(remaining);
        }
        match method.step(&system) {
            Ok(_) => {}
            // Only a hint that an implicit method might be cheaper; the number of steps is bounded anyway.
            Err(Error::Stiffness { .. }) => {
                let (time_s, state) = (method.t(), *method.y());
                method.h0 = method.h();
                method.init(&system, time_s, end_s, &state).map_err(|e| stopped(time_s, reason(&e)))?;
                continue;
            }
            Err(e) => return Err(stopped(method.t(), reason(&e))),
        }
        if matches!(method.status(), Status::RejectedStep) {
            continue;
        }
        if !method.y().iter().all(|v| v.is_finite()) {
            return Err(stopped(method.t_prev(), "the state is no longer finite".into()));
        }
        let (from, reached, last) = (method.t_prev(), method.t(), *method.y());
        let mut at = |t: f64| method.interpolate(t.clamp(from, reached)).map_err(|e| stopped(t, reason(&e)));

        // A contact whose surface cannot be reached within the step needs no probes.
        let mut near = false;
        after.clear();
        for (slice, contact) in contacts.iter().enumerate() {
            let latched = system.speeds_m_s.get(slice).copied().flatten().unwrap_or_default();
            let reading = plant.slice_contact(slice, reached, &last, latched);
            let reach = (reached - from) * (contact.before.rate_m_s.abs() + reading.rate_m_s.abs());
            near |= (reading.depth_m > 0.0) != contact.touching
                || reading.depth_m.abs().min(contact.before.depth_m.abs()) <= reach;
            after.push(reading);
        }
        let changed = |t: f64, state: &[f64; N]| {
            contacts
                .iter()
                .enumerate()
                .any(|(slice, c)| (plant.slice_deformation(slice, t, state).0 > 0.0) != c.touching)
        };
        // The first probe on the other side of a surface brackets an event.
        let mut event = None;
        if near {
            let mut low = from;
            for i in 1..=PROBES {
                let t =
                    if i == PROBES { reached } else { from + (reached - from) * i as f64 / PROBES as f64 };
                if changed(t, &at(t)?) {
                    let mut high = t;
                    for _ in 0..60 {
                        let middle = 0.5 * (low + high);
                        if middle <= low || middle >= high {
                            break;
                        }
                        if changed(middle, &at(middle)?) { high = middle } else { low = middle }
                    }
                    event = Some((high, at(high)?));
                    break;
                }
                low = t;
            }
        }
        let to = event.as_ref().map_or(reached, |(t, _)| *t);
        for t in samples_s.get(next_sample..).unwrap_or_default() {
            if *t > to || (event.is_some() && *t == to) {
                break;
            }
            observe(*t, &at(*t)?, &system.speeds_m_s);
            next_sample += 1;
        }
        for (slice, contact) in contacts.iter().enumerate().filter(|(_, c)| c.touching) {
            let latched_m_s = system.speeds_m_s.get(slice).copied().flatten().unwrap_or_default();
            let end = match &event {
                Some((t, state)) => plant.slice_contact(slice, *t, state, latched_m_s),
                None => after.get(slice).copied().unwrap_or_default(),
            };
            if let Some(impact) = impacts.get_mut(contact.impact) {
                let span = Span { from, to, start: contact.before, end };
                let mut read = |t: f64| at(t).map(|s| plant.slice_contact(slice, t, &s, latched_m_s));
                span.measure(&mut read, impact)?;
            }
        }
        let Some((t, state)) = event else {
            for (contact, after) in contacts.iter_mut().zip(&after) {
                contact.before = *after;
            }
            continue;
        };
        for (slice, contact) in contacts.iter_mut().enumerate() {
            let (depth, rate) = plant.slice_deformation(slice, t, &state);
            let mut latched = system.speeds_m_s.get(slice).copied().flatten();
            if (depth > 0.0) != contact.touching {
                contact.touching = !contact.touching;
                latched = contact.touching.then_some(rate.max(0.0));
                if let Some(speed) = latched {
                    contact.impact = impacts.len();
                    impacts.push(Impact {
                        contact: slice,
                        onset_s: t,
                        peak_s: t,
                        angles: plant.slice_angles(slice, t, &state),
                        approach_speed_m_s: speed,
                        ..Impact::default()
                    });
                    contact.guard(slice, t, tolerances.largest_step_s)?;
                } else if let Some(impact) = impacts.get_mut(contact.impact) {
                    impact.separation_s = Some(t);
                    impact.separation_speed_m_s = -rate;
                }
            }
            contact.before = plant.slice_contact(slice, t, &state, latched.unwrap_or_default());
            if let Some(speed) = system.speeds_m_s.get_mut(slice) {
                *speed = latched;
            }
        }
        if t >= end_s {
            return Ok(Integration { state, impacts, steps });
        }
        // A fresh contact is stiffer than what the step was chosen for.
        method.h0 = (reached - from).min(end_s - t).max(f64::EPSILON * end_s.abs()) * 0.4;
        method.init(&system, t, end_s, &state).map_err(|e| stopped(t, reason(&e)))?;
    }
    Ok(Integration { state: *method.y(), impacts, steps })
}

fn reason<const N: usize>(error: &Error<f64, [f64; N]>) -> String {
    match error {
        Error::StepSize { .. } => "the step size underflowed".into(),
        other => format!("{other:?}"),
    }
}
