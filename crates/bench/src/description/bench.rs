//! A bench of any plant. The list of plants is in [`super`].

use super::{Bench, Effect, FrictionRig, Nuisances, TransmissionBench};
use crate::log::LogFormat;
use crate::signals::{Channel, Sensor};
use std::collections::BTreeMap;

/// Defines [`Bench`] from the list of plants: reading, writing and access to the plant.
macro_rules! plants {
    ($($(#[$meta:meta])* $variant:ident($plant:ident),)*) => {
        /// A described bench of any plant. Properties that every plant has are methods of
        /// [`PlantDescription`], to which a bench dereferences.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Bench {
            $($(#[$meta])* $variant(Box<$plant>),)*
        }

        impl std::ops::Deref for Bench {
            type Target = dyn PlantDescription;

            fn deref(&self) -> &Self::Target {
                match self {
                    $(Self::$variant(plant) => &**plant,)*
                }
            }
        }

        impl std::ops::DerefMut for Bench {
            fn deref_mut(&mut self) -> &mut Self::Target {
                match self {
                    $(Self::$variant(plant) => &mut **plant,)*
                }
            }
        }

        impl Bench {
            /// Names of the plants, as `plant` in a description.
            pub const PLANTS: &[&str] = &[$($plant::PLANT),*];

            /// Reads the description of a plant; none if there is no plant of this name.
            pub(crate) fn from_toml(plant: &str, text: &str) -> Option<Result<Self, toml::de::Error>> {
                match plant {
                    $($plant::PLANT => Some(toml::from_str(text).map(Self::$variant)),)*
                    _ => None,
                }
            }

            /// Sections of a plant's description; none if there is no plant of this name.
            pub fn sections(plant: &str) -> Option<Vec<$crate::schema::SectionEntry>> {
                match plant {
                    $($plant::PLANT => Some($plant::sections()),)*
                    _ => None,
                }
            }

            /// Returns the description as TOML.
            pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
                match self {
                    $(Self::$variant(plant) => toml::to_string(plant),)*
                }
            }
        }

        $(
            impl From<$plant> for Bench {
                fn from(plant: $plant) -> Self {
                    Self::$variant(Box::new(plant))
                }
            }

            impl $plant {
                /// Returns the plant of a bench and refuses every other plant; `file` names the
                /// bench in messages.
                pub fn from_bench(bench: Bench, file: &str) -> Result<Self, DescriptionError> {
                    match bench {
                        Bench::$variant(plant) => Ok(*plant),
                        other => Err(DescriptionError::OtherPlant {
                            file: file.into(),
                            found: other.plant_name(),
                            expected: Self::PLANT,
                        }),
                    }
                }
            }
        )*
    };
}

impl Bench {
    /// Effects of the description.
    pub fn effects(&self) -> &[Effect] {
        &self.common().effects
    }

    /// Effects of the description, for changes.
    pub fn effects_mut(&mut self) -> &mut Vec<Effect> {
        &mut self.common_mut().effects
    }

    /// Sensors by channel.
    pub fn sensors(&self) -> &BTreeMap<Channel, Sensor> {
        &self.common().sensors
    }

    /// Sensors by channel, for changes.
    pub fn sensors_mut(&mut self) -> &mut BTreeMap<Channel, Sensor> {
        &mut self.common_mut().sensors
    }

    /// Standard deviations of the parameters that calibration may move, by parameter name.
    pub fn uncertain(&self) -> &BTreeMap<String, f64> {
        &self.common().uncertain
    }

    /// Per-log nuisance parameters that the description declares.
    pub fn nuisances(&self) -> &Nuisances {
        &self.common().nuisances
    }

    /// Format of a foreign log.
    pub fn log_format(&self) -> LogFormat {
        let common = self.common();
        LogFormat { text: common.log, columns: common.columns.clone() }
    }

    /// Described load in N; 0 where the plant has none.
    pub fn load_n(&self) -> f64 {
        self.load().map_or(0.0, |load| load.force_n)
    }

    /// Returns whether the plant is a single driven axis: friction rig or linear axis.
    pub const fn is_axis(&self) -> bool {
        matches!(self, Self::FrictionRig(_))
    }

    /// The transmission bench, if this is one.
    pub const fn transmission(&self) -> Option<&TransmissionBench> {
        match self {
            Self::Transmission(bench) => Some(bench),
            _ => None,
        }
    }

    /// The transmission bench for changes, if this is one.
    pub const fn transmission_mut(&mut self) -> Option<&mut TransmissionBench> {
        match self {
            Self::Transmission(bench) => Some(bench),
            _ => None,
        }
    }

    /// The driven axis, if this is one.
    pub const fn axis(&self) -> Option<&FrictionRig> {
        match self {
            Self::FrictionRig(rig) => Some(rig),
            _ => None,
        }
    }

    /// The driven axis for changes, if this is one.
    pub const fn axis_mut(&mut self) -> Option<&mut FrictionRig> {
        match self {
            Self::FrictionRig(rig) => Some(rig),
            _ => None,
        }
    }

    /// A parameter by its dotted name (`shaft.mass_kg`, `sensors.journal_y_m.offset`), for changes.
    pub fn parameter_mut(&mut self, name: &str) -> Option<&mut f64> {
        let Some(rest) = name.strip_prefix("sensors.") else { return self.plant_parameter_mut(name) };
        let (channel, field) = rest.split_once('.')?;
        let channel = Channel::from_name(channel)?;
        let sensor = self.sensors_mut().entry(channel).or_default();
        match field {
            "offset" => Some(&mut sensor.offset),
            "gain" => Some(&mut sensor.gain),
            "delay_s" => Some(&mut sensor.delay_s),
            _ => None,
        }
    }
}
