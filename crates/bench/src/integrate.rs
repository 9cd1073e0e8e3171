//! Integration of a plant with one unilateral contact: located onset and separation, latched approach speed.
//!
//! Dormand-Prince 5(4) of the `differential-equations` crate does the stepping and the dense output; this file finds
//! the sign changes of the deformation in each step by bisection on the dense output, restarts the method there, and
//! latches the approach speed. Locating the onset matters far more for the error than a small step.

use differential_equations::ode::OrdinaryNumericalMethod;
use differential_equations::prelude::{Error, ExplicitRungeKutta, Interpolation, ODE};
use differential_equations::status::Status;

/// A plant with `N` states and one contact.
pub trait ContactPlant<const N: usize> {
    /// State derivative while the approach speed `latched_m_s` holds.
    fn derivative(&self, time_s: f64, state: &[f64; N], latched_m_s: f64, derivative: &mut [f64; N]);
    /// Deformation in m (negative: gap) and its rate in m/s.
    fn deformation(&self, time_s: f64, state: &[f64; N]) -> (f64, f64);
    /// Normal contact force in N.
    fn normal_force_n(&self, time_s: f64, state: &[f64; N], latched_m_s: f64) -> f64;
}

/// Error control of the integrator.
#[derive(Clone, Debug)]
pub struct Tolerances<const N: usize> {
    /// Relative tolerance of each state.
    pub relative: f64,
    /// Absolute tolerance of each state, in its unit.
    pub absolute: [f64; N],
    /// Largest step in s.
    pub largest_step_s: f64,
}

/// One period in contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Time of onset in s.
    pub onset_s: f64,
    /// Approach speed at onset in m/s (0 for a run that starts in contact).
    pub approach_speed_m_s: f64,
    /// Largest normal force in N.
    pub peak_force_n: f64,
    /// Time of the largest force in s.
    pub peak_s: f64,
    /// Largest deformation in m, at the integrator's nodes.
    pub max_deformation_m: f64,
    /// Time of separation in s; `None` while still in contact at the end.
    pub separation_s: Option<f64>,
}

/// What an integration leaves behind.
#[derive(Clone, Debug)]
pub struct Integration<const N: usize> {
    /// State at the end.
    pub state: [f64; N],
    /// Every period in contact, in order.
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
        "the integrator used {steps} steps up to t = {time_s} s; expected fewer than {limit}: stiffer than the method can take, or chattering"
    )]
    TooManySteps {
        /// Steps used.
        steps: usize,
        /// The limit.
        limit: usize,
        /// Time reached in s.
        time_s: f64,
    },
}

/// Steps allowed for each simulated second, beside a constant allowance.
const STEPS_PER_SECOND: f64 = 4.0e6;
const STEPS_ALLOWANCE: usize = 2_000_000;
/// Points inside a step at which a peak is looked for and a grazing contact is noticed.
const PROBES: usize = 4;

struct Latched<'a, P> {
    plant: &'a P,
    latched_m_s: f64,
}

impl<P: ContactPlant<N>, const N: usize> ODE<f64, [f64; N]> for Latched<'_, P> {
    fn diff(&self, time_s: f64, state: &[f64; N], derivative: &mut [f64; N]) {
        self.plant.derivative(time_s, state, self.latched_m_s, derivative);
    }
}

