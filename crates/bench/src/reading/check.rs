//! Checks of a description: every number against its range, every name against its list.

use super::laws;
use crate::description::{Bench, Common, DescriptionError, Refusal, format_number};
use crate::log::unknown_column;

impl Bench {
    /// Checks the description; `file` names it in messages.
    pub(crate) fn check(&self, file: &str) -> Result<(), DescriptionError> {
        let refusal = self
            .range_refusal()
            .or_else(|| self.refusal())
            .or_else(|| laws::refusal(self))
            .or_else(|| self.log_refusal())
            .or_else(|| self.sensor_refusal())
            .or_else(|| self.column_refusal())
            .or_else(|| self.nuisances().refusal())
            .or_else(|| self.uncertainty_refusal());
        if let Some((field, found, expected)) = refusal {
            return Err(DescriptionError::OutOfRange { file: file.into(), field, found, expected });
        }
        for effect in self.effects() {
            effect
                .check(self)
                .map_err(|e| DescriptionError::Malformed { file: file.into(), message: e.to_string() })?;
        }
        Ok(())
    }

    fn range_refusal(&self) -> Option<Refusal> {
        self.ranges().into_iter().find_map(|(field, value, min, max)| outside(field, value, (min, max)))
    }

    /// Refuses sections that only a plant with a log has.
    fn log_refusal(&self) -> Option<Refusal> {
        if self.drive_channels().is_some() || *self.common() == Common::default() {
            return None;
        }
        let expected = "no `[sensors]`, `[uncertain]`, `[nuisances]`, `[log]`, `[columns]` or `[[effects]]`";
        Some(("plant".into(), format!("`{}`, which has no log,", self.plant_name()), expected.into()))
    }

    fn sensor_refusal(&self) -> Option<Refusal> {
        let (noise, size) = ((0.0, 1e12), (-1e12, 1e12));
        self.sensors().iter().find_map(|(channel, sensor)| {
            let numbers = [
                ("noise", sensor.noise, noise),
                ("resolution", sensor.resolution, noise),
                ("bandwidth_hz", sensor.bandwidth_hz, noise),
                ("delay_s", sensor.delay_s, (-1e3, 1e3)),
                ("offset", sensor.offset, size),
                ("gain", sensor.gain, size),
                ("drift_per_s", sensor.drift_per_s, size),
                ("inverse_limit", sensor.inverse_limit, noise),
                ("outlier_share", sensor.outlier_share, (0.0, 1.0)),
                ("outlier_size", sensor.outlier_size, noise),
            ];
            numbers.into_iter().find_map(|(field, value, range)| {
                outside(&format!("sensors.{channel}.{field}"), value, range)
            })
        })
    }

    fn column_refusal(&self) -> Option<Refusal> {
        let name = unknown_column(&self.common().columns)?;
        let expected = "t_s or a channel with its unit, such as position_m";
        Some((format!("columns.{name}"), "no such channel".into(), expected.into()))
    }

    fn uncertainty_refusal(&self) -> Option<Refusal> {
        let mut probe = self.clone();
        self.uncertain().iter().find_map(|(name, deviation)| {
            let field = format!("uncertain.{name}");
            if probe.parameter_mut(name).is_none() {
                let expected = "a dotted parameter name, such as shaft.mass_kg";
                return Some((field, "no such parameter".into(), expected.into()));
            }
            let is_allowed = *deviation > 0.0 && *deviation <= 1e15;
            let expected = "a standard deviation above 0, up to 1e15";
            (!is_allowed).then(|| (field, format_number(*deviation), expected.into()))
        })
    }
}

/// Refuses a value outside its range; NaN is outside every range.
fn outside(field: &str, value: f64, (min, max): (f64, f64)) -> Option<Refusal> {
    let expected = || format!("{} to {}", format_number(min), format_number(max));
    (!(min..=max).contains(&value)).then(|| (field.to_owned(), format_number(value), expected()))
}

#[cfg(test)]
mod tests {
    use crate::{Bench, PRESETS};

    #[test]
    fn refusals_name_the_field_the_content_found_and_the_content_expected() {
        let (_, text) = PRESETS[0];
        for (from, to, expected) in [
            ("mass_kg = 150.0", "mass_kg = -1.0", "shaft.mass_kg is -1; expected 0.001 to 1e9"),
            ("mass_kg = 150.0", "mass_kg = \"heavy\"", "line"),
            ("mass_kg = 150.0", "mas_kg = 150.0", "unknown field `mas_kg`"),
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
                "\"hybrid-as-printed\"",
                "\"rubber\"",
                "found stiffness `rubber`; expected one of linear, hertz",
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
                "shape = \"tustin\"\nlaw = \"coulomb\"",
                "friction.law is coulomb; expected one of regularised-linear,",
            ),
            (
                "shape = \"tustin\"",
                "shape = \"tustin\"\nlaw = \"karnopp\"",
                "friction.law is karnopp; expected one of regularised-linear,",
            ),
            (
                "[friction]",
                "coefficient = 1e9\n[friction]",
                "contact.coefficient is 1e9; expected none: `hybrid-as-printed` does not use it",
            ),
            (
                "sample_rate_hz = 1000.0",
                "sample_rate_hz = 1e300",
                "logging.sample_rate_hz is 1e300; expected",
            ),
            ("period_s = 1.0", "period_s = 1e300", "drive.period_s is 1e300; expected 0.001 to 1000000"),
            ("[friction]", "damping = \"wet\"\n[friction]", "found damping `wet`; expected one of latched"),
            (
                "journal_y_m = { noise = 0.2e-6 }",
                "journal_y_m = { noise = -1.0 }",
                "sensors.journal_y_m.noise",
            ),
        ] {
            let error = Bench::parse("x.toml", &text.replacen(from, to, 1)).unwrap_err().to_string();
            assert!(error.starts_with("x.toml") && error.contains(expected), "{error}");
        }
        let error =
            Bench::parse("x.toml", &format!("{text}\n[[effects]]\nname = \"gremlins\"\n")).unwrap_err();
        assert!(error.to_string().contains("`gremlins` is not a known effect"), "{error}");
        assert!(Bench::open("no-such-bench").unwrap_err().to_string().contains("neither a preset"));
    }
}
