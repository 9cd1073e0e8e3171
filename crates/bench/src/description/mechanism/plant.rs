//! A mechanism as one of the plants: its facts and limits.

use super::MechanismBench;
use crate::description::{DriveChannels, Plant, PlantDescription, Range, Refusal};
use crate::signals::{Channel, Role};

/// Omissions of the model.
const LIMITS: &[&str] = &[
    "Bodies are rigid and move in one plane; gravity, loads and joints act in it.",
    "Ideal joints have no friction, no clearance and no elasticity.",
    "Drives follow their prescribed motion whatever force it takes.",
    "Contact is one point with a force law, without a pressure distribution and without wear.",
    "A journal tilts in no bearing, and a guide touches at the four corners of its slider only.",
    "Trajectories with many impacts decorrelate: beyond some cycles only statistics can be compared.",
];

impl PlantDescription for MechanismBench {
    fn period_s(&self) -> f64 {
        self.joint.iter().find_map(|joint| joint.drive_period_s).unwrap_or(self.run.duration_s)
    }

    fn stroke(&self) -> f64 {
        self.joint.iter().find_map(|joint| joint.drive_stroke).unwrap_or_default()
    }

    fn duration_s(&self) -> f64 {
        self.run.duration_s
    }

    fn cycles_field(&self) -> &'static str {
        "run.duration_s"
    }

    fn set_cycles(&mut self, cycles: u32) {
        self.run.duration_s = f64::from(cycles) * self.period_s();
    }

    fn dependent_ranges(&self) -> Vec<Range> {
        Vec::new()
    }

    fn limits(&self) -> &'static [&'static str] {
        LIMITS
    }

    fn refusals(&self) -> Vec<Refusal> {
        self.structure_refusals()
    }

    fn plant_parameter_mut(&mut self, name: &str) -> Option<&mut f64> {
        self.part_number_mut(name)
    }

    fn effect_plant(&self) -> Option<Plant> {
        (!self.measured.is_empty()).then_some(Plant::Mechanism)
    }

    fn sample_rate_hz(&self) -> f64 {
        if self.measured.is_empty() { 0.0 } else { f64::from(self.run.samples) / self.run.duration_s }
    }

    fn drive_channels(&self) -> Option<DriveChannels> {
        // The first drive names the kind; the drives follow the description.
        let is_sliding = self.drive_names().first().is_some_and(|drive| drive.1 == "n");
        let turning = DriveChannels { position: Channel::SpindleAngle, speed: Channel::SpindleSpeed };
        let sliding = DriveChannels { position: Channel::Position, speed: Channel::Velocity };
        (!self.measured.is_empty()).then_some(if is_sliding { sliding } else { turning })
    }

    fn simulates(&self, channel: Channel) -> bool {
        channel.role() == Role::Output && self.measured.iter().any(|entry| entry.channel == channel)
    }
}
