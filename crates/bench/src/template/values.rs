//! Values that a log determines, by dotted name, with a note for the template.

use super::columns::{Chosen, interval, period_s};
use super::signals::{Signal, TemplatePlant};
use crate::description::AxisKind;
use crate::log::TIME;
use crate::reading::PRESETS;
use crate::signals::{Channel, Role, white_noise};
use crate::statistics::mean;
use std::collections::BTreeMap;

/// Width of the regularised sign as a share of the largest speed.
const REGULARISATION_SHARE: f64 = 0.01;

/// Noise, as a share of the largest reading, below which a signal has none: rounding errors only.
const MIN_NOISE_SHARE: f64 = 1e-9;

/// A value as TOML, and a note about its origin.
pub(super) struct Known {
    pub(super) toml: String,
    pub(super) note: String,
}

/// Values by dotted name, and measured noise by channel.
#[derive(Default)]
pub(super) struct Values {
    known: BTreeMap<String, Known>,
    hints: BTreeMap<String, String>,
    pub(super) noise: Vec<(&'static str, String)>,
}

impl Values {
    /// Note about a value to fill in; empty if there is none.
    pub(super) fn hint(&self, name: &str) -> &str {
        self.hints.get(name).map_or("", String::as_str)
    }

    fn set_hint(&mut self, name: &str, value: Option<f64>, column: &str) {
        if let (Some(value), false) = (value, self.known.contains_key(name)) {
            let hint = format!("{} times the scale of {column}", rounded(value));
            self.hints.insert(name.into(), hint);
        }
    }

    pub(super) fn get(&self, name: &str) -> Option<&Known> {
        self.known.get(name)
    }

    fn set(&mut self, name: &str, toml: String, note: &str) {
        self.known.insert(name.into(), Known { toml, note: note.into() });
    }

