//! Reading, checking, presetting and writing bench descriptions.

use crate::description::{Bench, DescriptionError, Nuisances};
use crate::log_format::LogFormat;
use crate::sensor::Sensor;
use crate::{atomic, channel::Channel, effects::Effect};
use std::collections::BTreeMap;
use std::path::Path;

/// The benches that ship, by name.
pub const PRESETS: &[(&str, &str)] = &[
    ("bench-b", include_str!("../presets/bench-b.toml")),
    ("bench-a", include_str!("../presets/bench-a.toml")),
    ("friction-rig", include_str!("../presets/friction-rig.toml")),
    ("friction-rig-babbitt", include_str!("../presets/friction-rig-babbitt.toml")),
    ("friction-rig-plastic", include_str!("../presets/friction-rig-plastic.toml")),
];

impl Bench {
    /// A preset by name, or a description from a file.
    pub fn open(name_or_file: &str) -> Result<Self, DescriptionError> {
        if let Some((name, text)) = PRESETS.iter().find(|(name, _)| *name == name_or_file) {
            return Self::parse(name, text);
        }
        let text = std::fs::read_to_string(name_or_file).map_err(|source| {
            let known = PRESETS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
            DescriptionError::Unreadable {
                file: format!("{name_or_file} (neither a preset, {known}, nor a file)"),
                source,
            }
        })?;
        Self::parse(name_or_file, &text)
    }

    /// Parses and checks a description; `file` names it in messages.
    pub fn parse(file: &str, text: &str) -> Result<Self, DescriptionError> {
        let malformed =
            |e: toml::de::Error| DescriptionError::Malformed { file: file.into(), message: e.to_string() };
        let table: toml::Table = toml::from_str(text).map_err(malformed)?;
        let bench = match table.get("plant").and_then(toml::Value::as_str) {
            Some("transmission-bench") => Self::Transmission(toml::from_str(text).map_err(malformed)?),
            Some("friction-rig") => Self::FrictionRig(toml::from_str(text).map_err(malformed)?),
            other => {
                return Err(DescriptionError::OutOfRange {
                    file: file.into(),
                    field: "plant".into(),
                    found: other.map_or("missing or no text".into(), |p| format!("`{p}`")),
                    expected: "`transmission-bench` or `friction-rig`".into(),
                });
            }
        };
        bench.check(file)?;
        Ok(bench)
    }

