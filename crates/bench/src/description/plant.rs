//! Interface of a plant's description: facts that its readers need, whatever the plant.

use super::{Common, Load, Logging, Plant};
use crate::log::MeasuredLog;
use crate::signals::{Channel, Role};

/// Dotted name of a number of a description, and the number.
pub type Field<'a> = (&'static str, &'a mut f64);

/// Dotted name of a number, its value, minimum and maximum.
pub type Range = (&'static str, f64, f64, f64);

/// Field, value found and value expected of an entry that is not allowed.
pub type Refusal = (String, String, String);

/// Maximum number of samples of a log.
const MAX_SAMPLES: f64 = 1e7;

/// Range of the sample rate for a run of `run_s`, bounded by the number of samples.
pub(super) fn log_rate(logging: &Logging, run_s: f64) -> Range {
    ("logging.sample_rate_hz", logging.sample_rate_hz, 1e-6, (MAX_SAMPLES / run_s).min(1e9))
}

/// Channels of a driven motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveChannels {
    /// Position, angle or displacement.
    pub position: Channel,
    /// Its rate.
    pub speed: Channel,
}

/// Sections that every plant's description has; implemented by `plant_description!`.
pub trait CommonSections {
    /// Name of the plant, as `plant` in a description.
    fn plant_name(&self) -> &'static str;
    /// Sections that every plant has.
    fn common(&self) -> &Common;
    /// Sections that every plant has, for changes.
    fn common_mut(&mut self) -> &mut Common;
}

/// Description of one plant. A [`Bench`](super::Bench) dereferences to it.
pub trait PlantDescription: CommonSections {
    /// Period of the driven motion in s.
    fn period_s(&self) -> f64;
    /// Peak-to-peak range of the driven motion, in m or rad.
    fn stroke(&self) -> f64;
    /// Length of a run or a record in s.
    fn duration_s(&self) -> f64;
    /// Dotted name of the number of cycles in a description.
    fn cycles_field(&self) -> &'static str;
    /// Sets the number of cycles of a run or a record; revolutions of a crank.
    fn set_cycles(&mut self, cycles: u32);
    /// Ranges that depend on other fields, within those of the sections. They protect the model
    /// from impossible geometry, endless runs and logs that exceed the memory.
    fn dependent_ranges(&self) -> Vec<Range>;
    /// Omissions of the plant's model for a report, one sentence each.
    fn limits(&self) -> &'static [&'static str];

    /// Returns the entries that are not allowed although every number is in its range. Laws are
    /// checked apart, because that requires building them.
    fn refusals(&self) -> Vec<Refusal> {
        Vec::new()
    }
    /// A parameter that may be declared uncertain, by its dotted name, for changes.
    fn plant_parameter_mut(&mut self, _name: &str) -> Option<&mut f64> {
        None
    }
    /// The number that sets the period; none if an experiment cannot change it.
    fn period_mut(&mut self) -> Option<Field<'_>> {
        None
    }
    /// The number that sets the stroke; none if an experiment cannot change it.
    fn stroke_mut(&mut self) -> Option<Field<'_>> {
        None
    }
    /// Described load, if the plant has one.
    fn load(&self) -> Option<&Load> {
        None
    }
    /// Described load for changes, if the plant has one.
    fn load_mut(&mut self) -> Option<&mut Load> {
        None
    }
    /// Returns whether friction depends on temperature.
    fn has_thermal_friction(&self) -> bool {
        false
    }
    /// Sets the rise of the bearing's temperature over its surroundings at the first sample, K.
    fn set_temperature_start_k(&mut self, _rise_k: f64) {}
    /// Plant of the effect catalogue; none if no effect acts on it.
    fn effect_plant(&self) -> Option<Plant> {
        None
    }

    /// Described samples per second of a log; 0 where the plant has no log.
    fn sample_rate_hz(&self) -> f64 {
        0.0
    }
    /// Channels of the driven motion; none where the plant has no log.
    fn drive_channels(&self) -> Option<DriveChannels> {
        None
    }
    /// Role of a channel on this bench.
    fn role(&self, channel: Channel) -> Role {
        channel.role()
    }
    /// Output channels of a log on this bench.
    fn outputs(&self, log: &MeasuredLog) -> Vec<Channel> {
        log.channels.keys().copied().filter(|c| self.role(*c) == Role::Output).collect()
    }
    /// Returns whether the motion is simulated without feedback, so that errors add up over time.
    fn is_open_loop(&self) -> bool {
        false
    }
    /// Returns whether the plant simulates an output channel under a log's inputs.
    fn simulates(&self, _channel: Channel) -> bool {
        false
    }
    /// Part of a log from `start_s` to `end_s` that its start does not affect: without the ramp of
    /// the load and the margins at both ends. By default the whole log: an axis, for example, has
    /// no state that its start affects.
    fn steady_span_s(&self, (start_s, end_s): (f64, f64), _margins_s: (f64, f64)) -> (f64, f64) {
        (start_s, end_s)
    }
}