    fn set_number(&mut self, name: &str, value: Option<f64>, note: &str) {
        if let Some(value) = value.filter(|value| value.is_finite()) {
            self.set(name, rounded(value), note);
        }
    }
}

/// A number with four significant digits as TOML.
pub(super) fn rounded(value: f64) -> String {
    let rounded = format!("{value:.3e}").parse::<f64>().unwrap_or(value);
    format!("{rounded:?}")
}

/// Values that the signals of a log determine.
pub(super) fn values(signals: &[Signal<'_>], plant: TemplatePlant) -> Values {
    let mut values = Values::default();
    let chosen = |name: &str| signals.iter().find(|s| s.name == name)?.chosen.as_ref();
    let time_s = chosen(TIME).and_then(|time| time.values());
    if let Some(step_s) = time_s.as_deref().map(interval).filter(|step_s| *step_s > 0.0) {
        values.set_number("logging.sample_rate_hz", Some(1.0 / step_s), "from the log");
    }
    let position = match plant {
        TemplatePlant::Axis(AxisKind::Rotary) => Channel::SpindleAngle,
        TemplatePlant::Axis(AxisKind::Linear) => Channel::Position,
        TemplatePlant::Transmission => Channel::DriveDisplacement,
    };
    let motion = chosen(position.name()).and_then(|position| position.values());
    let period_s = time_s.as_deref().zip(motion.as_deref()).and_then(|(t, x)| period_s(t, x));
    let stroke = chosen(position.name()).and_then(|p| p.range()).map(|(min, max)| max - min);
    match plant {
        TemplatePlant::Axis(kind) => {
            set_axis(&mut values, kind, period_s, stroke);
            let middle = chosen(position.name()).and_then(|p| p.range()).map(|(min, max)| 0.5 * (min + max));
            values.set_number("axis.neutral_position", middle, "middle of the logged motion");
        }
        TemplatePlant::Transmission => {
            values.set_number("drive.period_s", period_s, "from the log");
            values.set_number("drive.stroke_m", stroke, "from the log");
            values.set("drive.cycles", "1".into(), "for records");
            set_laws(&mut values);
        }
    }
    set_hints(&mut values, (chosen(TIME), chosen(position.name())), (plant, position.name()));
    let load = chosen(Channel::LoadForce.name());
    match load {
        Some(load) => {
            let mean = load.values().map(|v| mean(v));
            values.set_number("load.force_n", mean, "mean of the log, which is used where it is recorded");
        }
        None if plant != TemplatePlant::Transmission => {
            values.set("load.force_n", "0.0".into(), "no column for it was found");
            values.set("axis.load_gain", "0.0".into(), "no load");
        }
        None => {}
    }
    values.set("load.ramp_s", "0.05".into(), "for records");
    for signal in signals {
        let is_output = Channel::from_name(signal.name).is_some_and(|c| c.role() == Role::Output);
        let readings = signal.chosen.as_ref().and_then(|chosen| chosen.values());
        if let (true, Some(time_s), Some(readings)) = (is_output, time_s.as_deref(), readings) {
            let noise = white_noise::deviation(&mut white_noise::squares(time_s, &readings));
            let largest = readings.iter().fold(0.0_f64, |max, v| max.max(v.abs()));
            if noise > MIN_NOISE_SHARE * largest {
                values.noise.push((signal.name, rounded(noise)));
            }
        }
    }
    values
}

/// Notes the period, the stroke and the interval in the units of columns whose scale is not known.
fn set_hints(
    values: &mut Values,
    (time, position): (Option<&Chosen<'_>>, Option<&Chosen<'_>>),
    (plant, name): (TemplatePlant, &str),
) {
    let Some(times) = time.and_then(|time| time.or_unscaled().values()) else { return };
    let rate = Some(interval(&times)).filter(|step| *step > 0.0).map(|step| 1.0 / step);
    if let (Some(rate), false) = (rate, values.known.contains_key("logging.sample_rate_hz")) {
        let hint = format!("{} over the scale of {TIME}", rounded(rate));
        values.hints.insert("logging.sample_rate_hz".into(), hint);
    }
    let Some(position) = position.map(Chosen::or_unscaled) else { return };
    let Some(motion) = position.values() else { return };
    let stroke = position.range().map(|(min, max)| max - min);
    let (period, amplitude) = match plant {
        TemplatePlant::Axis(_) => ("axis.period_s", ("axis.amplitude", stroke.map(|stroke| 0.5 * stroke))),
        TemplatePlant::Transmission => ("drive.period_s", ("drive.stroke_m", stroke)),
    };
    values.set_hint(period, period_s(&times, &motion), TIME);
    values.set_hint(amplitude.0, amplitude.1, name);
}

fn set_axis(values: &mut Values, kind: AxisKind, period_s: Option<f64>, stroke: Option<f64>) {
    let is_linear = kind == AxisKind::Linear;
    values.set("axis.kind", format!("{:?}", if is_linear { "linear" } else { "rotary" }), "");
    values.set_number("axis.period_s", period_s, "from the log");
    let amplitude = stroke.map(|stroke| 0.5 * stroke);
    values.set_number("axis.amplitude", amplitude, "from the log");
    for name in ["coulomb_effort", "viscous_effort", "load_coefficient"] {
        values.set(
            &format!("axis.{name}"),
            "0.0".into(),
            "replace it by what is known; a diagnosis finds the difference",
        );
    }
    if is_linear {
        values.set("axis.friction_radius_m", "1.0".into(), "");
        let speed = amplitude
            .zip(period_s)
            .map(|(amplitude, period_s)| 2.0 * core::f64::consts::PI * amplitude / period_s);
        let width = speed.map(|speed| REGULARISATION_SHARE * speed);
        values.set_number("axis.regularisation_m_s", width, "a hundredth of the largest speed");
    }
}

/// Laws of the contact and of friction as in the default bench.
fn set_laws(values: &mut Values) {
    let preset = PRESETS.first().and_then(|(_, text)| toml::from_str::<toml::Table>(text).ok());
    for section in ["contact", "friction"] {
        let fields = preset.as_ref().and_then(|preset| preset.get(section)?.as_table());
        for (field, value) in fields.into_iter().flatten() {
            values.set(&format!("{section}.{field}"), value.to_string(), "as in bench-b");
        }
    }
}
