//! Unit `contact`: the force of the bearing on a journal that another program moves.

use super::PlantMemory;
use crate::networks::Networks;
use crate::variable::{Causality, Type, Variable};
use bench::plants::transmission::{ContactView, JointContact, JointMemory, JointMotion};
use inference::Flags;

/// Contact with its source of force.
pub(crate) struct ContactSimulator {
    pub(crate) contact: JointContact,
    pub(crate) networks: Option<Networks>,
}

/// Inputs.
pub(crate) fn inputs() -> Vec<Variable> {
    let input = |name, unit, meaning| Variable::real(Causality::Input, name, unit, meaning);
    vec![
        input("journal_y_m", "m", "Centre of the journal from that of the bearing along Y"),
        input("journal_z_m", "m", "Centre of the journal from that of the bearing along Z"),
        input("journal_velocity_y_m_s", "m/s", "Velocity of that centre along Y"),
        input("journal_velocity_z_m_s", "m/s", "Velocity of that centre along Z"),
        input(
            "journal_speed_rad_s",
            "rad/s",
            "Angular speed of the journal relative to the bearing, positive from Z to Y",
        ),
        Variable {
            causality: Causality::Tunable,
            range: Some((0.0, 1.0)),
            ..input(
                "extrapolation_s",
                "s",
                "Time by which the motion is extrapolated before the contact is read; half a communication \
                 step is the middle of the step over which the program holds the force",
            )
        },
    ]
}

/// Outputs.
pub(crate) fn outputs() -> Vec<Variable> {
    let output = |name, unit, meaning| Variable::real(Causality::Output, name, unit, meaning);
    let own = vec![
        output("force_y_n", "N", "Force of the bearing on the journal along Y"),
        output("force_z_n", "N", "Force of the bearing on the journal along Z"),
        output("torque_nm", "N m", "Torque of the bearing on the journal, positive as its speed"),
    ];
    let flags = output("network_flags", "", "Flags of the networks' estimate; 0 with the laws");
    [own, view_outputs(), vec![flags.with(Type::Integer, 0.0)]].concat()
}

/// Outputs that describe a contact and its forces.
pub(crate) fn view_outputs() -> Vec<Variable> {
    let output = |name, unit, meaning| Variable::real(Causality::Output, name, unit, meaning);
    vec![
        output("normal_force_n", "N", "Normal force of the contact"),
        output("friction_force_n", "N", "Friction force on the journal along its sliding direction"),
        output("deformation_m", "m", "Deformation of the contact; negative in a gap"),
        output("deformation_rate_m_s", "m/s", "Rate of the deformation"),
        output("approach_speed_m_s", "m/s", "Approach speed at the onset of the contact; 0 in a gap"),
        output("sliding_speed_m_s", "m/s", "Sliding speed of the journal in the contact"),
    ]
}

/// Values of [`view_outputs`].
pub(crate) fn view_values(view: &ContactView, [normal_n, friction_n]: [f64; 2]) -> [f64; 6] {
    [normal_n, friction_n, view.deformation_m, view.rate_m_s, view.latched_m_s, view.sliding_speed_m_s]
}

fn motion(inputs: &[f64]) -> JointMotion {
    let value = |i: usize| inputs.get(i).copied().unwrap_or_default();
    let motion = JointMotion {
        offset_m: [value(0), value(1)],
        velocity_m_s: [value(2), value(3)],
        speed_rad_s: value(4),
    };
    motion.after(value(5))
}

impl ContactSimulator {
    pub(super) fn start(&mut self, inputs: &[f64]) -> Result<(PlantMemory, Vec<f64>), String> {
        let memory = JointMemory::default();
        Ok((PlantMemory::Contact(memory), self.read(&memory, inputs)?))
    }

    /// Outputs for a motion of the journal. The networks see it as their next reading.
    pub(super) fn read(&self, memory: &JointMemory, inputs: &[f64]) -> Result<Vec<f64>, String> {
        let motion = motion(inputs);
        let view = self.contact.view(&motion, memory);
        let (forces, flags) = match &self.networks {
            Some(networks) => networks.clone().push(&view),
            None => {
                self.contact.check_deformation(&view).map_err(|error| error.to_string())?;
                (self.contact.law(&view, memory), Flags::NONE)
            }
        };
        let ([y_n, z_n], torque_nm) = self.contact.on_journal(&motion, &forces);
        let mut outputs = vec![y_n, z_n, torque_nm];
        outputs.extend(view_values(&view, [forces.normal_n, forces.friction_n]));
        outputs.push(f64::from(flags.bits()));
        Ok(outputs)
    }

    pub(super) fn step(
        &mut self,
        memory: &mut JointMemory,
        (start_s, end_s): (f64, f64),
        inputs: &[f64],
    ) -> Result<Vec<f64>, String> {
        let view = self.contact.view(&motion(inputs), memory);
        let outputs = self.read(memory, inputs)?;
        self.networks.iter_mut().for_each(|networks| {
            networks.push(&view);
        });
        self.contact.advance(memory, &view, end_s - start_s);
        Ok(outputs)
    }
}
