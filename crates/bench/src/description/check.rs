//! What a description may say: every number against its range, every name against its list.

use super::{Bench, DescriptionError};
use crate::contact_laws::{BearingFriction, JointLaw};
use crate::log_format::unknown_column;
use contact::LawError;

impl Bench {
    pub(crate) fn check(&self, file: &str) -> Result<(), DescriptionError> {
        let refuse = |field: String, found: String, expected: &str| {
            Err(DescriptionError::OutOfRange { file: file.into(), field, found, expected: expected.into() })
        };
        let positive: Vec<(&str, f64)> = match self {
            Self::Transmission(b) => vec![
                ("geometry.drive_lever_radius_m", b.geometry.drive_lever_radius_m),
                ("geometry.load_lever_radius_m", b.geometry.load_lever_radius_m),
                ("shaft.mass_kg", b.shaft.mass_kg),
                ("shaft.inertia_kg_m2", b.shaft.inertia_kg_m2),
                ("bearing.bearing_radius_m", b.bearing.bearing_radius_m),
                ("bearing.radial_clearance_m", b.bearing.radial_clearance_m),
                ("bearing.length_m", b.bearing.length_m),
                ("bearing.youngs_modulus_pa", b.bearing.youngs_modulus_pa),
                ("bearing.restitution", b.bearing.restitution),
                ("contact.latch_floor_m_s", b.contact.latch_floor_m_s),
                ("friction.stribeck_speed_m_s", b.friction.stribeck_speed_m_s),
                ("friction.regularisation_m_s", b.friction.regularisation_m_s),
                ("drive.stroke_m", b.drive.stroke_m),
                ("drive.period_s", b.drive.period_s),
                ("drive.cycles", f64::from(b.drive.cycles)),
                ("load.ramp_s", b.load.ramp_s),
                ("logging.sample_rate_hz", b.logging.sample_rate_hz),
            ],
            Self::FrictionRig(r) => vec![
                ("axis.friction_radius_m", r.axis.friction_radius_m),
                ("axis.regularisation_m_s", r.axis.regularisation_m_s),
                ("axis.period_s", r.axis.period_s),
                ("axis.amplitude", r.axis.amplitude),
                ("axis.cycles", f64::from(r.axis.cycles)),
                ("load.ramp_s", r.load.ramp_s),
                ("logging.sample_rate_hz", r.logging.sample_rate_hz),
            ],
        };
        for (field, value) in positive {
            if !(value.is_finite() && value > 0.0) {
                return refuse(field.into(), value.to_string(), "a finite number above 0");
            }
        }
        if let Self::Transmission(b) = self {
            let most = f64::MAX;
            let mut limits = vec![
                ("bearing.restitution", b.bearing.restitution, 0.0, 1.0),
                ("bearing.poisson_ratio", b.bearing.poisson_ratio, 0.0, 0.5),
                ("friction.coulomb_coefficient", b.friction.coulomb_coefficient, 0.0, 10.0),
                ("friction.static_coefficient", b.friction.static_coefficient, 0.0, 10.0),
                ("friction.level", b.friction.level, 0.0, 10.0),
                ("load.force_n", b.load.force_n, -1e7, 1e7),
                ("drive.stroke_m", b.drive.stroke_m, 0.0, 0.99 * b.geometry.drive_lever_radius_m),
                (
                    "bearing.radial_clearance_m",
                    b.bearing.radial_clearance_m,
                    0.0,
                    0.1 * b.bearing.bearing_radius_m,
                ),
            ];
            if let Some(t) = &b.two_plane {
                limits.extend([
                    ("two_plane.slices", f64::from(t.slices), 1.0, 201.0),
                    ("two_plane.transverse_inertia_kg_m2", t.transverse_inertia_kg_m2, 1e-6, most),
                    ("two_plane.drive_offset_m", t.drive_offset_m, -10.0, 10.0),
                    ("two_plane.load_offset_m", t.load_offset_m, -10.0, 10.0),
                    ("two_plane.misalignment_y_rad", t.misalignment_y_rad, -0.1, 0.1),
                    ("two_plane.misalignment_z_rad", t.misalignment_z_rad, -0.1, 0.1),
                    ("two_plane.support_stiffness_nm_rad", t.support_stiffness_nm_rad, 0.0, most),
                    ("two_plane.support_damping_nm_s_rad", t.support_damping_nm_s_rad, 0.0, most),
                ]);
            }
            let column = b.effects.iter().any(|e| e.name == "hydraulic-compliance");
            if b.two_plane.is_some() && (b.fork.is_some() || column) {
                return refuse(
                    "two_plane".into(),
                    "beside a compliant drive".into(),
                    "no `[fork]` and no `hydraulic-compliance`: its fork is rigid",
                );
            }
            if let Some(f) = &b.fork {
                limits.extend([
                    ("fork.backlash_m", f.backlash_m, 0.0, 0.1 * b.geometry.drive_lever_radius_m),
                    ("fork.stiffness_n_m", f.stiffness_n_m, 1.0, most),
                    ("fork.damping_s_m", f.damping_s_m, 0.0, most),
                ]);
            }
            if let Some(f) = &b.load_friction {
                limits.extend([
                    ("load_friction.coulomb_n", f.coulomb_n, 0.0, most),
                    ("load_friction.viscous_n_s_m", f.viscous_n_s_m, 0.0, most),
                    ("load_friction.regularisation_m_s", f.regularisation_m_s, 1e-9, most),
                ]);
            }
            for (field, value, least, most) in limits {
                if !(least..=most).contains(&value) {
                    return refuse(field.into(), value.to_string(), &range(least, most));
                }
            }
            let laws =
                [("contact", JointLaw::of(b).err()), ("friction", BearingFriction::of(&b.friction).err())];
            for (section, error) in laws {
                match error {
                    None => {}
                    Some(LawError::OutOfRange { quantity, found, expected }) => {
                        return refuse(format!("{section}: {quantity}"), found.to_string(), expected);
                    }
                    Some(e) => return refuse(section.into(), e.to_string(), "a law with all its parameters"),
                }
            }
        }
        if let Self::FrictionRig(r) = self {
            let most = f64::MAX;
            let mut limits = vec![("axis.dwell_s", r.axis.dwell_s, 0.0, most)];
            if let Some(s) = &r.surface {
                limits.extend([
                    ("surface.break_away_ratio", s.break_away_ratio, 1.0, 10.0),
                    ("surface.break_away_time_s", s.break_away_time_s, 1e-6, most),
                    ("surface.break_away_distance_m", s.break_away_distance_m, 1e-9, most),
                    ("surface.lag_s", s.lag_s, 0.0, 10.0),
                ]);
            }
            for (field, value, least, most) in limits {
                if !(least..=most).contains(&value) {
                    return refuse(field.into(), value.to_string(), &range(least, most));
                }
            }
        }
        for (channel, sensor) in self.sensors() {
            let numbers = [
                ("noise", sensor.noise, 0.0),
                ("resolution", sensor.resolution, 0.0),
                ("bandwidth_hz", sensor.bandwidth_hz, 0.0),
                ("delay_s", sensor.delay_s, f64::MIN),
                ("offset", sensor.offset, f64::MIN),
                ("gain", sensor.gain, f64::MIN),
                ("drift_per_s", sensor.drift_per_s, f64::MIN),
                ("outlier_share", sensor.outlier_share, 0.0),
                ("outlier_size", sensor.outlier_size, 0.0),
            ];
            for (field, value, least) in numbers {
                if !(value.is_finite() && value >= least) {
                    return refuse(
                        format!("sensors.{channel}.{field}"),
                        value.to_string(),
                        "a finite number, 0 or more",
                    );
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
        let mut probe = self.clone();
        for (name, deviation) in self.uncertain() {
            if probe.parameter_mut(name).is_none() {
                return refuse(
                    format!("uncertain.{name}"),
                    "no such parameter".into(),
                    "a dotted parameter name, such as shaft.mass_kg",
                );
            }
            if !(deviation.is_finite() && *deviation > 0.0) {
                return refuse(
                    format!("uncertain.{name}"),
                    deviation.to_string(),
                    "a standard deviation above 0",
                );
            }
        }
        for effect in self.effects() {
            if let Err(e) = effect.check(self) {
                return Err(DescriptionError::Malformed { file: file.into(), message: e.to_string() });
            }
        }
        Ok(())
    }
}

fn range(least: f64, most: f64) -> String {
    if most < f64::MAX { format!("{least} to {most}") } else { format!("a finite number, at least {least}") }
}

#[cfg(test)]
mod tests {
    use crate::{Bench, PRESETS};

    #[test]
    fn refusals_name_field_found_and_expected() {
        let (_, text) = PRESETS[0];
        for (from, to, expected) in [
            ("mass_kg = 150.0", "mass_kg = -1.0", "shaft.mass_kg is -1; expected a finite number above 0"),
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
            ("\"hybrid-as-printed\"", "\"linear\"", "contact is linear needs a coefficient, found none"),
            (
                "\"hybrid-as-printed\"",
                "\"linear\"\ncoefficient = -1.0",
                "contact: coefficient (N/m^n) is -1; expected a finite number above 0",
            ),
            (
                "shape = \"tustin\"",
                "shape = \"tustin\"\nlaw = \"lugre\"",
                "friction is lugre needs bristle_stiffness",
            ),
            (
                "shape = \"tustin\"",
                "shape = \"tustin\"\nlaw = \"coulomb\"",
                "friction: law `coulomb` jumps at rest",
            ),
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
