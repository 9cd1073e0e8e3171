//! Simulators of the three kinds of units with one interface.

pub(crate) mod bench;
pub(crate) mod contact;
pub(crate) mod mechanism;

use self::bench::BenchSimulator;
use self::contact::ContactSimulator;
use self::mechanism::MechanismSimulator;
use crate::networks::{History, Networks};
use ::bench::plants::transmission::JointMemory;
use ::bench::simulate::stepped::{BenchMemory, MechanismMemory};
use serde::{Deserialize, Serialize};

/// Everything that a simulation remembers between two steps, as plain data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Memory {
    pub(crate) plant: PlantMemory,
    /// Histories of the networks, by contact.
    pub(crate) networks: Vec<History>,
}

/// Memory of a plant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum PlantMemory {
    Contact(JointMemory),
    Bench(BenchMemory),
    Mechanism(MechanismMemory),
}

/// Simulator with its parameters set. Inputs and outputs are in the order of the table of
/// variables. Errors are messages.
pub(crate) enum Simulator {
    Contact(ContactSimulator),
    Bench(Box<BenchSimulator>),
    Mechanism(Box<MechanismSimulator>),
}

/// A memory and the outputs at its time.
pub(crate) type Started = (Memory, Vec<f64>);

impl Simulator {
    /// Starts a simulation.
    pub(crate) fn start(&mut self, time_s: f64, inputs: &[f64]) -> Result<Started, String> {
        let (plant, outputs) = match self {
            Self::Contact(own) => own.start(inputs)?,
            Self::Bench(own) => own.start(time_s, inputs),
            Self::Mechanism(own) => own.start(time_s)?,
        };
        Ok((Memory { plant, networks: self.histories() }, outputs))
    }

    /// Takes a step and returns the outputs at its end.
    pub(crate) fn step(
        &mut self,
        memory: &mut Memory,
        span_s: (f64, f64),
        inputs: &[f64],
    ) -> Result<Vec<f64>, String> {
        let outputs = match (&mut *self, &mut memory.plant) {
            (Self::Contact(own), PlantMemory::Contact(plant)) => own.step(plant, span_s, inputs)?,
            (Self::Bench(own), PlantMemory::Bench(plant)) => own.step(plant, span_s, inputs)?,
            (Self::Mechanism(own), PlantMemory::Mechanism(plant)) => own.step(plant, span_s, inputs)?,
            _ => return Err("the state is that of another kind of unit".into()),
        };
        memory.networks = self.histories();
        Ok(outputs)
    }

    /// Outputs that follow from the present inputs without a step; none where they do not.
    pub(crate) fn direct(&self, memory: &Memory, inputs: &[f64]) -> Result<Option<Vec<f64>>, String> {
        match (self, &memory.plant) {
            (Self::Contact(own), PlantMemory::Contact(plant)) => own.read(plant, inputs).map(Some),
            _ => Ok(None),
        }
    }

    /// Replaces the histories of the networks.
    pub(crate) fn restore(&mut self, memory: &Memory) {
        for (networks, history) in self.networks().into_iter().zip(&memory.networks) {
            networks.restore(history);
        }
    }

    fn histories(&mut self) -> Vec<History> {
        self.networks().into_iter().map(|networks| networks.history()).collect()
    }

    fn networks(&mut self) -> Vec<&mut Networks> {
        match self {
            Self::Contact(own) => own.networks.iter_mut().collect(),
            Self::Bench(own) => own.networks.iter_mut().collect(),
            Self::Mechanism(own) => own.networks.iter_mut().flatten().collect(),
        }
    }
}
