//! An instance of a unit, independent of the version of the interface.

use crate::model::{Model, TOLERANCE};
use crate::simulator::{Memory, Simulator};
use crate::variable::{Causality, Type, Variable};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Phase of an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    /// Parameters may be set.
    Instantiated,
    /// Parameters may be set, and outputs read.
    Initialising,
    /// Steps may be taken.
    Running,
    /// Only reading and reset.
    Terminated,
}

/// Everything that changes in an instance, as plain data: a state that can be saved and restored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    /// Number of variables and identifier of the unit whose state this is.
    unit: (usize, String),
    phase: Phase,
    time_s: f64,
    values: Vec<f64>,
    memory: Option<Memory>,
}

/// An instance. Errors are messages for the log.
pub(crate) struct Instance {
    model: Model,
    state: State,
    /// Simulator with the parameters of the state; none while they may change.
    simulator: Option<Simulator>,
    /// True if inputs or parameters were set after the outputs were computed.
    is_stale: bool,
}

/// Share of a step by which the start of the next one may differ from the time reached.
const TIME_SHARE: f64 = 1e-6;

impl Instance {
    /// Reads the unit from its resources. `guid` must be its own.
    pub(crate) fn open(resources: &Path, guid: &str) -> Result<Self, String> {
        let (model, own) = Model::read(resources)?;
        if guid != own {
            return Err(format!("identifier: found {guid}; expected {own}, that of the model description"));
        }
        Ok(Self::new(model, own))
    }

    pub(crate) fn new(model: Model, guid: String) -> Self {
        let values = model.start_values();
        let unit = (values.len(), guid);
        let state = State { unit, phase: Phase::Instantiated, time_s: 0.0, values, memory: None };
        Self { model, state, simulator: None, is_stale: false }
    }

    fn variable(&self, reference: u32, kind: Type) -> Result<&Variable, String> {
        let variable = self.model.variables().get(reference as usize);
        let variable =
            variable.ok_or_else(|| format!("value reference {reference}: found no such variable"))?;
        if variable.kind == kind {
            Ok(variable)
        } else {
            let (name, own) = (&variable.name, variable.kind);
            Err(format!("{name}: found a call for type {kind:?}; expected {own:?}"))
        }
    }

    /// Value of a variable.
    pub(crate) fn get(&mut self, reference: u32, kind: Type) -> Result<f64, String> {
        let causality = self.variable(reference, kind)?.causality;
        if causality == Causality::Time {
            return Ok(self.state.time_s);
        }
        if causality == Causality::Output {
            self.refresh()?;
        }
        Ok(self.state.values.get(reference as usize).copied().unwrap_or_default())
    }

    /// Sets a variable.
    pub(crate) fn set(&mut self, reference: u32, kind: Type, value: f64) -> Result<(), String> {
        let phase = self.state.phase;
        let variable = self.variable(reference, kind)?;
        let name = &variable.name;
        let is_before = matches!(phase, Phase::Instantiated | Phase::Initialising);
        match variable.causality {
            Causality::Time | Causality::Output => {
                return Err(format!("{name}: found a value; expected none: it is an output"));
            }
            Causality::Fixed if !is_before => {
                return Err(format!(
                    "{name}: found a value during the simulation; expected none: it is fixed"
                ));
            }
            _ if phase == Phase::Terminated => {
                return Err(format!("{name}: found a value; expected none after the end of the simulation"));
            }
            _ => {}
        }
        if !variable.kind.admits(value) {
            return Err(format!("{name}: found {value}; expected a finite number of type {kind:?}"));
        }
        if let Some((low, high)) = variable.range.filter(|(low, high)| !(low..=high).contains(&&value)) {
            return Err(format!("{name}: found {value}; expected {low} to {high}"));
        }
        let is_fixed = variable.causality == Causality::Fixed;
        if let Some(place) = self.state.values.get_mut(reference as usize) {
            self.is_stale |= *place != value;
            *place = value;
        }
        if is_fixed {
            self.simulator = None;
        }
        Ok(())
    }

    /// Computes the outputs again if something that they depend on was set.
    fn refresh(&mut self) -> Result<(), String> {
        if self.state.phase == Phase::Initialising && (self.is_stale || self.state.memory.is_none()) {
            return self.start();
        }
        let inputs = self.model.inputs(&self.state.values);
        if let (true, Some(simulator), Some(memory)) = (self.is_stale, &self.simulator, &self.state.memory)
            && let Some(outputs) = simulator.direct(memory, inputs)?
        {
            self.model.outputs_mut(&mut self.state.values).copy_from_slice(&outputs);
            self.is_stale = false;
        }
        Ok(())
    }

