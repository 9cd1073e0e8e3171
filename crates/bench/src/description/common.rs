//! Sections that every plant's description has: sensors, uncertainty, log format and effects.

use super::{Effect, Nuisances};
use crate::log::{Column, Columns, TextFormat};
use crate::schema::{SectionEntry, Shape};
use crate::signals::{Channel, Sensor};
use std::collections::BTreeMap;

/// Sections that every plant's description has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Common {
    /// Sensors by channel.
    pub sensors: BTreeMap<Channel, Sensor>,
    /// Standard deviations of the parameters that calibration may move, by parameter name.
    pub uncertain: BTreeMap<String, f64>,
    /// Per-log nuisance parameters.
    pub nuisances: Nuisances,
    /// Text format of a foreign log; detected without one.
    pub log: Option<TextFormat>,
    /// Columns of a foreign log by channel.
    pub columns: Columns,
    /// Deviations from the nominal model.
    pub effects: Vec<Effect>,
}

/// Entries of the sections that every plant's description may have.
pub(super) fn sections() -> Vec<SectionEntry> {
    let sensors = "Sensors by channel; a channel that is not listed is read exactly.";
    let uncertain = "Standard deviations of the parameters that calibration may move, by dotted name, such \
                     as `\"shaft.mass_kg\" = 3.0`. A larger deviation is a finding.";
    let nuisances = "Standard deviations of parameters of which each log has its own value.";
    let columns = "Columns of a foreign log by signal, `t_s` or a channel: `scale * field + offset`. A text \
                   in place of the table is `from`. A `from` that is no column is an expression: \
                   `drive_force_n = \"(p_a - p_b) * 4.9e-4\"`, `t_s = \"t_ms / 1000\"`. It has `+ - * / ^`, \
                   parentheses, `abs`, `sqrt`, `sin`, `cos`, `tan`, `atan2(y, x)`, `pi`, `deg` (a degree in \
                   rad) and columns: `p_a`, in backticks if the name has other characters than letters, \
                   digits, `_` and points, or `column(3)` by index from 0. A column hides a constant of its \
                   name. A value that is not finite, although the columns are, is refused.";
    let log = "Text format of a foreign log. Without this section it is detected from the first 1000 lines: \
               the separator and the decimal sign that give the largest share of numbers, at least 80 %. Of \
               equally good ones the first counts, in the order comma, semicolon, tab, whitespace, and a \
               decimal point before a decimal comma: `1,2,3` is separated by commas. A first line with text \
               in a column of numbers is a header. If nothing fits, commas and a header are assumed. With or \
               without this section, lines that begin with `#` or `% ` are comments, a line under the header \
               with text and no number contains units, a text that is not UTF-8 is read as UTF-16 if it has \
               a byte order mark, else as Latin-1, and separators of thousands are refused.";
    let effects =
        "Deviations from the nominal model: `name`, parameters and, for a sensor effect, `channel`.";
    let common = [
        SectionEntry::new::<Sensor>("sensors", sensors.into(), Shape::PerChannel),
        SectionEntry::new::<String>("uncertain", uncertain.into(), Shape::PerParameter),
        SectionEntry::new::<Nuisances>("nuisances", nuisances.into(), Shape::Table),
        SectionEntry::new::<TextFormat>("log", log.into(), Shape::Table),
        SectionEntry::new::<Column>("columns", columns.into(), Shape::PerSignal),
        SectionEntry::new::<String>("effects", effects.into(), Shape::Effects),
    ];
    common.into_iter().map(SectionEntry::optional).collect()
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