/// Integrates from `start_s` to `end_s` and calls `observe(time, state, latched)` at every one of the ascending
/// `samples_s` within that span. `in_contact` says whether the run starts in contact (with latched speed 0).
pub fn integrate<P: ContactPlant<N>, const N: usize>(
    plant: &P,
    (start_s, end_s): (f64, f64),
    initial: [f64; N],
    in_contact: bool,
    samples_s: &[f64],
    tolerances: &Tolerances<N>,
    mut observe: impl FnMut(f64, &[f64; N], f64),
) -> Result<Integration<N>, IntegrationError> {
    let limit = STEPS_ALLOWANCE + ((end_s - start_s) * STEPS_PER_SECOND) as usize;
    let mut system = Latched { plant, latched_m_s: 0.0 };
    let mut method = ExplicitRungeKutta::dopri5()
        .rtol(tolerances.relative)
        .atol(tolerances.absolute)
        .max_steps(usize::MAX)
        .h_max(tolerances.largest_step_s)
        .h0((end_s - start_s).min(tolerances.largest_step_s) * 1e-3);
    let stopped = |time_s: f64, reason: String| IntegrationError::Stopped { time_s, reason };
    method.init(&system, start_s, end_s, &initial).map_err(|e| stopped(start_s, reason(&e)))?;

    let mut contact = in_contact;
    let mut peaks = PeakFinder::default();
    let mut impacts: Vec<Impact> = Vec::new();
    if contact {
        impacts.push(open(start_s, 0.0));
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
        method.step(&system).map_err(|e| stopped(method.t(), reason(&e)))?;
        if matches!(method.status(), Status::RejectedStep) {
            continue;
        }
        if !method.y().iter().all(|v| v.is_finite()) {
            return Err(stopped(method.t_prev(), "the state is no longer finite".into()));
        }
        let (from, reached) = (method.t_prev(), method.t());
        let mut at = |t: f64| method.interpolate(t.clamp(from, reached)).map_err(|e| stopped(t, reason(&e)));

        // The first probe on the other side of the surface brackets an event.
        let mut event = None;
        let mut bracket_from = from;
        for i in 1..=PROBES {
            let t = if i == PROBES { reached } else { from + (reached - from) * i as f64 / PROBES as f64 };
            let depth = plant.deformation(t, &at(t)?).0;
            if (depth > 0.0) != contact {
                let (mut low, mut high) = (bracket_from, t);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if middle <= low || middle >= high {
                        break;
                    }
                    if (plant.deformation(middle, &at(middle)?).0 > 0.0) == contact {
                        low = middle
                    } else {
                        high = middle
                    }
                }
                event = Some((high, at(high)?));
                break;
            }
            bracket_from = t;
        }
        let to = event.as_ref().map_or(reached, |(t, _)| *t);
        for t in samples_s.get(next_sample..).unwrap_or_default() {
            if *t > to || (event.is_some() && *t == to) {
                break;
            }
            observe(*t, &at(*t)?, system.latched_m_s);
            next_sample += 1;
        }
        if contact && let Some(impact) = impacts.last_mut() {
            for i in 1..=PROBES {
                let t = from + (to - from) * i as f64 / PROBES as f64;
                let state = at(t)?;
                let force = plant.normal_force_n(t, &state, system.latched_m_s);
                peaks.push(t, force, impact);
                impact.max_deformation_m = impact.max_deformation_m.max(plant.deformation(t, &state).0);
            }
        }
        if let Some((t, state)) = event {
            let rate = plant.deformation(t, &state).1;
            contact = !contact;
            if contact {
                system.latched_m_s = rate.max(0.0);
                impacts.push(open(t, rate.max(0.0)));
            } else {
                if let Some(impact) = impacts.last_mut() {
                    impact.separation_s = Some(t);
                }
                system.latched_m_s = 0.0;
            }
            peaks = PeakFinder::default();
            // A fresh contact is stiffer than what the step was chosen for.
            let step = (method.t() - method.t_prev()).min(end_s - t).max(f64::EPSILON * end_s.abs()) * 0.1;
            method.h0 = step;
            if t < end_s {
                method.init(&system, t, end_s, &state).map_err(|e| stopped(t, reason(&e)))?;
            } else {
                break;
            }
        }
    }
    Ok(Integration { state: *method.y(), impacts, steps })
}

fn reason<const N: usize>(error: &Error<f64, [f64; N]>) -> String {
    match error {
        Error::StepSize { .. } => "the step size underflowed".into(),
        Error::Stiffness { .. } => "the problem turned stiff".into(),
        other => format!("{other:?}"),
    }
}

fn open(onset_s: f64, approach_speed_m_s: f64) -> Impact {
    Impact {
        onset_s,
        approach_speed_m_s,
        peak_force_n: 0.0,
        peak_s: onset_s,
        max_deformation_m: 0.0,
        separation_s: None,
    }
}

/// Largest force of a contact, refined by the vertex of the parabola through the three highest neighbours.
#[derive(Default)]
struct PeakFinder {
    last: [Option<(f64, f64)>; 2],
}

impl PeakFinder {
    fn push(&mut self, t: f64, force: f64, impact: &mut Impact) {
        if force > impact.peak_force_n {
            (impact.peak_force_n, impact.peak_s) = (force, t);
        }
        if let [Some((t0, f0)), Some((t1, f1))] = self.last
            && f1 > f0
            && f1 >= force
        {
            let (d0, d1) = ((f1 - f0) / (t1 - t0), (force - f1) / (t - t1));
            let curvature = (d1 - d0) / (t - t0);
            let vertex = 0.5 * (t0 + t1) - 0.5 * d0 / curvature;
            let value = f0 + d0 * (vertex - t0) + curvature * (vertex - t0) * (vertex - t1);
            if value.is_finite() && vertex > t0 && vertex < t && value > impact.peak_force_n {
                (impact.peak_force_n, impact.peak_s) = (value, vertex);
            }
        }
        self.last = [self.last[1], Some((t, force))];
    }
}