    /// Builds the simulator and starts it.
    fn start(&mut self) -> Result<(), String> {
        let mut simulator = self.model.simulator(&self.state.values)?;
        let inputs = self.model.inputs(&self.state.values);
        let (memory, outputs) = simulator.start(self.state.time_s, inputs)?;
        self.model.outputs_mut(&mut self.state.values).copy_from_slice(&outputs);
        (self.simulator, self.state.memory, self.is_stale) = (Some(simulator), Some(memory), false);
        Ok(())
    }

    /// Sets the start time in s, and the tolerance if the program states one.
    pub(crate) fn set_up(&mut self, start_s: f64, tolerance: Option<f64>) -> Result<(), String> {
        self.require(Phase::Instantiated, "the setup")?;
        if !start_s.is_finite() {
            return Err(format!("start time: found {start_s}; expected a finite time"));
        }
        // A contact integrates nothing, so it has no tolerance.
        let reference = self.model.variables().iter().position(|variable| variable.name == TOLERANCE);
        if let (Some(tolerance), Some(reference)) = (tolerance, reference) {
            // The program's value is a wish; 0 or less is none.
            let range = self.model.variables().get(reference).and_then(|variable| variable.range);
            if let Some((low, high)) = range.filter(|_| tolerance > 0.0) {
                self.set(reference as u32, Type::Real, tolerance.clamp(low, high))?;
            }
        }
        self.state.time_s = start_s;
        Ok(())
    }

    /// Begins the initialisation.
    pub(crate) fn enter_initialisation(&mut self) -> Result<(), String> {
        self.require(Phase::Instantiated, "the initialisation")?;
        self.state.phase = Phase::Initialising;
        Ok(())
    }

    /// Ends the initialisation.
    pub(crate) fn exit_initialisation(&mut self) -> Result<(), String> {
        self.require(Phase::Initialising, "the end of the initialisation")?;
        self.start()?;
        self.state.phase = Phase::Running;
        Ok(())
    }

    /// Takes a step.
    pub(crate) fn step(&mut self, start_s: f64, step_s: f64) -> Result<(), String> {
        self.require(Phase::Running, "a step")?;
        let time_s = self.state.time_s;
        if !(step_s.is_finite() && step_s > 0.0) {
            return Err(format!("step: found {step_s} s; expected a positive one"));
        }
        if (start_s - time_s).abs() > TIME_SHARE * step_s {
            return Err(format!("step: found a start at {start_s} s; expected {time_s} s, the time reached"));
        }
        let inputs = self.model.inputs(&self.state.values);
        let (Some(simulator), Some(memory)) = (&mut self.simulator, &mut self.state.memory) else {
            return Err("found no simulation to continue".into());
        };
        // A failed step leaves the state as it was.
        let (mut next, end_s) = (memory.clone(), start_s + step_s);
        match simulator.step(&mut next, (start_s, end_s), inputs) {
            Ok(outputs) => {
                *memory = next;
                self.model.outputs_mut(&mut self.state.values).copy_from_slice(&outputs);
                (self.state.time_s, self.is_stale) = (end_s, true);
                Ok(())
            }
            Err(error) => {
                simulator.restore(memory);
                Err(error)
            }
        }
    }

    /// Ends the simulation.
    pub(crate) fn terminate(&mut self) -> Result<(), String> {
        self.require(Phase::Running, "the end of the simulation")?;
        self.state.phase = Phase::Terminated;
        Ok(())
    }

    /// Returns to the state after the instantiation.
    pub(crate) fn reset(&mut self) {
        let guid = std::mem::take(&mut self.state.unit.1);
        *self = Self::new(self.model.clone(), guid);
    }

    /// The present state.
    pub(crate) fn save(&self) -> State {
        self.state.clone()
    }

    /// Returns to a saved state.
    pub(crate) fn restore(&mut self, state: State) -> Result<(), String> {
        if state.unit != self.state.unit || state.values.len() != self.state.values.len() {
            return Err("state: found that of another unit".into());
        }
        self.simulator = match &state.memory {
            Some(memory) => {
                let mut simulator = self.model.simulator(&state.values)?;
                simulator.restore(memory);
                Some(simulator)
            }
            None => None,
        };
        (self.state, self.is_stale) = (state, true);
        Ok(())
    }

    fn require(&self, phase: Phase, call: &str) -> Result<(), String> {
        if self.state.phase == phase {
            Ok(())
        } else {
            Err(format!("found a call for {call} in phase {:?}; expected phase {phase:?}", self.state.phase))
        }
    }
}

impl State {
    /// Bytes of the state.
    pub(crate) fn to_bytes(&self) -> Result<Vec<u8>, String> {
        postcard::to_allocvec(self).map_err(|error| format!("state: {error}"))
    }

