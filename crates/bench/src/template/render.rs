//! Text of a template.

use super::signals::{Signal, TemplatePlant};
use super::values::{Values, rounded};
use crate::description::{AxisKind, Bench};
use crate::log::{LogError, RawColumn, RawLog};
use crate::reading::FILL_IN;
use crate::schema::{FieldEntry, SectionEntry, Shape};
use crate::signals::Channel;
use std::fmt::Write as _;

/// Maximum width of a comment.
const WIDTH: usize = 100;

/// Returns the text and the dotted names of the values to fill in.
pub(super) fn render(
    log: &RawLog,
    plant: TemplatePlant,
    (signals, chambers): (&[Signal<'_>], Option<[&str; 2]>),
    values: &Values,
) -> Result<(String, Vec<String>), LogError> {
    let sections = Bench::sections(plant.plant()).unwrap_or_default();
    let mut writer = Writer { text: String::new(), to_fill_in: Vec::new(), plant };
    writer.write_head(log);
    let _ = writeln!(writer.text, "plant = {:?}", plant.plant());
    for section in sections.iter().filter(|section| section.is_required) {
        writer.write_section(section, values);
    }
    writer.write_optional(&sections);
    writer.write_sensors(values);
    writer.write_uncertain(plant);
    writer.write_columns(log, signals, chambers);
    Ok((writer.text, writer.to_fill_in))
}

struct Writer {
    text: String,
    to_fill_in: Vec<String>,
    plant: TemplatePlant,
}

impl Writer {
    fn comment(&mut self, text: &str) {
        let mut line = String::from("#");
        for word in text.split_whitespace() {
            if line.len() + 1 + word.len() > WIDTH {
                let _ = writeln!(self.text, "{line}");
                line = String::from("#");
            }
            line.push(' ');
            line.push_str(word);
        }
        let _ = writeln!(self.text, "{line}");
    }

    fn write_head(&mut self, log: &RawLog) {
        self.comment(&format!("Bench description for {}, a template of `host-sim describe`.", log.source));
        self.text.push_str("#\n");
        self.comment(&format!(
            "Fill in every \"{FILL_IN}\". `host-sim check LOG --bench FILE` lists what is missing and then \
             judges the log. docs/description.md lists all fields."
        ));
        self.text.push_str("#\n# Columns of the log:\n");
        let _ =
            writeln!(self.text, "#   {:>5}  {:24}  {:>12}  {:>12}", "index", "name", "smallest", "largest");
        for column in &log.columns {
            let name = if column.name.is_empty() { "(no header)" } else { &column.name };
            let (min, max) = column.range().unwrap_or_default();
            let [min, max] = [min, max].map(rounded);
            let _ = writeln!(self.text, "#   {:>5}  {name:24}  {min:>12}  {max:>12}", column.index);
        }
    }

    fn write_section(&mut self, section: &SectionEntry, values: &Values) {
        let _ = writeln!(self.text, "\n# {}\n[{}]", section.meaning, section.name);
        for field in section.fields.iter().filter(|field| field.is_required()) {
            let name = format!("{}.{}", section.name, field.name);
            self.comment(&described(field, self.plant));
            match values.get(&name) {
                Some(known) if known.note.is_empty() => {
                    let _ = writeln!(self.text, "{} = {}", field.name, known.toml);
                }
                Some(known) => {
                    let _ = writeln!(self.text, "{} = {:24} # {}", field.name, known.toml, known.note);
                }
                None => self.write_open(field.name, name, values),
            }
        }
    }

    fn write_open(&mut self, field: &str, name: String, values: &Values) {
        let hint = values.hint(&name);
        let note = if hint.is_empty() { String::new() } else { format!("{:22} # {hint}", "") };
        let _ = writeln!(self.text, "{field} = {FILL_IN:?}{note}");
        self.to_fill_in.push(name);
    }

    /// Lists the sections that may be added.
    fn write_optional(&mut self, sections: &[SectionEntry]) {
        let is_own = |s: &&SectionEntry| !s.is_required && s.shape == Shape::Table && s.name != "log";
        for section in sections.iter().filter(is_own) {
            self.text.push('\n');
            self.comment(&format!("Optional `[{}]`: {}", section.name, section.meaning));
        }
    }

    fn write_sensors(&mut self, values: &Values) {
        self.text.push('\n');
        self.comment("Noise of the sensors; the numbers are those between neighbouring samples of the log.");
        self.text.push_str("[sensors]\n");
        for (channel, noise) in &values.noise {
            let _ = writeln!(self.text, "{channel} = {{ noise = {noise} }}");
        }
    }

    fn write_uncertain(&mut self, plant: TemplatePlant) {
        self.text.push('\n');
        self.comment(
            "Standard deviations of what is not known exactly: a calibration may move these parameters, and \
             a larger deviation is a finding.",
        );
        self.text.push_str("[uncertain]\n");
        let examples: &[&str] = match plant {
            TemplatePlant::Axis(_) => &["axis.inertia", "axis.coulomb_effort", "axis.load_gain"],
            TemplatePlant::Transmission => {
                &["shaft.inertia_kg_m2", "bearing.radial_clearance_m", "friction.level"]
            }
        };
        for name in examples {
            let _ = writeln!(self.text, "# {name:?} = 0.05");
        }
    }

    fn write_columns(&mut self, log: &RawLog, signals: &[Signal<'_>], chambers: Option<[&str; 2]>) {
        if !log.format.is_default() {
            let _ = writeln!(self.text, "\n[log]\n{}", log.format.lines().join("\n"));
        }
        let is_listed = |s: &&Signal<'_>| match &s.chosen {
            Some(chosen) => !chosen.is_own,
            None => s.is_needed,
        };
        if !signals.iter().any(|signal| is_listed(&signal)) {
            return;
        }
        self.text.push('\n');
        self.comment(
            "Columns of the log: signal = scale * column + offset, in SI units. A text is the name of a \
             column or an expression: drive_force_n = \"(p_a - p_b) * 4.9e-4\".",
        );
        if let Some([a, b]) = chambers {
            self.comment(&format!(
                "Two pressures: {} = \"(`{a}` - `{b}`) * AREA\" with the piston area in SI units.",
                Channel::DriveForce
            ));
        }
        self.text.push_str("[columns]\n");
        for signal in signals.iter().filter(is_listed) {
            let name = signal.name;
            let Some(chosen) = &signal.chosen else {
                let _ = writeln!(self.text, "{name} = {{ from = {FILL_IN:?}, scale = {FILL_IN:?} }}");
                self.to_fill_in.extend([format!("columns.{name}.from"), format!("columns.{name}.scale")]);
                continue;
            };
            let from = source_of(chosen.column);
            match chosen.scale {
                Some(1.0) => {
                    let _ = writeln!(self.text, "{name} = {{ from = {from} }}");
                }
                Some(scale) => {
                    let _ = writeln!(self.text, "{name} = {{ from = {from}, scale = {scale:?} }}");
                }
                None => {
                    let (min, max) = chosen.column.range().unwrap_or_default();
                    let [min, max] = [min, max].map(rounded);
                    let _ = writeln!(
                        self.text,
                        "# column {from} is from {min} to {max}; 1.0 if that is in SI units"
                    );
                    let _ = writeln!(self.text, "{name} = {{ from = {from}, scale = {FILL_IN:?} }}");
                    self.to_fill_in.push(format!("columns.{name}.scale"));
                }
            }
        }
        let missing: Vec<&str> =
            signals.iter().filter(|s| s.chosen.is_none() && !s.is_needed).map(|s| s.name).collect();
        if !missing.is_empty() {
            self.comment(&format!("No column was found for: {}.", missing.join(", ")));
        }
    }
}

/// The `from` of a column.
fn source_of(column: &RawColumn) -> String {
    if column.name.is_empty() { column.index.to_string() } else { format!("{:?}", column.name) }
}

/// Meaning of a field with its range and, of an axis, the unit that suits its kind.
fn described(field: &FieldEntry, plant: TemplatePlant) -> String {
    let (unit, expected) = (field.unit(), field.expected());
    let expected = match (plant, unit.split_once(" or ")) {
        (TemplatePlant::Axis(AxisKind::Linear), Some((linear, _))) => expected.replace(unit, linear),
        (TemplatePlant::Axis(AxisKind::Rotary), Some((_, rotary))) => expected.replace(unit, rotary),
        _ => expected,
    };
    format!("{} Expected: {expected}.", field.meaning())
}
