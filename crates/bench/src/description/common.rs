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
    let effects = "Deviations from the nominal model: `name`, parameters and, for a sensor effect, \
                   `channel`, or for an effect on a part of a mechanism, `of` with the name of the body or \
                   joint.";
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
