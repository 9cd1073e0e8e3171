//! Runs of a mechanism: the integrator for its number of states, and what a run records.

use super::{Mechanism, MechanismEnergy, QUADRATURES};
use crate::integrate::{
    ContactAngles, ContactReading, Impact, IntegrationError, SlicedPlant, Tolerances, integrate_slices,
};

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
struct Padded<'a>(&'a Mechanism);

impl<const N: usize> SlicedPlant<N> for Padded<'_> {
    fn slices(&self) -> usize {
        self.0.contacts.len()
    }

    fn sliced_derivative(
        &self,
        time_s: f64,
        state: &[f64; N],
        latched_m_s: &[Option<f64>],
        derivative: &mut [f64; N],
    ) {
        self.0.state_derivative(time_s, state, latched_m_s, derivative);
    }

    fn slice_deformation(&self, slice: usize, time_s: f64, state: &[f64; N]) -> (f64, f64) {
        let touch = self.0.contacts[slice].kind.at(time_s, &self.0.frames(state));
        (touch.depth_m, touch.rate_m_s)
    }

    fn slice_contact(&self, slice: usize, time_s: f64, state: &[f64; N], latched_m_s: f64) -> ContactReading {
        let contact = &self.0.contacts[slice];
        let touch = contact.kind.at(time_s, &self.0.frames(state));
        let force_n = contact.law.law.force_n(touch.depth_m, touch.rate_m_s, latched_m_s);
        ContactReading { depth_m: touch.depth_m, rate_m_s: touch.rate_m_s, force_n }
    }

    fn slice_angles(&self, slice: usize, time_s: f64, state: &[f64; N]) -> ContactAngles {
        let frames = self.0.frames(state);
        let touch = self.0.contacts[slice].kind.at(time_s, &frames);
        let crank_rad = frames.first().map_or(0.0, |frame| frame.angle_rad);
        ContactAngles { crank_rad, contact_rad: touch.angle_rad }
    }
}

impl Mechanism {
    /// Runs the mechanism and records it at ascending times.
    pub(crate) fn run(
        &self,
        samples_s: &[f64],
        options: &RunOptions,
    ) -> Result<MechanismRun, IntegrationError> {
        // The integrator's state has a size that is fixed at compile time.
        match self.states() {
            0..=32 => self.run_padded::<32>(samples_s, options),
            33..=96 => self.run_padded::<96>(samples_s, options),
            _ => self.run_padded::<MAX_STATES>(samples_s, options),
        }
    }

    fn run_padded<const N: usize>(
        &self,
        samples_s: &[f64],
        options: &RunOptions,
    ) -> Result<MechanismRun, IntegrationError> {
        let start = self.initial_state(options.is_closed);
        let initial: [f64; N] = std::array::from_fn(|i| start.get(i).copied().unwrap_or_default());
        let in_contact: Vec<bool> = self.start_contacts(&start);
        let mut samples = Vec::with_capacity(samples_s.len());
        let end_s = options.duration_s;
        let mut latched = vec![None; self.contacts.len()];
        let result = integrate_slices(
            &Padded(self),
            (0.0, end_s),
            initial,
            &in_contact,
            samples_s,
            &self.tolerances(options),
            |t, s, held| {
                samples.push(self.snapshot(t, s, held));
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
            end: self.snapshot(end_s, &result.state, &latched),
            energy: self.balance((0.0, &initial), (end_s, &result.state)),
            impacts: result.impacts,
            steps: result.steps,
        })
    }

    /// Contacts that touch at the start.
    fn start_contacts(&self, start: &[f64]) -> Vec<bool> {
        let frames = self.frames(start);
        self.contacts.iter().map(|contact| contact.kind.at(0.0, &frames).depth_m > 0.0).collect()
    }

    /// Error control: works are not controlled; bristles relative to their own deflection.
    fn tolerances<const N: usize>(&self, options: &RunOptions) -> Tolerances<N> {
        let mut absolute = [options.tolerance * 1e-2; N];
        absolute[self.works()..].fill(f64::INFINITY);
        for contact in &self.contacts {
            if let (Some(index), Some(law)) = (contact.bristle, contact.friction) {
                let deflection_m = law.steady_deflection_m(1.0).abs();
                absolute[self.works() + QUADRATURES + index] = options.tolerance * deflection_m;
            }
        }
        Tolerances { relative: options.tolerance, absolute, largest_step_s: options.largest_step_s }
    }

    fn snapshot(&self, time_s: f64, state: &[f64], latched_m_s: &[Option<f64>]) -> Snapshot {
        let frames = self.frames(state);
        let bodies = frames.iter().map(|frame| BodyState {
            position: [frame.position_m[0], frame.position_m[1], frame.angle_rad],
            rate: frame.rates(),
        });
        let contacts = self.contacts.iter().zip(latched_m_s).map(|(contact, latched)| {
            let touch = contact.kind.at(time_s, &frames);
            let force = |l: f64| contact.forces_n(&touch, l, self.bristle_m(contact, state));
            let (normal_n, friction_n) = latched.map_or((0.0, 0.0), force);
            let (deformation_m, sliding_m_s) = (touch.depth_m, touch.sliding_m_s);
            ContactState { deformation_m, normal_n, friction_n, sliding_m_s }
        });
        let multipliers = self.multipliers(time_s, state, latched_m_s);
        let drives = self.joints.iter().zip(multipliers).filter(|(joint, _)| joint.drive.is_some());
        Snapshot {
            time_s,
            bodies: bodies.collect(),
            contacts: contacts.collect(),
            drives: drives.map(|(_, multiplier)| multiplier).collect(),
        }
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
