//! Runs of a mechanism: the integrator for its number of states, and what a run records.

use super::body::{Frame, frame};
use super::contact::Contact;
use super::held::HeldForces;
use super::{Evaluation, Mechanism, MechanismEnergy, QUADRATURES};
use crate::integrate::{
    ContactAngles, ContactReading, Impact, Integration, IntegrationError, Pause, SlicedPlant, Tolerances,
    integrate_slices, resume,
};
use crate::plants::transmission::BearingForces;
use std::cell::RefCell;

/// Position and motion of a body at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState {
    /// Centre of mass in m and angle in rad.
    pub position: [f64; 3],
    /// Their rates in m/s and rad/s.
    pub rate: [f64; 3],
}

/// A contact at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactState {
    /// Deformation in m, negative in a gap.
    pub deformation_m: f64,
    /// Normal force in N.
    pub normal_n: f64,
    /// Friction force in N along the sliding direction.
    pub friction_n: f64,
    /// Sliding speed in m/s.
    pub sliding_m_s: f64,
    /// Position of a journal from the centre of its bearing in m, in the axes of the ground; 0 for
    /// other contacts.
    pub offset_m: [f64; 2],
}

/// State of a mechanism at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Time in s.
    pub time_s: f64,
    /// Bodies in the order of the description.
    pub bodies: Vec<BodyState>,
    /// Contacts in the order of the description.
    pub contacts: Vec<ContactState>,
    /// Forces of the drives in N or N m, in the order of the joints.
    pub drives: Vec<f64>,
}

impl Snapshot {
    /// Values of a log's columns after the time: positions of the bodies, contacts, drives.
    pub fn row(&self) -> impl Iterator<Item = f64> {
        let bodies = self.bodies.iter().flat_map(|body| body.position);
        let contacts =
            self.contacts.iter().flat_map(|c| [c.deformation_m, c.normal_n, c.friction_n, c.sliding_m_s]);
        bodies.chain(contacts).chain(self.drives.iter().copied())
    }
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct MechanismRun {
    /// Mechanism at the requested times.
    pub samples: Vec<Snapshot>,
    /// Mechanism at the end.
    pub end: Snapshot,
    /// Periods in contact, in the order of their onsets.
    pub impacts: Vec<Impact>,
    /// Energy balance.
    pub energy: MechanismEnergy,
    /// Integrator steps.
    pub steps: usize,
}

/// A mechanism at the end of a span from which it can continue.
pub(crate) struct Resumed {
    pub(crate) state: Vec<f64>,
    /// Periods in contact that the span touches.
    pub(crate) impacts: Vec<Impact>,
    pub(crate) pause: Pause,
    pub(crate) snapshot: Snapshot,
}

/// Start and length of a run with its error control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RunOptions {
    /// Length in s.
    pub(crate) duration_s: f64,
    /// Relative tolerance.
    pub(crate) tolerance: f64,
    /// Largest step in s.
    pub(crate) largest_step_s: f64,
    /// True if the rates at the start satisfy closed contacts too.
    pub(crate) is_closed: bool,
}

/// A mechanism in a state of fixed size: the states beyond its own stay 0.
struct Padded<'a, 'b> {
    mechanism: &'a Mechanism,
    evaluation: RefCell<Evaluation>,
    held: Option<RefCell<&'a mut HeldForces<'b>>>,
    /// True if the run is one communication step of the held forces.
    is_single_step: bool,
}

impl Padded<'_, '_> {
    /// Held forces of a contact, if its forces are held.
    fn held(&self, slice: usize) -> Option<BearingForces> {
        self.held.as_ref()?;
        self.evaluation.try_borrow().ok()?.held[slice].map(|held| held.forces)
    }

    /// State of the mechanism; none within an evaluation.
    fn snapshot(&self, time_s: f64, state: &[f64], latched_m_s: &[Option<f64>]) -> Option<Snapshot> {
        let mut evaluation = self.evaluation.try_borrow_mut().ok()?;
        Some(self.mechanism.snapshot(time_s, state, latched_m_s, &mut evaluation))
    }

    /// Reads a contact from the frames of its two bodies, so that the cost of a reading does not
    /// depend on the number of bodies.
    fn read<T>(
        &self,
        slice: usize,
        (time_s, state): (f64, &[f64]),
        read: impl Fn(&Contact, [&Frame; 2]) -> T,
    ) -> T {
        let contact = &self.mechanism.contacts[slice];
        let [first, second] = self.mechanism.pair(contact, time_s, state);
        read(contact, [&first, &second])
    }
}

impl<const N: usize> SlicedPlant<N> for Padded<'_, '_> {
    fn slices(&self) -> usize {
        self.mechanism.contacts.len()
    }

    fn sliced_derivative(
        &self,
        time_s: f64,
        state: &[f64; N],
        latched_m_s: &[Option<f64>],
        derivative: &mut [f64; N],
    ) {
        // The borrow fails only in a nested evaluation, and none is nested.
        if let Ok(mut evaluation) = self.evaluation.try_borrow_mut() {
            self.mechanism.state_derivative((time_s, state), latched_m_s, &mut evaluation, derivative);
        }
    }