    /// The description as TOML.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        match self {
            Self::Transmission(bench) => toml::to_string(bench),
            Self::FrictionRig(rig) => toml::to_string(rig),
        }
    }

    /// Writes the description to a file, whole or not at all.
    pub fn write(&self, path: &Path) -> std::io::Result<()> {
        let text = self.to_toml().map_err(std::io::Error::other)?;
        atomic::write(path, text.as_bytes())
    }

    /// The effects of the description.
    pub fn effects(&self) -> &[Effect] {
        match self {
            Self::Transmission(bench) => &bench.effects,
            Self::FrictionRig(rig) => &rig.effects,
        }
    }

    /// The effects, to be added to.
    pub fn effects_mut(&mut self) -> &mut Vec<Effect> {
        match self {
            Self::Transmission(bench) => &mut bench.effects,
            Self::FrictionRig(rig) => &mut rig.effects,
        }
    }

    /// The sensors by channel.
    pub fn sensors(&self) -> &BTreeMap<Channel, Sensor> {
        match self {
            Self::Transmission(bench) => &bench.sensors,
            Self::FrictionRig(rig) => &rig.sensors,
        }
    }

    /// Standard deviation of what calibration may move, by parameter name.
    pub fn uncertain(&self) -> &BTreeMap<String, f64> {
        match self {
            Self::Transmission(bench) => &bench.uncertain,
            Self::FrictionRig(rig) => &rig.uncertain,
        }
    }

    /// What the description declares as a session's own.
    pub fn nuisances(&self) -> &Nuisances {
        match self {
            Self::Transmission(bench) => &bench.nuisances,
            Self::FrictionRig(rig) => &rig.nuisances,
        }
    }

    /// Sets the rise of the bearing's temperature over its surroundings at the first sample, K.
    pub fn set_temperature_start_k(&mut self, rise_k: f64) {
        match self {
            Self::Transmission(bench) => bench.extension.temperature_start_k = rise_k,
            Self::FrictionRig(rig) => rig.extension.temperature_start_k = rise_k,
        }
    }

    /// How a foreign log is read.
    pub fn log_format(&self) -> LogFormat {
        match self {
            Self::Transmission(bench) => LogFormat { text: bench.log, columns: bench.columns.clone() },
            Self::FrictionRig(rig) => LogFormat { text: rig.log, columns: rig.columns.clone() },
        }
    }

    /// Sets the number of cycles of a run or a record.
    pub fn set_cycles(&mut self, cycles: u32) {
        match self {
            Self::Transmission(bench) => bench.drive.cycles = cycles,
            Self::FrictionRig(rig) => rig.axis.cycles = cycles,
        }
    }

    /// The description with all its effects applied: what is simulated.
    pub fn resolved(&self) -> Self {
        let mut bench = self.clone();
        let effects = std::mem::take(bench.effects_mut());
        for effect in &effects {
            effect.apply(&mut bench);
        }
        // Where no friction follows temperature, none shows: benches that differ by it alone are one bench.
        match &mut bench {
            Self::Transmission(b) if b.extension.thermal.is_none() => b.extension.temperature_start_k = 0.0,
            Self::FrictionRig(r) if r.extension.thermal.is_none() => r.extension.temperature_start_k = 0.0,
            _ => {}
        }
        bench
    }

    /// A parameter by its dotted name (`shaft.mass_kg`, `sensors.journal_y_m.offset`).
    pub fn parameter_mut(&mut self, name: &str) -> Option<&mut f64> {
        if let Some(rest) = name.strip_prefix("sensors.") {
            let (channel, field) = rest.split_once('.')?;
            let channel = Channel::from_name(channel)?;
            let sensors = match self {
                Self::Transmission(bench) => &mut bench.sensors,
                Self::FrictionRig(rig) => &mut rig.sensors,
            };
            let sensor = sensors.entry(channel).or_default();
            return match field {
                "offset" => Some(&mut sensor.offset),
                "gain" => Some(&mut sensor.gain),
                "delay_s" => Some(&mut sensor.delay_s),
                _ => None,
            };
        }
        match self {
            Self::Transmission(bench) => bench.parameter_mut(name),
            Self::FrictionRig(rig) => match name {
                "axis.inertia" => Some(&mut rig.axis.inertia),
                "axis.load_gain" => Some(&mut rig.axis.load_gain),
                "axis.coulomb_effort" => Some(&mut rig.axis.coulomb_effort),
                "axis.viscous_effort" => Some(&mut rig.axis.viscous_effort),
                "axis.load_coefficient" => Some(&mut rig.axis.load_coefficient),
                _ => None,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_parse_and_survive_a_round_trip() {
        for (name, _) in PRESETS {
            let bench = Bench::open(name).unwrap();
            let again = Bench::parse(name, &bench.to_toml().unwrap()).unwrap();
            assert_eq!(bench, again, "{name}");
        }
    }

    #[test]
    fn a_sweep_has_no_rests_and_takes_its_time() {
        let (_, text) = PRESETS.iter().find(|(name, _)| *name == "friction-rig").unwrap();
        let with = |line: &str| Bench::parse("rig", &text.replace("[axis]", &format!("[axis]\n{line}")));
        let refused = |line: &str| with(line).unwrap_err().to_string();
        assert_eq!(
            refused("last_period_s = 1e-9"),
            "rig: axis.last_period_s is 1e-9; expected 0.001 to 1000000"
        );
        let both = refused("last_period_s = 5.0\ndwell_s = 1.0");
        assert_eq!(both, "rig: axis.dwell_s is 1; expected 0 to 0");
        let Bench::FrictionRig(plain) = with("").unwrap() else { panic!("{text}") };
        let line = format!("last_period_s = {:?}\nbackwards = true", plain.axis.period_s / 3.0);
        let Bench::FrictionRig(swept) = with(&line).unwrap() else { panic!("{text}") };
        assert!((swept.axis.duration_s() / plain.axis.duration_s() - 0.5).abs() < 1e-12);
        let early = 0.01 * plain.axis.period_s;
        assert!(swept.axis.motion().at(early).value < 0.0 && plain.axis.motion().at(early).value > 0.0);
        let swept = Bench::FrictionRig(swept);
        assert_eq!(Bench::parse("again", &swept.to_toml().unwrap()).unwrap(), swept);
    }
}
