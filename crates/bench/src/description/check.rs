//! What a description may say: every number against its range, every name against its list.

use super::laws;
use super::ranges::{self, shown};
use super::{Bench, DescriptionError};
use crate::log_format::unknown_column;

impl Bench {
    pub(crate) fn check(&self, file: &str) -> Result<(), DescriptionError> {
        let refuse = |field: String, found: String, expected: &str| {
            Err(DescriptionError::OutOfRange { file: file.into(), field, found, expected: expected.into() })
        };
        let ranges = match self {
            Self::Transmission(b) => ranges::transmission(b),
            Self::FrictionRig(r) => ranges::rig(r),
        };
        for (field, value, least, most) in ranges {
            if !(least..=most).contains(&value) {
                return refuse(field.into(), shown(value), &format!("{} to {}", shown(least), shown(most)));
            }
        }
        if let Self::Transmission(b) = self {
            if b.two_plane.is_some() && b.fork.is_some() {
                return refuse(
                    "two_plane".into(),
                    "beside a compliant drive".into(),
                    "no `[fork]`: its fork is rigid",
                );
            }
            if let Some((field, found, expected)) = laws::refusal(b) {
                return refuse(field, found, &expected);
            }
        }
        for (channel, sensor) in self.sensors() {
            let (noise, size) = ((0.0, 1e12), (-1e12, 1e12));
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
            for (field, value, (least, most)) in numbers {
                if !(least..=most).contains(&value) {
                    let field = format!("sensors.{channel}.{field}");
                    return refuse(field, shown(value), &format!("{} to {}", shown(least), shown(most)));
                }
            }
        }
        if let Some(name) = unknown_column(&self.log_format().columns) {
            return refuse(
                format!("columns.{name}"),
                "no such channel".into(),
                "t_s or a channel with its unit, such as position_m",
            );
        }
        if let Some((field, found, expected)) = self.nuisances().refusal() {
            return refuse(field, found, &expected);
        }
        let mut probe = self.clone();
        for (name, deviation) in self.uncertain() {
            if probe.parameter_mut(name).is_none() {
                return refuse(
                    format!("uncertain.{name}"),
                    "no such parameter".into(),
                    "a dotted parameter name, such as shaft.mass_kg",
                );
            }
            if !(*deviation > 0.0 && *deviation <= 1e15) {
                let expected = "a standard deviation above 0, up to 1e15";
                return refuse(format!("uncertain.{name}"), shown(*deviation), expected);
            }
        }
        let bristles = matches!(self, Self::Transmission(b) if laws::has_bristles(b));
        for effect in self.effects() {
            if bristles && effect.name == "presliding-hysteresis" {
                return refuse(
                    "effects".into(),
                    "`presliding-hysteresis` beside a friction law with bristles".into(),
                    "one of the two: such a law has a pre-sliding distance of its own",
                );
            }
            if let Err(e) = effect.check(self) {
                return Err(DescriptionError::Malformed { file: file.into(), message: e.to_string() });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::{Bench, PRESETS};

    #[test]
    fn refusals_name_field_found_and_expected() {
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
                "two_plane is beside a compliant drive; expected no `[fork]`",
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
