//! Checks of a description whose fields are all present and in the ranges of their sections: ranges
//! that depend on other fields, laws, names, effects.

use super::laws;
use crate::description::{Bench, Common, Refusal, format_number};
use crate::schema::FieldEntry;

/// A refusal and the entry that it belongs to.
#[derive(Debug, PartialEq)]
pub(crate) struct Refused {
    /// Dotted name of the entry in the file.
    pub(crate) key: String,
    pub(crate) refusal: Refusal,
}

impl Refused {
    pub(super) fn new(refusal: Refusal) -> Self {
        Self { key: refusal.0.clone(), refusal }
    }
}

impl Bench {
    /// Everything that is not allowed.
    pub(crate) fn refusals(&self) -> Vec<Refused> {
        let ranges = self.dependent_ranges().into_iter();
        let out_of_range =
            ranges.filter_map(|(field, value, min, max)| self.outside(field, value, (min, max)));
        let mut all: Vec<Refusal> = out_of_range.collect();
        all.extend(self.deref_refusals());
        all.extend(laws::refusals(self));
        all.extend(self.log_refusal());
        all.extend(self.nuisances().refusals(|channel| self.role(channel)));
        all.extend(self.uncertainty_refusals());
        let effects = self.effects().iter().enumerate().flat_map(|(index, effect)| {
            effect.errors(self).into_iter().map(move |error| {
                let (field, refusal) = error.refusal();
                Refused { key: format!("effects.{index}.{field}"), refusal }
            })
        });
        let effects: Vec<Refused> = effects.collect();
        // Only effects that are right one by one can be applied.
        let together = effects.is_empty().then(|| self.clearance_refusal()).flatten();
        all.extend(together);
        all.into_iter().map(Refused::new).chain(effects).collect()
    }

    /// Refuses effects that together leave a joint of a mechanism no possible clearance.
    fn clearance_refusal(&self) -> Option<Refusal> {
        match self.resolved() {
            Self::Mechanism(changed) if !changed.has_clearances() => Some((
                "effects".into(),
                "a set that leaves a joint no clearance, or more than its bearing's radius".into(),
                "a clearance between 0 and the radius".into(),
            )),
            _ => None,
        }
    }

    /// Refusals of the plant.
    fn deref_refusals(&self) -> Vec<Refusal> {
        crate::description::PlantDescription::refusals(&**self)
    }

    /// Refuses sections that only a plant with a log has.
    fn log_refusal(&self) -> Option<Refusal> {
        if self.drive_channels().is_some() || *self.common() == Common::default() {
            return None;
        }
        let expected = "no `[sensors]`, `[uncertain]`, `[nuisances]`, `[log]`, `[columns]` or `[[effects]]`";
        Some(("plant".into(), format!("`{}`, which has no log,", self.plant_name()), expected.into()))
    }

    fn uncertainty_refusals(&self) -> Vec<Refusal> {
        let mut probe = self.clone();
        let refused = |(name, deviation): (&String, &f64)| {
            let field = format!("uncertain.{name}");
            if probe.parameter_mut(name).is_none() {
                let expected = "a dotted parameter name, such as shaft.mass_kg";
                return Some((field, "no such parameter".into(), expected.into()));
            }
            let is_allowed = *deviation > 0.0 && *deviation <= 1e15;
            let expected = "a standard deviation above 0, up to 1e15";
            (!is_allowed).then(|| (field, format_number(*deviation), expected.into()))
        };
        self.uncertain().iter().filter_map(refused).collect()
    }

    /// Refuses a value outside its range; NaN is outside every range.
    fn outside(&self, field: &str, value: f64, (min, max): (f64, f64)) -> Option<Refusal> {
        if (min..=max).contains(&value) {
            return None;
        }
        let unit = self.entry(field).map_or("", |entry| entry.unit());
        let expected = format!("{} to {} {unit}", format_number(min), format_number(max));
        Some((field.to_owned(), format_number(value), expected.trim_end().into()))
    }

    /// Entry of a field by its dotted name.
    fn entry(&self, field: &str) -> Option<&'static FieldEntry> {
        let (section, name) = field.split_once('.')?;
        let sections = Self::sections(self.plant_name())?;
        let section = sections.into_iter().find(|entry| entry.name == section)?;
        section.fields.iter().find(|entry| entry.name == name)
    }
}

#[cfg(test)]
mod tests {
    use crate::{Bench, PRESETS};