    fn slice_deformation(&self, slice: usize, time_s: f64, state: &[f64; N]) -> (f64, f64) {
        self.read(slice, (time_s, state), |contact, pair| contact.kind.deformation(time_s, pair))
    }

    fn slice_contact(&self, slice: usize, time_s: f64, state: &[f64; N], latched_m_s: f64) -> ContactReading {
        let law =
            self.read(slice, (time_s, state), |contact, pair| contact.reading(time_s, pair, latched_m_s));
        ContactReading { force_n: self.held(slice).map_or(law.force_n, |held| held.normal_n), ..law }
    }

    fn next_change_s(&self, time_s: f64) -> f64 {
        if self.is_single_step {
            return f64::INFINITY;
        }
        let step_s = self.held.as_ref().and_then(|held| Some(held.try_borrow().ok()?.step_s));
        step_s.map_or(f64::INFINITY, |step_s| ((time_s / step_s).round() + 1.0) * step_s)
    }

    fn change(&self, time_s: f64, state: &[f64; N], latched_m_s: &[Option<f64>]) {
        let Some(held) = &self.held else { return };
        if let (Ok(mut source), Ok(mut evaluation)) =
            (held.try_borrow_mut(), self.evaluation.try_borrow_mut())
        {
            self.mechanism.hold(&mut source, (time_s, state), latched_m_s, &mut evaluation);
        }
    }

    fn slice_angles(&self, slice: usize, time_s: f64, state: &[f64; N]) -> ContactAngles {
        let crank_rad = self.mechanism.frames(time_s, state).first().map_or(0.0, |frame| frame.angle_rad);
        let contact_rad = self.read(slice, (time_s, state), |contact, pair| contact.kind.angle_rad(pair));
        ContactAngles { crank_rad, contact_rad }
    }
}

impl Mechanism {
    /// Runs the mechanism and records it at ascending times. The forces of some contacts may be
    /// held.
    pub(crate) fn run(
        &self,
        samples_s: &[f64],
        options: &RunOptions,
        held: Option<&mut HeldForces<'_>>,
    ) -> Result<MechanismRun, IntegrationError> {
        // The integrator's state has a size that is fixed at compile time.
        match self.states() {
            0..=12 => self.run_padded::<12>(samples_s, options, held),
            13..=24 => self.run_padded::<24>(samples_s, options, held),
            25..=48 => self.run_padded::<48>(samples_s, options, held),
            49..=128 => self.run_padded::<128>(samples_s, options, held),
            _ => self.run_padded::<MAX_STATES>(samples_s, options, held),
        }
    }

    /// Continues a run from a state over a span, which is one communication step of held forces.
    pub(crate) fn resume(
        &self,
        span_s: (f64, f64),
        from: (&[f64], &Pause),
        options: &RunOptions,
        held: Option<&mut HeldForces<'_>>,
    ) -> Result<Resumed, IntegrationError> {
        match self.states() {
            0..=12 => self.resume_padded::<12>(span_s, from, options, held),
            13..=24 => self.resume_padded::<24>(span_s, from, options, held),
            25..=48 => self.resume_padded::<48>(span_s, from, options, held),
            49..=128 => self.resume_padded::<128>(span_s, from, options, held),
            _ => self.resume_padded::<MAX_STATES>(span_s, from, options, held),
        }
    }

    fn resume_padded<const N: usize>(
        &self,
        span_s: (f64, f64),
        (state, pause): (&[f64], &Pause),
        options: &RunOptions,
        held: Option<&mut HeldForces<'_>>,
    ) -> Result<Resumed, IntegrationError> {
        let initial: [f64; N] = std::array::from_fn(|i| state.get(i).copied().unwrap_or_default());
        let (evaluation, held) = (RefCell::new(self.evaluation()), held.map(RefCell::new));
        let plant = Padded { mechanism: self, evaluation, held, is_single_step: true };
        let Integration { state, impacts, pause, .. } =
            resume(&plant, span_s, (initial, &pause.clone()), &self.tolerances(options))?;
        self.check_deformation(&impacts)?;
        let latched: Vec<Option<f64>> = pause.contacts.iter().map(|contact| contact.latched_m_s).collect();
        let snapshot = self.snapshot(span_s.1, &state, &latched, &mut plant.evaluation.into_inner());
        let state = state[..self.states().min(N)].to_vec();
        Ok(Resumed { state, impacts, pause, snapshot })
    }

    /// Mechanism at its start, with the contacts that a run starts in.
    pub(crate) fn start(&self, is_closed: bool) -> (Vec<f64>, Vec<bool>, Snapshot) {
        let state = self.initial_state(is_closed);
        let touching = self.start_contacts(&state);
        let latched: Vec<Option<f64>> = touching.iter().map(|touches| touches.then_some(0.0)).collect();
        let snapshot = self.snapshot(0.0, &state, &latched, &mut self.evaluation());
        (state, touching, snapshot)
    }

