//! A mechanism in steps.

use crate::description::MechanismBench;
use crate::integrate::{ContactPhase, Impact, IntegrationError, Pause};
use crate::plants::mechanism::{HeldForces, Mechanism, Resumed, RunOptions, Snapshot};
use crate::plants::transmission::{BearingForces, ContactView};
use serde::{Deserialize, Serialize};

/// A mechanism between two steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MechanismMemory {
    state: Vec<f64>,
    pause: Pause,
    /// Periods in contact that have begun, by contact.
    pub contacts: Vec<u32>,
    /// Largest normal force in N of the present or last period of each contact.
    pub peak_force_n: Vec<f64>,
}

/// A mechanism, ready for steps.
#[derive(Clone, Debug)]
pub struct SteppedMechanism {
    mechanism: Mechanism,
    options: RunOptions,
    /// Index of the load of the first body from outside.
    first_load: usize,
    /// True for each contact whose forces come from networks.
    networks: Vec<bool>,
}

impl SteppedMechanism {
    /// Builds a mechanism; with `has_networks` the described networks give forces. The
    /// error is that of a run.
    pub fn new(bench: &MechanismBench, has_networks: bool) -> Result<Self, IntegrationError> {
        let refused = |reason: String| IntegrationError::Stopped { time_s: 0.0, reason };
        let mut mechanism = bench.mechanism().map_err(|error| refused(error.to_string()))?;
        let first_load = mechanism.add_external_loads();
        let networks = bench.networks().iter().map(|network| has_networks && network.is_some()).collect();
        Ok(Self { mechanism, options: bench.run_options(bench.run.tolerance), first_load, networks })
    }

    /// Mechanism at time 0.
    pub fn start(&self) -> (MechanismMemory, Snapshot) {
        let (state, touching, snapshot) = self.mechanism.start(self.options.is_closed);
        let phase = |(contact, touches): (usize, &bool)| ContactPhase {
            latched_m_s: touches.then_some(0.0),
            impact: touches.then(|| Impact { contact, ..Impact::default() }),
            ..ContactPhase::default()
        };
        let contacts = touching.iter().map(|touches| u32::from(*touches)).collect();
        let peak_force_n = vec![0.0; touching.len()];
        let pause = Pause { contacts: touching.iter().enumerate().map(phase).collect(), step_s: 0.0 };
        (MechanismMemory { state, pause, contacts, peak_force_n }, snapshot)
    }

    /// Integrates from `start_s` to `end_s` under a force in N and a torque in N m on the centre of
    /// mass of each body, besides the described loads.
    ///
    /// Contacts with networks take their forces from `force` in equal communication steps of at
    /// most `step_s`.
    pub fn step(
        &mut self,
        memory: &mut MechanismMemory,
        (start_s, end_s): (f64, f64),
        loads: &[[f64; 3]],
        (step_s, force): (f64, &mut dyn FnMut(usize, &ContactView) -> BearingForces),
    ) -> Result<Snapshot, IntegrationError> {
        for (load, [x, y, torque_nm]) in self.mechanism.loads.iter_mut().skip(self.first_load).zip(loads) {
            (load.force_n, load.torque_nm) = ([*x, *y], *torque_nm);
        }
        let is_held = self.networks.contains(&true);
        // A span that is a multiple of the step within rounding is that many steps.
        let count = if is_held { ((end_s - start_s) / step_s - 1e-6).ceil().max(1.0) } else { 1.0 };
        let step_s = (end_s - start_s) / count;
        let mut step = 0.0;
        loop {
            let from_s = start_s + step * step_s;
            step += 1.0;
            let to_s = if step < count { start_s + step * step_s } else { end_s };
            let mut held = HeldForces { step_s, contacts: self.networks.clone(), force: &mut *force };
            let from = (&memory.state[..], &memory.pause);
            let Resumed { state, impacts, pause, snapshot } =
                self.mechanism.resume((from_s, to_s), from, &self.options, is_held.then_some(&mut held))?;
            memory.count(&impacts, from_s);
            (memory.state, memory.pause) = (state, pause);
            if step >= count {
                return Ok(snapshot);
            }
        }
    }
}

impl MechanismMemory {
    /// Counts the periods in contact of a span that began at `start_s`.
    fn count(&mut self, impacts: &[Impact], start_s: f64) {
        for impact in impacts {
            if let Some(contacts) = self.contacts.get_mut(impact.contact) {
                *contacts = contacts.saturating_add(u32::from(impact.onset_s > start_s));
            }
            if let Some(peak_n) = self.peak_force_n.get_mut(impact.contact) {
                *peak_n = impact.peak_force_n;
            }
        }
    }
}
