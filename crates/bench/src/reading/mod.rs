//! Reading, checking and writing of bench descriptions, and the presets.

mod check;
mod laws;
mod structure;

pub use laws::sticking_plants;
pub use structure::FILL_IN;

use crate::atomic;
use crate::description::{
    Bench, DescriptionError, Flaw, FrictionRig, MechanismBench, SliderCrankBench, TransmissionBench,
};
use crate::schema::Placeholder;
use std::path::Path;
use structure::Structure;
use toml::de::{DeTable, DeValue};

/// Presets by name, as TOML.
pub const PRESETS: &[(&str, &str)] = &[
    ("bench-b", include_str!("../../presets/bench-b.toml")),
    ("bench-a", include_str!("../../presets/bench-a.toml")),
    ("friction-rig", include_str!("../../presets/friction-rig.toml")),
    ("friction-rig-babbitt", include_str!("../../presets/friction-rig-babbitt.toml")),
    ("friction-rig-plastic", include_str!("../../presets/friction-rig-plastic.toml")),
    ("slider-crank", include_str!("../../presets/slider-crank.toml")),
    ("four-bar", include_str!("../../../../examples/four-bar.toml")),
];

impl Bench {
    /// Opens a preset by name, or a description from a file.
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

    /// Parses and checks a description; `file` names it in messages. The error lists every wrong
    /// and every missing entry.
    pub fn parse(file: &str, text: &str) -> Result<Self, DescriptionError> {
        let malformed =
            |e: toml::de::Error| DescriptionError::Malformed { file: file.into(), message: e.to_string() };
        let table = DeTable::parse(text).map_err(malformed)?.into_inner();
        let plant = table.iter().find(|(key, _)| key.get_ref() == "plant").map(|(_, value)| value.get_ref());
        let name = plant.and_then(DeValue::as_str);
        let Some((name, sections)) = name.and_then(|name| Some((name, Self::sections(name)?))) else {
            return Err(DescriptionError::Flawed { file: file.into(), flaws: vec![wrong_plant(name)] });
        };
        let structure = Structure::check(text, &table, &sections);
        let (bench, refusals) = if structure.flaws.is_empty() {
            let mut bench = Self::from_toml(name, text).transpose().map_err(malformed)?;
            let unread = bench.as_mut().map(|bench| bench.read_files(file)).unwrap_or_default();
            let refusals = bench.as_ref().map(Self::refusals).unwrap_or_default();
            (bench, unread.into_iter().chain(refusals).collect())
        } else {
            (None, independent_refusals(name, &structure))
        };
        let flaw = |entry: check::Refused| {
            let (field, found, expected) = entry.refusal;
            Flaw { line: structure.line(&entry.key), field, found, expected }
        };
        let mut flaws = structure.flaws.clone();
        flaws.extend(refusals.into_iter().map(flaw));
        flaws.sort_by_key(|flaw| flaw.line.unwrap_or(usize::MAX));
        match bench {
            Some(bench) if flaws.is_empty() => Ok(bench),
            _ => Err(DescriptionError::Flawed { file: file.into(), flaws }),
        }
    }

    /// Reads the files that a description names; `file` is that of the description.
    fn read_files(&mut self, file: &str) -> Vec<check::Refused> {
        let folder = Path::new(file).parent().unwrap_or(Path::new(""));
        let refusals = self.transmission_mut().map(|bench| bench.read_courses(folder)).unwrap_or_default();
        refusals.into_iter().map(check::Refused::new).collect()
    }

    /// Checks a changed description as [`Self::parse`] does. Messages have no lines, because no
    /// file has the changes.
    pub fn checked(&self, file: &str) -> Result<Self, DescriptionError> {
        let malformed = |message: String| DescriptionError::Malformed { file: file.into(), message };
        let text = self.to_toml().map_err(|e| malformed(e.to_string()))?;
        Self::parse(file, &text).map_err(|error| match error {
            DescriptionError::Flawed { file, mut flaws } => {
                flaws.iter_mut().for_each(|flaw| flaw.line = None);
                DescriptionError::Flawed { file, flaws }
            }
            other => other,
        })
    }

    /// Writes the description to a file atomically.
    pub fn write(&self, path: &Path) -> std::io::Result<()> {
        let text = self.to_toml().map_err(std::io::Error::other)?;
        atomic::write(path, text.as_bytes())
    }
}

/// Flaw of a description without a known plant.
fn wrong_plant(name: Option<&str>) -> Flaw {
    Flaw {
        line: None,
        field: "plant".into(),
        found: name.map_or("missing or no text".into(), |name| format!("`{name}`")),
        expected: format!("one of `{}`", Bench::PLANTS.join("`, `")),
    }
}

/// Refusals of a flawed description that do not depend on its missing and wrong entries: those that
/// two different sets of placeholders have in common.
fn independent_refusals(plant: &str, structure: &Structure<'_>) -> Vec<check::Refused> {
    let refusals = |which| -> Option<Vec<check::Refused>> {
        let text = toml::to_string(&structure.repaired(which)?).ok()?;
        Some(Bench::from_toml(plant, &text)?.ok()?.refusals())
    };
    let (low, high) = (refusals(Placeholder::Low), refusals(Placeholder::High));
    let (Some(mut low), Some(high)) = (low, high) else { return Vec::new() };
    low.retain(|entry| high.contains(entry) && !structure.is_of_unknown_effect(&entry.key));
    low
}

