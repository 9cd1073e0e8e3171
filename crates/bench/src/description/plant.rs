//! Interface of a plant's description: facts that its readers need, whatever the plant.

use super::{Common, Load, Logging, Plant, Refusal};
use crate::log::MeasuredLog;
use crate::signals::{Channel, Role};

/// Dotted name of a number of a description, and the number.
pub type Field<'a> = (&'static str, &'a mut f64);

/// Dotted name of a number, its value, minimum and maximum.
pub type Range = (&'static str, f64, f64, f64);

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

/// Defines a plant's description: its name, its own sections, the [`Common`] ones and its
/// extension.
///
/// `#[serde(flatten)]` would accept unknown fields and lose line and column. So the file is read
/// into a private struct that lists all sections side by side, and converted.
macro_rules! plant_description {
    (
        $(#[$meta:meta])*
        $name:ident as $file:ident $file_name:literal, plant $plant:literal, extension $extension:ty {
            $($(#[$field_meta:meta])* $field:ident : $type:ty,)*
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(from = $file_name, into = $file_name)]
        pub struct $name {
            $($(#[$field_meta])* pub $field: $type,)*
            /// Sections that every plant has.
            pub common: $crate::description::Common,
            /// Terms that effects switch on; never in a file.
            pub extension: $extension,
        }

        impl $name {
            /// Name of the plant, as `plant` in a description.
            pub const PLANT: &str = $plant;
        }

        impl $name {
            /// Sections of the description: the plant's own, then those of every plant.
            pub fn sections() -> Vec<$crate::schema::SectionEntry> {
                let own = vec![$($crate::schema::SectionEntry::new::<$type>(
                    stringify!($field),
                    $crate::schema::meaning(&[$(stringify!($field_meta)),*]),
                    <$type as $crate::schema::Content>::SHAPE,
                )),*];
                let sections = own.into_iter().filter(|section| section.name != "plant");
                sections.chain($crate::description::common::sections()).collect()
            }
        }

        impl $crate::description::CommonSections for $name {
            fn plant_name(&self) -> &'static str {
                Self::PLANT
            }

            fn common(&self) -> &$crate::description::Common {
                &self.common
            }

            fn common_mut(&mut self) -> &mut $crate::description::Common {
                &mut self.common
            }
        }

        #[derive(serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        struct $file {
            $($(#[$field_meta])* $field: $type,)*
            #[serde(default)]
            sensors: std::collections::BTreeMap<$crate::signals::Channel, $crate::signals::Sensor>,
            #[serde(default)]
            uncertain: std::collections::BTreeMap<String, f64>,
            #[serde(default, skip_serializing_if = "crate::description::Nuisances::is_empty")]
            nuisances: $crate::description::Nuisances,
            #[serde(default, skip_serializing_if = "Option::is_none")]
            log: Option<$crate::log::TextFormat>,
            #[serde(default, skip_serializing_if = "crate::log::Columns::is_empty")]
            #[serde(deserialize_with = "crate::log::columns")]
            columns: $crate::log::Columns,
            #[serde(default, skip_serializing_if = "Vec::is_empty")]
            effects: Vec<$crate::description::Effect>,
        }

        impl From<$file> for $name {
            fn from(file: $file) -> Self {
                let $file { $($field,)* sensors, uncertain, nuisances, log, columns, effects } = file;
                let common =
                    $crate::description::Common { sensors, uncertain, nuisances, log, columns, effects };
                Self { $($field,)* common, extension: <$extension>::default() }
            }
        }

        impl From<$name> for $file {
            fn from(bench: $name) -> Self {
                let $name { $($field,)* common, extension: _ } = bench;
                let $crate::description::Common { sensors, uncertain, nuisances, log, columns, effects } =
                    common;
                Self { $($field,)* sensors, uncertain, nuisances, log, columns, effects }
            }
        }
    };
}
pub(super) use plant_description;
