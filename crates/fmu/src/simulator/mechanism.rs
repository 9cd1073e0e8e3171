//! Unit `mechanism`: a described mechanism under forces on its bodies.

use super::PlantMemory;
use crate::networks::Networks;
use crate::variable::{Causality, Type, Variable};
use bench::description::MechanismBench;
use bench::plants::mechanism::Snapshot;
use bench::plants::transmission::{BearingForces, ContactView};
use bench::schema::unit_of_name;
use bench::simulate::stepped::{MechanismMemory, SteppedMechanism};
use inference::Flags;

/// Mechanism with the networks of its contacts.
pub(crate) struct MechanismSimulator {
    pub(crate) mechanism: SteppedMechanism,
    pub(crate) networks: Vec<Option<Networks>>,
    /// Communication step of the networks in s.
    pub(crate) network_step_s: f64,
    /// Flags of all estimates of the last step.
    pub(crate) flags: Flags,
}

/// Inputs: a force and a torque for each body.
pub(crate) fn inputs(bench: &MechanismBench) -> Vec<Variable> {
    let of_body = |name: &str| {
        [("force_x_n", "Force along x"), ("force_y_n", "Force along y"), ("torque_nm", "Torque")].map(
            |(quantity, meaning)| {
                let meaning = format!("{meaning} on the centre of mass of {name}, besides described loads");
                let name = format!("{name}_input_{quantity}");
                Variable::real(Causality::Input, &name, unit_of_name(quantity), &meaning)
            },
        )
    };
    bench.body.iter().flat_map(|body| of_body(&body.name)).collect()
}

/// Outputs: the columns of a log, the rates of the bodies, the periods in contact.
pub(crate) fn outputs(bench: &MechanismBench) -> Vec<Variable> {
    let output =
        |name: String, meaning: &str| Variable::real(Causality::Output, &name, unit_of_name(&name), meaning);
    let columns = bench.columns().into_iter().map(|name| output(name, "Column of the log of a run"));
    let rates = bench.body.iter().flat_map(|body| {
        ["velocity_x_m_s", "velocity_y_m_s", "speed_rad_s"]
            .map(|quantity| output(format!("{}_{quantity}", body.name), "Rate of the body"))
    });
    let contacts = bench.contact_names().into_iter().flat_map(|name| {
        let count = output(format!("{name}_contacts"), "Periods in contact that have begun");
        let peak = output(format!("{name}_peak_n"), "Largest normal force of the present or last period");
        [count.with(Type::Integer, 0.0), peak]
    });
    let flags = output("network_flags".into(), "Flags of all networks over the last step; 0 with the laws");
    columns.chain(rates).chain(contacts).chain([flags.with(Type::Integer, 0.0)]).collect()
}

impl MechanismSimulator {
    pub(super) fn start(&mut self, time_s: f64) -> Result<(PlantMemory, Vec<f64>), String> {
        if time_s != 0.0 {
            return Err(format!("start time: found {time_s} s; expected 0, where the description begins"));
        }
        let (memory, snapshot) = self.mechanism.start();
        let outputs = self.values(&snapshot, &memory);
        Ok((PlantMemory::Mechanism(memory), outputs))
    }

    pub(super) fn step(
        &mut self,
        memory: &mut MechanismMemory,
        span_s: (f64, f64),
        inputs: &[f64],
    ) -> Result<Vec<f64>, String> {
        let (loads, _) = inputs.as_chunks::<3>();
        self.flags = Flags::NONE;
        let (networks, flags) = (&mut self.networks, &mut self.flags);
        let mut force = |contact: usize, view: &ContactView| {
            let Some(Some(networks)) = networks.get_mut(contact) else { return BearingForces::default() };
            let (forces, found) = networks.push(view);
            *flags |= found;
            forces
        };
        let held = (self.network_step_s, &mut force as &mut dyn FnMut(usize, &ContactView) -> BearingForces);
        let snapshot = self.mechanism.step(memory, span_s, loads, held).map_err(|error| error.to_string())?;
        Ok(self.values(&snapshot, memory))
    }

    fn values(&self, snapshot: &Snapshot, memory: &MechanismMemory) -> Vec<f64> {
        let rates = snapshot.bodies.iter().flat_map(|body| body.rate);
        let contacts = memory.contacts.iter().zip(&memory.peak_force_n);
        let contacts = contacts.flat_map(|(count, peak_n)| [f64::from(*count), *peak_n]);
        snapshot.row().chain(rates).chain(contacts).chain([f64::from(self.flags.bits())]).collect()
    }
}