    /// Changes the default bench and expects a refusal.
    fn assert_refused(from: &str, to: &str, expected: &str) {
        let (_, text) = PRESETS[0];
        let error = Bench::parse("x.toml", &text.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.starts_with("x.toml") && error.contains(expected), "{error}");
    }

    #[test]
    fn refusals_name_the_field_the_content_found_and_the_content_expected() {
        let (_, text) = PRESETS[0];
        for (from, to, expected) in [
            ("mass_kg = 150.0", "mass_kg = -1.0", "line 9: shaft.mass_kg is -1; expected 0.001 to 1e9 kg"),
            (
                "mass_kg = 150.0",
                "mass_kg = \"heavy\"",
                "line 9: shaft.mass_kg is `heavy`; expected a number,",
            ),
            (
                "mass_kg = 150.0",
                "mas_kg = 150.0",
                "line 9: shaft.mas_kg is an unknown field; expected one of mass_kg,",
            ),
            ("\"shaft.mass_kg\" = 3.0", "\"shaft.masse\" = 3.0", "uncertain.shaft.masse"),
            ("transmission-bench", "teapot", "plant is `teapot`"),
            ("[logging]", "[two_plane]\nslices = 0\n[logging]", "two_plane.slices is 0; expected 1 to 201"),
            (
                "[logging]",
                "[two_plane]\n[fork]\nbacklash_m = 1e-4\n[logging]",
                "two_plane is combined with a compliant drive; expected no `[fork]`",
            ),
            ("[logging]", "[fork]\nbacklash_m = -1.0\n[logging]", "fork.backlash_m is -1; expected 0 to"),
            (
                "sample_rate_hz = 1000.0",
                "sample_rate_hz = 1e300",
                "logging.sample_rate_hz is 1e300; expected",
            ),
            ("period_s = 1.0", "period_s = 1e300", "drive.period_s is 1e300; expected 0.001 to 1000000"),
            (
                "journal_y_m = { noise = 0.2e-6 }",
                "journal_y_m = { noise = -1.0 }",
                "sensors.journal_y_m.noise",
            ),
        ] {
            assert_refused(from, to, expected);
        }
        let error =
            Bench::parse("x.toml", &format!("{text}\n[[effects]]\nname = \"gremlins\"\n")).unwrap_err();
        assert!(
            error.to_string().contains("effects.0.name is `gremlins`, which is not a known effect"),
            "{error}"
        );
        assert!(Bench::open("no-such-bench").unwrap_err().to_string().contains("neither a preset"));
    }

    #[test]
    fn refusals_of_laws_name_the_field_the_content_found_and_the_content_expected() {
        for (from, to, expected) in [
            (
                "\"hybrid-as-printed\"",
                "\"rubber\"",
                "contact.stiffness is `rubber`; expected one of linear, hertz",
            ),
            (
                "\"hybrid-as-printed\"",
                "\"linear\"",
                "contact.coefficient is missing; expected a number, which `linear` needs",
            ),
            (
                "\"hybrid-as-printed\"",
                "\"linear\"\ncoefficient = -1.0",
                "contact: coefficient (N/m^n) is -1; expected a finite number above 0",
            ),
            (
                "shape = \"tustin\"",
                "shape = \"tustin\"\nlaw = \"lugre\"",
                "friction.bristle_stiffness_per_m is missing; expected a number, which `lugre` needs",
            ),
            (
                "shape = \"tustin\"",
                "shape = \"tustin\"\nlaw = \"coulomb\"\n[two_plane]",
                "friction.law is coulomb; expected one of regularised-linear,",
            ),
            (
                "shape = \"tustin\"",
                "shape = \"tustin\"\nlaw = \"seven-parameter\"",
                "friction_memory is missing; expected a section with lag_s and rise_s,",
            ),
            (
                "[friction]",
                "[friction_memory]\nlag_s = 0.01\nrise_s = 0.5\n[friction]",
                "friction_memory is given; expected no such section: only `seven-parameter` uses it",
            ),
            ("shape = \"tustin\"", "shape = \"tustin\"\nlaw = \"karnopp\"\nviscous_slope_s_m = 100", ""),
            (
                "[friction]",
                "coefficient = 1e9\n[friction]",
                "contact.coefficient is 1e9; expected none: `hybrid-as-printed` does not use it",
            ),
            (
                "[friction]",
                "damping = \"wet\"\n[friction]",
                "contact.damping is `wet`; expected one of latched",
            ),
        ] {
            assert_refused(from, to, expected);
        }
    }

