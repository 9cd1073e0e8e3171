//! Unit `bench`: the whole transmission bench with its stiff contact inside.

use super::PlantMemory;
use super::contact::{view_outputs, view_values};
use crate::model::{EXTERNAL_DRIVE, EXTERNAL_LOAD};
use crate::networks::Networks;
use crate::variable::{Causality, Type, Variable};
use bench::plants::transmission::Snapshot;
use bench::signals::Motion;
use bench::simulate::CHANNELS;
use bench::simulate::stepped::{BenchMemory, External, SteppedBench};
use inference::Flags;

/// Bench with its source of force and what replaces the description.
pub(crate) struct BenchSimulator {
    pub(crate) bench: SteppedBench,
    pub(crate) networks: Option<Networks>,
    /// Communication step of the networks in s.
    pub(crate) network_step_s: f64,
    /// True if the inputs give the motion of the drive.
    pub(crate) has_external_drive: bool,
    /// True if an input gives the load.
    pub(crate) has_external_load: bool,
    /// Largest position in m that the inputs may give the drive; none with a servo, whose order
    /// they give.
    pub(crate) largest_drive_m: Option<f64>,
    /// Flags of all estimates of the last step.
    pub(crate) flags: Flags,
}

/// Parameters besides the numbers of the description.
pub(crate) fn parameters() -> Vec<Variable> {
    let choice = |name, meaning| Variable::real(Causality::Fixed, name, "", meaning).with(Type::Boolean, 0.0);
    vec![
        choice(EXTERNAL_DRIVE, "True: the inputs drive_* replace the described motion of the drive"),
        choice(EXTERNAL_LOAD, "True: the input load_n replaces the described load"),
    ]
}

/// Inputs.
pub(crate) fn inputs() -> Vec<Variable> {
    let input = |name, unit, meaning| Variable::real(Causality::Input, name, unit, meaning);
    vec![
        input(
            "drive_m",
            "m",
            "Position of the drive cylinder at the start of a step; with a servo its order",
        ),
        input("drive_speed_m_s", "m/s", "Its velocity there"),
        input("drive_acceleration_m_s2", "m/s2", "Its acceleration over the step"),
        input("load_n", "N", "Force of the load cylinder over the step"),
    ]
}

/// Outputs.
pub(crate) fn outputs() -> Vec<Variable> {
    let output = |name, unit, meaning| Variable::real(Causality::Output, name, unit, meaning);
    let channel = |(channel, _): &bench::simulate::ChannelReading| {
        output(channel.name(), channel.unit(), channel.meaning())
    };
    let rates = vec![
        output("journal_velocity_y_m_s", "m/s", "Velocity of the journal's centre along Y"),
        output("journal_velocity_z_m_s", "m/s", "Velocity of the journal's centre along Z"),
    ];
    let contacts = vec![
        output("contacts", "", "Contacts that have begun").with(Type::Integer, 0.0),
        output("peak_force_n", "N", "Largest normal force of the present contact, or of the last one"),
        output("network_flags", "", "Flags of the networks over the last step; 0 with the laws")
            .with(Type::Integer, 0.0),
    ];
    [CHANNELS.iter().map(channel).collect(), rates, view_outputs(), contacts].concat()
}

impl BenchSimulator {
    fn external(&self, inputs: &[f64]) -> External {
        let value = |i: usize| inputs.get(i).copied().unwrap_or_default();
        let drive = Motion { value: value(0), rate: value(1), acceleration: value(2) };
        External {
            drive: self.has_external_drive.then_some(drive),
            load_n: self.has_external_load.then(|| value(3)),
        }
    }

    /// Refuses a motion of the drive that the lever cannot follow.
    fn check(&self, external: &External, step_s: f64) -> Result<(), String> {
        let (Some(drive), Some(largest_m)) = (external.drive, self.largest_drive_m) else { return Ok(()) };
        match [drive.value, drive.after(step_s).value].into_iter().find(|x| x.abs() >= largest_m) {
            Some(x_m) => Err(format!(
                "drive_m: found {x_m} m within the step; expected less than the lever of {largest_m} m"
            )),
            None => Ok(()),
        }
    }

    pub(super) fn start(&mut self, time_s: f64, inputs: &[f64]) -> (PlantMemory, Vec<f64>) {
        let external = self.external(inputs);
        let memory = self.bench.start(time_s, &external, self.networks.is_some());
        let snapshot = self.bench.snapshot(time_s, &memory, (time_s, &external));
        let outputs = self.values(&snapshot, &memory);
        (PlantMemory::Bench(memory), outputs)
    }

    pub(super) fn step(
        &mut self,
        memory: &mut BenchMemory,
        span_s: (f64, f64),
        inputs: &[f64],
    ) -> Result<Vec<f64>, String> {
        let external = self.external(inputs);
        self.check(&external, span_s.1 - span_s.0)?;
        self.flags = Flags::NONE;
        match &mut self.networks {
            None => self.bench.step(memory, span_s, &external),
            Some(networks) => {
                let flags = &mut self.flags;
                let mut force = |view: &_| {
                    let (forces, found) = networks.push(view);
                    *flags |= found;
                    forces
                };
                self.bench.step_held(memory, span_s, &external, (self.network_step_s, &mut force))
            }
        }
        .map_err(|error| error.to_string())?;
        let snapshot = self.bench.snapshot(span_s.1, memory, (span_s.0, &external));
        Ok(self.values(&snapshot, memory))
    }

    fn values(&self, snapshot: &Snapshot, memory: &BenchMemory) -> Vec<f64> {
        let channels = CHANNELS.iter().map(|(_, read)| read(snapshot));
        let forces = [snapshot.forces.normal_n, snapshot.forces.friction_n];
        let view = view_values(&snapshot.contact, forces);
        let last = [f64::from(memory.contacts), memory.peak_force_n, f64::from(self.flags.bits())];
        channels.chain(SteppedBench::journal_velocity_m_s(memory)).chain(view).chain(last).collect()
    }
}