/// Defines opening for each plant.
macro_rules! opened_plants {
    ($($plant:ident),*) => {$(
        impl $plant {
            /// Opens a preset or a file, as [`Bench::open`], and refuses every other plant.
            pub fn open(name_or_file: &str) -> Result<Self, DescriptionError> {
                Self::from_bench(Bench::open(name_or_file)?, name_or_file)
            }
        }
    )*};
}

opened_plants!(TransmissionBench, FrictionRig, SliderCrankBench, MechanismBench);

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
    fn every_plant_states_what_its_model_omits() {
        for (name, _) in PRESETS {
            let limits = Bench::open(name).unwrap().limits();
            assert!(limits.len() >= 2, "{name}");
            assert!(limits.iter().all(|s| s.ends_with('.') && s.len() < 130), "{name}");
        }
    }

    #[test]
    fn a_sweep_has_no_standstills_and_the_right_duration() {
        let (_, text) = PRESETS.iter().find(|(name, _)| *name == "friction-rig").unwrap();
        let with = |line: &str| Bench::parse("rig", &text.replace("[axis]", &format!("[axis]\n{line}")));
        let refused = |line: &str| with(line).unwrap_err().to_string();
        assert_eq!(
            refused("last_period_s = 1e-9"),
            "rig: line 5: axis.last_period_s is 1e-9; expected 0.001 to 1000000 s"
        );
        let both = refused("last_period_s = 5.0\ndwell_s = 1.0");
        assert_eq!(both, "rig: line 6: axis.dwell_s is 1; expected 0 to 0 s");
        let Bench::FrictionRig(plain) = with("").unwrap() else { panic!("{text}") };
        let line = format!("last_period_s = {:?}\nbackwards = true", plain.axis.period_s / 3.0);
        let Bench::FrictionRig(swept) = with(&line).unwrap() else { panic!("{text}") };
        assert!((swept.axis.duration_s() / plain.axis.duration_s() - 0.5).abs() < 1e-12);
        let early = 0.01 * plain.axis.period_s;
        assert!(swept.axis.motion().at(early).value < 0.0 && plain.axis.motion().at(early).value > 0.0);
        let swept = Bench::FrictionRig(swept);
        assert_eq!(Bench::parse("again", &swept.to_toml().unwrap()).unwrap(), swept);
    }

    #[test]
    fn a_slider_crank_is_refused_with_the_field_and_has_no_log() {
        let (_, text) = PRESETS.iter().find(|(name, _)| *name == "slider-crank").unwrap();
        let refused = |text: &str| Bench::parse("x", text).unwrap_err().to_string();
        let error = refused(&text.replace("9.5e-3", "10.5e-3"));
        assert!(error.contains("joint.journal_radius_m is 0.0105; expected 1e-9 to 0.009999"), "{error}");
        let error = refused(&text.replace("mass_kg = 0.14", "mas = 1"));
        assert!(error.contains("slider.mas is an unknown field; expected one of mass_kg"), "{error}");
        let named = |more: &str| {
            text.replace("dissipation", &format!("stiffness = \"johnson\"\n{more}\ndissipation"))
        };
        let error = refused(&named(""));
        assert!(error.contains("joint is johnson needs length_m, found none"), "{error}");
        let Bench::SliderCrank(johnson) = Bench::parse("x", &named("length_m = 0.02")).unwrap() else {
            panic!()
        };
        assert!(matches!(johnson.plant().normal_law.stiffness, contact::Stiffness::Logarithmic(_)));
        let error = refused(&format!("{text}\n[sensors]\nshaft_angle_rad = {{ noise = 1e-6 }}\n"));
        assert!(error.contains("which has no log"), "{error}");
        let bench = Bench::open("slider-crank").unwrap();
        let error = crate::simulate::record(&bench, 1).unwrap_err().to_string();
        assert!(error.starts_with("found plant `slider-crank`, which has no log"), "{error}");
    }

    #[test]
    fn a_changed_description_is_refused_without_a_line() {
        let mut bench = Bench::open("bench-b").unwrap();
        *bench.parameter_mut("shaft.mass_kg").unwrap() = -1.0;
        let error = bench.checked("bench-b with -1 kg").unwrap_err().to_string();
        assert_eq!(error, "bench-b with -1 kg: shaft.mass_kg is -1; expected 0.001 to 1e9 kg");
        *bench.parameter_mut("shaft.mass_kg").unwrap() = 1.0;
        assert_eq!(bench.checked("x").unwrap(), bench);
    }

    #[test]
    fn an_unknown_section_is_refused_with_its_line() {
        let (_, text) = PRESETS[0];
        let error = Bench::parse("x", &format!("gremlins = 1\n{text}")).unwrap_err().to_string();
        assert!(error.starts_with("x: line 1: gremlins is an unknown field; expected one of"), "{error}");
        let other = TransmissionBench::open("friction-rig").unwrap_err().to_string();
        assert_eq!(other, "friction-rig: found plant `friction-rig`; expected `transmission-bench`");
    }
}
