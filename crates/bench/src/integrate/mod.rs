//! Integration of a plant with unilateral contacts: located onset and separation, latched approach speed.
//!
//! Dormand-Prince 5(4) of the `differential-equations` crate does the stepping and the dense output; [`integrate`] finds
//! the sign changes of the deformations in each step by bisection on the dense output, restarts the method there, and
//! latches the approach speed. Locating the onset matters far more for the error than a small step. What a contact came
//! to is measured on the dense output too (`measure`). Work is bounded: by a number of steps for each simulated second,
//! and by [`CHATTER_CONTACTS`] onsets within one largest step.

mod measure;
mod plant;

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

/// One period in contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Impact {
    /// Which contact of the plant; 0 where there is one.
    pub contact: usize,
    /// Time of onset in s.
    pub onset_s: f64,
    /// Angles at onset.
    pub angles: ContactAngles,
    /// Approach speed at onset in m/s (0 for a run that starts in contact): what the latch then holds. A law with a
    /// floor divides by the larger of the two.
    pub approach_speed_m_s: f64,
    /// Largest normal force in N.
    pub peak_force_n: f64,
    /// Time of the largest force in s.
    pub peak_s: f64,
    /// Largest deformation in m.
    pub max_deformation_m: f64,
    /// Work that the normal force took so far, J; over a closed contact its loss.
    pub energy_lost_j: f64,
    /// Time of separation in s; `None` while still in contact at the end.
    pub separation_s: Option<f64>,
    /// Speed of separation in m/s; 0 until then.
    pub separation_speed_m_s: f64,
}

impl Impact {
    /// Length of the contact in s, once it has ended.
    pub fn duration_s(&self) -> Option<f64> {
        self.separation_s.map(|end| end - self.onset_s)
    }

    /// Separation speed over approach speed, once the contact has ended.
    pub fn restitution(&self) -> Option<f64> {
        (self.separation_s.is_some() && self.approach_speed_m_s > 0.0)
            .then(|| self.separation_speed_m_s / self.approach_speed_m_s)
    }
}

/// What an integration leaves behind.
#[derive(Clone, Debug)]
pub struct Integration<const N: usize> {
    /// State at the end.
    pub state: [f64; N],
    /// Every period in contact, in the order of the onsets.
    pub impacts: Vec<Impact>,
    /// Accepted and rejected steps.
    pub steps: usize,
}

/// Why an integration ended early.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IntegrationError {
    /// The method gave up.
    #[error("the integrator stopped at t = {time_s} s: {reason}")]
    Stopped {
        /// Time reached in s.
        time_s: f64,
        /// The method's own words.
        reason: String,
    },
    /// The number of steps is bounded, so that no parameter set can hang a run.
    #[error(
        "the integrator used {steps} steps up to t = {time_s} s; expected fewer than {limit}: stiffer than the method can take"
    )]
    TooManySteps {
        /// Steps used.
        steps: usize,
        /// The limit.
        limit: usize,
        /// Time reached in s.
        time_s: f64,
    },
    /// Onsets follow each other faster than the run can mean.
    #[error(
        "contact {contact} chatters: {count} onsets within {window_s} s up to t = {time_s} s; expected sustained contact or separate impacts"
    )]
    Chattering {
        /// Which contact.
        contact: usize,
        /// Onsets counted.
        count: usize,
        /// Within this time, s.
        window_s: f64,
        /// Time reached in s.
        time_s: f64,
    },
}

/// Steps allowed for each simulated second, beside a constant allowance.
const STEPS_PER_SECOND: f64 = 4.0e6;
const STEPS_ALLOWANCE: usize = 2_000_000;
/// Onsets of one contact within one largest step at which a run counts as chattering.
pub const CHATTER_CONTACTS: usize = 500;
/// Points inside a step at which forces are read and a grazing contact is noticed.
const PROBES: usize = 4;