    fn run_padded<const N: usize>(
        &self,
        samples_s: &[f64],
        options: &RunOptions,
        held: Option<&mut HeldForces<'_>>,
    ) -> Result<MechanismRun, IntegrationError> {
        let start = self.initial_state(options.is_closed);
        let initial: [f64; N] = std::array::from_fn(|i| start.get(i).copied().unwrap_or_default());
        let in_contact: Vec<bool> = self.start_contacts(&start);
        let mut samples = Vec::with_capacity(samples_s.len());
        let end_s = options.duration_s;
        let mut latched = vec![None; self.contacts.len()];
        let held = held.map(RefCell::new);
        let evaluation = RefCell::new(self.evaluation());
        let plant = Padded { mechanism: self, evaluation, held, is_single_step: false };
        let result = integrate_slices(
            &plant,
            (0.0, end_s),
            initial,
            &in_contact,
            samples_s,
            &self.tolerances(options),
            |t, s, held| {
                samples.extend(plant.snapshot(t, s, held));
                latched.copy_from_slice(held);
            },
        )?;
        self.check_deformation(&result.impacts)?;
        for (contact, held) in latched.iter_mut().enumerate() {
            let open = result.impacts.iter().rfind(|i| i.contact == contact && i.separation_s.is_none());
            *held = open.map(|impact| impact.approach_speed_m_s);
        }
        Ok(MechanismRun {
            samples,
            end: self.snapshot(end_s, &result.state, &latched, &mut plant.evaluation.into_inner()),
            energy: self.balance((0.0, &initial), (end_s, &result.state)),
            impacts: result.impacts,
            steps: result.steps,
        })
    }

    /// Contacts that touch at the start.
    fn start_contacts(&self, start: &[f64]) -> Vec<bool> {
        let frames = self.frames(0.0, start);
        let touches = |contact: &Contact| {
            let pair = contact.kind.bodies().map(|body| frame(&frames, body));
            contact.kind.deformation(0.0, pair).0 > 0.0
        };
        self.contacts.iter().map(touches).collect()
    }

    /// Error control: works are not controlled; bristles relative to their own deflection. The
    /// method's norm is a mean over all states, so the tolerance is reduced to compensate for those
    /// that are not controlled.
    fn tolerances<const N: usize>(&self, options: &RunOptions) -> Tolerances<N> {
        let controlled = self.states() - QUADRATURES;
        let relative = options.tolerance * (controlled.max(1) as f64 / N as f64).sqrt();
        let mut absolute = [f64::INFINITY; N];
        absolute[..self.works()].fill(relative * 1e-2);
        for contact in &self.contacts {
            if let (Some(index), Some(law)) = (contact.bristle, contact.friction) {
                let deflection_m = law.steady_deflection_m(1.0).abs();
                absolute[self.works() + QUADRATURES + index] = relative * deflection_m;
            }
        }
        Tolerances { relative, absolute, largest_step_s: options.largest_step_s }
    }

    fn snapshot(
        &self,
        time_s: f64,
        state: &[f64],
        latched_m_s: &[Option<f64>],
        evaluation: &mut Evaluation,
    ) -> Snapshot {
        let drives = self.drive_forces(time_s, state, latched_m_s, evaluation);
        let frames = &evaluation.frames;
        let bodies = frames.iter().map(|frame| BodyState {
            position: [frame.position_m[0], frame.position_m[1], frame.angle_rad],
            rate: frame.rates(),
        });
        let contacts = self.contacts.iter().zip(latched_m_s).enumerate().map(|(i, (contact, latched))| {
            let pair = contact.kind.bodies().map(|body| frame(frames, body));
            let touch = contact.kind.at(time_s, pair);
            let force = |l: f64| contact.forces_n(&touch, l, self.bristle_m(contact, state));
            let (normal_n, friction_n) = match &evaluation.held[i] {
                Some(held) => (held.forces.normal_n, held.forces.friction_n),
                None => latched.map_or((0.0, 0.0), force),
            };
            let (deformation_m, sliding_m_s) = (touch.depth_m, touch.sliding_m_s);
            ContactState {
                deformation_m,
                normal_n,
                friction_n,
                sliding_m_s,
                offset_m: contact.kind.offset_m(pair),
            }
        });
        Snapshot { time_s, bodies: bodies.collect(), contacts: contacts.collect(), drives }
    }

    /// Refuses contacts that are deeper than the range of their normal law.
    fn check_deformation(&self, impacts: &[Impact]) -> Result<(), IntegrationError> {
        for impact in impacts {
            let law = self.contacts.get(impact.contact).map(|contact| contact.law.law);
            let largest = law.and_then(|law| law.largest_deformation_m());
            if let Some(largest_m) = largest.filter(|largest| impact.max_deformation_m > *largest) {
                let deformation_m = impact.max_deformation_m;
                return Err(IntegrationError::OutsideLaw { deformation_m, largest_m });
            }
        }
        Ok(())
    }
}

/// Maximum number of states of a mechanism.
pub(crate) const MAX_STATES: usize = 384;
