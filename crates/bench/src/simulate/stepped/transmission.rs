//! The transmission bench in steps.

use super::{HeldMemory, Memory};
use crate::description::TransmissionBench;
use crate::integrate::{Impact, IntegrationError, Touch};
use crate::plants::transmission::{
    BearingForces, ContactView, STATES, ServoPlant, Snapshot, State, Transmission,
};
use crate::signals::{Motion, Profile};
use serde::{Deserialize, Serialize};

/// Inputs of a step that replace what the description says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct External {
    /// Motion of the drive at the start of the step; over the step it is uniformly accelerated.
    pub drive: Option<Motion>,
    /// Load in N, constant over the step.
    pub load_n: Option<f64>,
}

/// The bench between two steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BenchMemory {
    kind: Kind,
    /// Contacts that have begun.
    pub contacts: u32,
    /// Largest normal force in N of the present contact, or of the last one.
    pub peak_force_n: f64,
}

/// Memory by the source of the bearing force.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Kind {
    /// The analytic laws, integrated with the bench.
    Law(Memory),
    /// A force that is held over a communication step, with that of the last one.
    Held(Box<(HeldMemory, [f64; 2])>),
}

impl BenchMemory {
    fn count(&mut self, impact: &Impact, has_begun: bool) {
        self.contacts = self.contacts.saturating_add(u32::from(has_begun));
        self.peak_force_n = impact.peak_force_n;
    }
}

/// A resolved transmission bench, ready for steps.
#[derive(Clone, Debug)]
pub struct SteppedBench {
    bench: TransmissionBench,
    plant: Transmission,
    tolerance: f64,
}

impl SteppedBench {
    /// Builds the plant of a resolved planar description; `tolerance` is the relative one of the
    /// integrator.
    pub fn new(bench: &TransmissionBench, tolerance: f64) -> Self {
        let plant = Transmission::new(bench, bench.drive_profile(), bench.load_profile());
        Self { bench: bench.clone(), plant, tolerance }
    }

    fn apply(&mut self, time_s: f64, external: &External) {
        let held = |motion: Motion| Profile::Accelerated { at_s: time_s, motion };
        let drive = external.drive.map_or_else(|| self.bench.drive_profile(), held);
        let load = external.load_n.map(|value| held(Motion { value, ..Motion::default() }));
        self.plant.set_profiles(drive, load.unwrap_or_else(|| self.bench.load_profile()));
    }

    /// Bench at its start. With `is_held` its steps are those of [`Self::step_held`].
    pub fn start(&mut self, time_s: f64, external: &External, is_held: bool) -> BenchMemory {
        self.apply(time_s, external);
        let kind = match (is_held, ServoPlant::new(&self.bench, &self.plant)) {
            (true, _) => Kind::Held(Box::new((HeldMemory::start(&self.plant, time_s), [0.0; 2]))),
            (false, Some(servo)) => Kind::Law(Memory::new(servo.initial_state(time_s).to_vec(), 1)),
            (false, None) => Kind::Law(Memory::new(self.plant.initial_state(time_s).to_vec(), 1)),
        };
        BenchMemory { kind, contacts: 0, peak_force_n: 0.0 }
    }

    /// Integrates the bench with its analytic laws from `start_s` to `end_s`.
    pub fn step(
        &mut self,
        memory: &mut BenchMemory,
        span_s: (f64, f64),
        external: &External,
    ) -> Result<(), IntegrationError> {
        self.apply(span_s.0, external);
        let Kind::Law(own) = &mut memory.kind else { return Err(other_kind(span_s.0)) };
        let impacts = match ServoPlant::new(&self.bench, &self.plant) {
            Some(servo) => own.advance(&servo, span_s, &servo.tolerances(self.tolerance))?,
            None => own.advance(&self.plant, span_s, &self.plant.tolerances(self.tolerance))?,
        };
        self.plant.check_deformation(&impacts)?;
        for impact in &impacts {
            memory.count(impact, impact.onset_s > span_s.0);
        }
        Ok(())
    }

    /// Integrates the bench from `start_s` to `end_s` in equal communication steps of at most
    /// `step_s`, over each of which `force` is held.
    pub fn step_held(
        &mut self,
        memory: &mut BenchMemory,
        (start_s, end_s): (f64, f64),
        external: &External,
        (step_s, force): (f64, &mut dyn FnMut(&ContactView) -> BearingForces),
    ) -> Result<(), IntegrationError> {
        self.apply(start_s, external);
        // A span that is a multiple of the step within rounding is that many steps.
        let count = ((end_s - start_s) / step_s - 1e-6).ceil().max(1.0) as u32;
        let step_s = (end_s - start_s) / f64::from(count);
        for step in 0..count {
            let time_s = start_s + f64::from(step) * step_s;
            let Kind::Held(held) = &mut memory.kind else { return Err(other_kind(time_s)) };
            let was_touching = held.0.contact.impact.is_some();
            let moment = held.0.step(&self.plant, time_s, step_s, force)?;
            held.1 = [moment.snapshot.forces.normal_n, moment.snapshot.forces.friction_n];
            let impact = held.0.contact.impact;
            let impacts: Vec<Impact> = moment.ended.into_iter().chain(impact).collect();
            self.plant.check_deformation(&impacts)?;
            for impact in &impacts {
                memory.count(impact, !was_touching);
            }
        }
        Ok(())
    }

    /// Velocity of the journal's centre along Y and Z in m/s.
    pub fn journal_velocity_m_s(memory: &BenchMemory) -> [f64; 2] {
        let state = match &memory.kind {
            Kind::Law(law) => &law.state[..],
            Kind::Held(held) => &held.0.state[..],
        };
        [2, 3].map(|i| state.get(i).copied().unwrap_or_default())
    }

    /// Quantities of the bench at a time that a step has reached which began at `from_s`.
    pub fn snapshot(
        &mut self,
        time_s: f64,
        memory: &BenchMemory,
        (from_s, external): (f64, &External),
    ) -> Snapshot {
        self.apply(from_s, external);
        let law = match &memory.kind {
            Kind::Held(held) => {
                let (HeldMemory { state, .. }, [normal_n, friction_n]) = &**held;
                let forces = BearingForces { normal_n: *normal_n, friction_n: *friction_n };
                let latched_m_s = held.0.contact.latched_m_s();
                return self.plant.snapshot(time_s, state, latched_m_s, forces);
            }
            Kind::Law(law) => law,
        };
        let contact = law.pause.contacts.first().copied().unwrap_or_default();
        let touch = Touch { latched_m_s: contact.latched_m_s.unwrap_or_default(), slip: contact.slip };
        let servo = ServoPlant::new(&self.bench, &self.plant);
        if let (Some(servo), Some(state)) = (servo, law.state.first_chunk()) {
            return servo.snapshot(time_s, state, touch);
        }
        let state: State = law.state.first_chunk().copied().unwrap_or([0.0; STATES]);
        let forces = self.plant.forces(time_s, &state, touch);
        self.plant.snapshot(time_s, &state, touch.latched_m_s, forces)
    }
}

/// Error of a memory that belongs to steps of the other kind.
fn other_kind(time_s: f64) -> IntegrationError {
    IntegrationError::Stopped { time_s, reason: "the memory is of the other source of force".into() }
}