struct Latched<'a, P> {
    plant: &'a P,
    speeds_m_s: Vec<f64>,
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
    /// Deformation and rate at the start of the step.
    before: (f64, f64),
    /// Times of the last onsets.
    onsets: VecDeque<f64>,
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
        observe(t, s, latched.first().copied().unwrap_or_default());
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
    mut observe: impl FnMut(f64, &[f64; N], &[f64]),
) -> Result<Integration<N>, IntegrationError> {
    let limit = STEPS_ALLOWANCE + ((end_s - start_s) * STEPS_PER_SECOND) as usize;
    let mut system = Latched { plant, speeds_m_s: vec![0.0; plant.slices()] };
    let mut method = ExplicitRungeKutta::dopri5()
        .rtol(tolerances.relative)
        .atol(tolerances.absolute)
        .max_steps(usize::MAX)
        .h_max(tolerances.largest_step_s)
        .h0((end_s - start_s).min(tolerances.largest_step_s) * 1e-3);
    let stopped = |time_s: f64, reason: String| IntegrationError::Stopped { time_s, reason };
    method.init(&system, start_s, end_s, &initial).map_err(|e| stopped(start_s, reason(&e)))?;

    let mut impacts: Vec<Impact> = Vec::new();
    let mut contacts: Vec<Contact> = Vec::with_capacity(plant.slices());
    for slice in 0..plant.slices() {
        let touching = in_contact.get(slice).copied().unwrap_or(false);
        if touching {
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
            before: plant.slice_deformation(slice, start_s, &initial),
            ..Contact::default()
        });
    }
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
        let mut after: Vec<(f64, f64)> = Vec::with_capacity(contacts.len());
        for (slice, contact) in contacts.iter().enumerate() {
            let (depth, rate) = plant.slice_deformation(slice, reached, &last);
            let reach = (reached - from) * (contact.before.1.abs() + rate.abs());
            near |= (depth > 0.0) != contact.touching || depth.abs().min(contact.before.0.abs()) <= reach;
            after.push((depth, rate));
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
        if contacts.iter().any(|c| c.touching) {
            let span = Span::new(from, to, &mut at)?;
            for (slice, contact) in contacts.iter().enumerate().filter(|(_, c)| c.touching) {
                let latched = system.speeds_m_s.get(slice).copied().unwrap_or_default();
                if let Some(impact) = impacts.get_mut(contact.impact) {
                    span.measure(plant, slice, latched, &mut at, impact);
                }
            }
        }
        let Some((t, state)) = event else {
            for (contact, after) in contacts.iter_mut().zip(after) {
                contact.before = after;
            }
            continue;
        };
        for (slice, contact) in contacts.iter_mut().enumerate() {
            contact.before = plant.slice_deformation(slice, t, &state);
            let (depth, rate) = contact.before;
            if (depth > 0.0) == contact.touching {
                continue;
            }
            contact.touching = !contact.touching;
            let mut latched = 0.0;
            if contact.touching {
                latched = rate.max(0.0);
                contact.impact = impacts.len();
                impacts.push(Impact {
                    contact: slice,
                    onset_s: t,
                    peak_s: t,
                    angles: plant.slice_angles(slice, t, &state),
                    approach_speed_m_s: latched,
                    ..Impact::default()
                });
                contact.onsets.push_back(t);
                if contact.onsets.len() > CHATTER_CONTACTS
                    && let Some(first) = contact.onsets.pop_front()
                    && t - first < tolerances.largest_step_s
                {
                    return Err(IntegrationError::Chattering {
                        contact: slice,
                        count: CHATTER_CONTACTS,
                        window_s: t - first,
                        time_s: t,
                    });
                }
            } else if let Some(impact) = impacts.get_mut(contact.impact) {
                impact.separation_s = Some(t);
                impact.separation_speed_m_s = -rate;
            }
            if let Some(speed) = system.speeds_m_s.get_mut(slice) {
                *speed = latched;
            }
        }
        if t >= end_s {
            return Ok(Integration { state, impacts, steps });
        }
        // A fresh contact is stiffer than what the step was chosen for.
        method.h0 = (reached - from).min(end_s - t).max(f64::EPSILON * end_s.abs()) * 0.1;
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