    /// State from its bytes.
    pub(crate) fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        postcard::from_bytes(bytes).map_err(|error| format!("state: {error}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Kind;
    use bench::Bench;

    fn instance(kind: Kind, bench: &str, has_networks: bool) -> Instance {
        let mut bench = Bench::open(bench).unwrap();
        if let (Bench::Mechanism(plant), true) = (&mut bench, has_networks) {
            plant.contact[0].network = Some(bench::BearingMaterial::Babbitt);
        }
        let model = Model::new(kind, bench, Path::new("."), has_networks, Vec::new()).unwrap();
        let mut instance = Instance::new(model, "{test}".into());
        instance.set_up(0.0, None).unwrap();
        instance.enter_initialisation().unwrap();
        instance.exit_initialisation().unwrap();
        instance
    }

    /// Outputs after each of some steps from a number on.
    fn steps(instance: &mut Instance, numbers: std::ops::Range<u32>) -> Vec<Vec<f64>> {
        let step_s = 1e-4;
        let outputs: Vec<(u32, Type)> = instance
            .model
            .variables()
            .iter()
            .zip(0..)
            .filter(|(v, _)| v.causality == Causality::Output)
            .map(|(v, reference)| (reference, v.kind))
            .collect();
        numbers
            .map(|number| {
                // A contact is pressed deeper and deeper.
                if let Some(at) =
                    instance.model.variables().iter().position(|v| v.name == "journal_speed_rad_s")
                {
                    let depth_m = -0.5e-3 - f64::from(number) * 1e-7;
                    let z = instance.model.variables().iter().position(|v| v.name == "journal_z_m").unwrap();
                    instance.set(z as u32, Type::Real, depth_m).unwrap();
                    instance.set(at as u32, Type::Real, 1.0).unwrap();
                }
                instance.step(f64::from(number) * step_s, step_s).unwrap();
                outputs.iter().map(|(reference, kind)| instance.get(*reference, *kind).unwrap()).collect()
            })
            .collect()
    }

    #[test]
    fn a_restored_state_continues_to_the_bit_with_laws_and_with_networks() {
        for (kind, bench) in
            [(Kind::Contact, "bench-b"), (Kind::Bench, "bench-b"), (Kind::Mechanism, "four-bar")]
        {
            for has_networks in [false, true] {
                let mut first = instance(kind, bench, has_networks);
                steps(&mut first, 0..30);
                let bytes = first.save().to_bytes().unwrap();
                let expected = steps(&mut first, 30..50);
                assert!(expected.iter().flatten().any(|value| *value != 0.0));
                first.restore(State::from_bytes(&bytes).unwrap()).unwrap();
                assert_eq!(steps(&mut first, 30..50), expected, "{kind:?} {has_networks}");
                let mut other = instance(kind, bench, has_networks);
                other.restore(State::from_bytes(&bytes).unwrap()).unwrap();
                assert_eq!(steps(&mut other, 30..50), expected, "{kind:?} {has_networks}");
            }
        }
    }

    #[test]
    fn a_reset_instance_starts_anew_and_a_foreign_state_is_refused() {
        let mut first = instance(Kind::Bench, "bench-b", true);
        let expected = steps(&mut first, 0..20);
        first.reset();
        assert!(first.step(0.0, 1e-4).is_err(), "not initialised");
        first.enter_initialisation().unwrap();
        first.exit_initialisation().unwrap();
        assert_eq!(steps(&mut first, 0..20), expected);
        let foreign = instance(Kind::Contact, "bench-b", false).save();
        assert!(first.restore(foreign).unwrap_err().contains("another unit"));
        assert!(State::from_bytes(&[1, 2, 3]).is_err());
    }

    #[test]
    fn a_failed_step_leaves_the_state_and_the_networks_as_they_were() {
        let mut first = instance(Kind::Bench, "bench-b", true);
        let place = |name: &str, of: &Instance| of.model.variables().iter().position(|v| v.name == name);
        let (load, switch) = (place("load_n", &first).unwrap(), place("external_load", &first).unwrap());
        first.reset();
        first.set(switch as u32, Type::Boolean, 1.0).unwrap();
        first.enter_initialisation().unwrap();
        first.exit_initialisation().unwrap();
        steps(&mut first, 0..20);
        let before = first.save();
        assert!(first.step(1.0, 1e-4).unwrap_err().contains("expected 0.002"));
        assert!(first.step(20.0 * 1e-4, f64::NAN).is_err());
        assert!(first.set(load as u32, Type::Real, f64::INFINITY).is_err());
        assert!(first.set(load as u32, Type::Integer, 1.0).is_err());
        assert_eq!(first.save(), before);
        // A load beyond all numbers ends a step in its middle, after the networks have read.
        let set = |instance: &mut Instance, value: f64| instance.set(load as u32, Type::Real, value).unwrap();
        set(&mut first, 1e300);
        assert!(first.step(20.0 * 1e-4, 1e-4).is_err());
        set(&mut first, 0.0);
        let expected = steps(&mut instance_at(&before), 20..30);
        assert_eq!(steps(&mut first, 20..30), expected);
    }

    fn instance_at(state: &State) -> Instance {
        let mut other = instance(Kind::Bench, "bench-b", true);
        other.restore(state.clone()).unwrap();
        other
    }
}