    /// A linear axis with many flaws: missing, misspelt, of a wrong type, out of range; also in
    /// names that are checked only once everything else is known.
    const FLAWED: &str = r#"plant = "friction-rig"
[axis]
kind = "linear"
inertia = "?"
frction_radius_m = 1.0
load_gain = 1e9
coulomb_effort = 0.0
load_coefficient = 0.0
regularisation_m_s = 1e-3
period_s = 2.0
amplitude = true
last_period_s = 1.0
dwell_s = 0.5
[load]
force_n = 0.0
ramp_s = 0.0
[sensors]
drive_force = { noise = 1.0 }
position_m = { noise = -1.0, smell = 2.0 }
[uncertain]
"axis.mass" = 1.0
[nuisances.offset]
position_m = 1.0
[log]
separator = "pipe"
[columns]
position_m = { from = -1 }
velocity_m_s = { scale = 1.0 }
[[effects]]
name = "gremlins"
[[effects]]
name = "viscous-friction"
effort = "much"
[[effects]]
name = "viscous-friction"
size = 1.0
"#;

    #[test]
    fn every_flaw_of_a_description_is_reported_in_one_message_with_its_line() {
        let error = Bench::parse("x.toml", FLAWED).unwrap_err().to_string();
        for expected in [
            "line 4: axis.inertia is not filled in; expected a number, 0 to 1e9 kg or kg m2",
            "line 5: axis.frction_radius_m is an unknown field; expected one of kind, inertia,",
            "line 2: axis.friction_radius_m is missing; expected a number, 1e-6 to 1000 m (radius at which",
            "line 6: axis.load_gain is 1e9; expected -1000 to 1000",
            "line 2: axis.viscous_effort is missing; expected a number,",
            "line 11: axis.amplitude is true; expected a number, 1e-9 to 1000000 m or rad",
            "line 13: axis.dwell_s is 0.5; expected 0 to 0 s",
            "line 16: load.ramp_s is 0; expected 1e-12 to 1e12 s",
            "\n  logging is missing; expected `[logging]` with sample_rate_hz",
            "line 18: sensors.drive_force is an unknown channel; expected one of",
            "line 19: sensors.position_m.noise is -1; expected 0 to 1e12 m",
            "line 19: sensors.position_m.smell is an unknown field; expected one of noise,",
            "line 21: uncertain.axis.mass is no such parameter",
            "line 23: nuisances.offset.position_m is of an input",
            "line 25: log.separator is `pipe`; expected one of comma, semicolon, tab, whitespace",
            "line 27: columns.position_m.from is -1; expected the name of a column, an expression of",
            "line 28: columns.velocity_m_s.from is missing; expected the name of a column",
            "line 30: effects.0.name is `gremlins`, which is not a known effect; expected one of",
            "line 33: effects.1.effort is `much`; expected a number",
            "line 36: effects: `viscous-friction`.size is an unknown parameter; expected one of",
        ] {
            assert!(error.contains(expected), "{expected}\n{error}");
        }
        assert!(error.starts_with("x.toml: 20 entries are wrong or missing\n"), "{error}");
    }

    #[test]
    fn entries_of_another_type_are_flaws_and_never_a_panic() {
        let (_, text) = PRESETS.iter().find(|(name, _)| *name == "friction-rig").unwrap();
        for (line, expected) in [
            ("axis = 3", "axis is 3; expected a section `[axis]`"),
            ("[sensors]\nposition_m = 3", "sensors.position_m is 3; expected a table"),
            ("[effects]\nname = 3", "effects is a table; expected entries `[[effects]]`"),
            ("[[effects]]\n[[effects]]\nname = 3", "effects.1.name is 3; expected one of"),
            (
                "[columns]\nposition_m = \"?\"",
                "columns.position_m is not filled in; expected a column or an expression of columns as text, \
                 or a table, { ... }, with some of from, scale, offset",
            ),
            ("[uncertain]\n\"axis.inertia\" = []", "uncertain.axis.inertia is an array; expected"),
            ("[nuisances]\noffset = 1979-05-27", "nuisances.offset is 1979-05-27; expected a number for"),
            ("[columns.t_s]\nfrom = 1e3", "columns.t_s.from is 1e3; expected the name of a column"),
        ] {
            let (start, _) = text.split_once("[axis]").unwrap();
            let error = Bench::parse("x", &format!("{start}{line}\n")).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
        let error = Bench::parse("x", "plant = \"friction-rig\"\n[axis\n").unwrap_err().to_string();
        assert!(error.starts_with("x: TOML parse error at line 2"), "{error}");
        assert!(
            Bench::parse("x", "plant = 3").unwrap_err().to_string().contains("plant is missing or no text")
        );
    }
}
