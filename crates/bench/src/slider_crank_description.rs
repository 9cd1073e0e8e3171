//! The slider-crank's description in TOML.

use crate::description::{DescriptionError, shown};
use crate::law_names::{DissipationName, StiffnessName};
use crate::slider_crank::SliderCrank;
use contact::{
    LawError, Material, NormalLaw, Stiffness, StiffnessKind, StiffnessParameters, hertz_sphere_in_sphere,
};
use serde::Deserialize;

/// The preset's text.
const PRESET: &str = include_str!("../presets/slider-crank.toml");
/// The preset's name.
pub const PRESET_NAME: &str = "slider-crank";

/// Description of a slider-crank.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SliderCrankBench {
    /// Always `slider-crank`.
    pub plant: String,
    /// Crank.
    pub crank: Crank,
    /// Rod.
    pub rod: Rod,
    /// Slider.
    pub slider: Slider,
    /// Clearance joint.
    pub joint: Joint,
}

/// The crank and its prescribed motion.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Crank {
    /// Length in m.
    pub length_m: f64,
    /// Speed in revolutions a minute.
    pub speed_rpm: f64,
    /// Length of a run in revolutions.
    pub revolutions: f64,
}

/// The rod, its centre of mass at its middle.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rod {
    /// Length in m.
    pub length_m: f64,
    /// Mass in kg.
    pub mass_kg: f64,
    /// Moment of inertia about the centre of mass in kg m2.
    pub inertia_kg_m2: f64,
}

/// The slider.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Slider {
    /// Mass in kg.
    pub mass_kg: f64,
}

/// The clearance joint between rod and slider.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Bearing radius in m.
    pub bearing_radius_m: f64,
    /// Journal radius in m, below the bearing's.
    pub journal_radius_m: f64,
    /// Young's modulus of both bodies in Pa.
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio of both bodies.
    pub poisson_ratio: f64,
    /// Nominal restitution.
    pub restitution: f64,
    /// Stiffness part; without one Hertz' sphere in sphere.
    #[serde(default)]
    pub stiffness: Option<StiffnessName>,
    /// Length of the bearing in m, which every stiffness part but Hertz' needs.
    #[serde(default)]
    pub length_m: Option<f64>,
    /// Dissipation factor.
    pub dissipation: DissipationName,
    /// Floor of the latched approach speed in m/s.
    pub latch_floor_m_s: f64,
}

impl SliderCrankBench {
    /// The preset by its name, or a description from a file; `None` if the file describes another plant.
    pub fn open(name_or_file: &str) -> Result<Option<Self>, DescriptionError> {
        if name_or_file == PRESET_NAME {
            return Self::parse(PRESET_NAME, PRESET);
        }
        match std::fs::read_to_string(name_or_file) {
            Ok(text) => Self::parse(name_or_file, &text),
            Err(_) => Ok(None),
        }
    }

    /// Parses and checks a description; `None` if the text describes another plant or is no TOML at all.
    pub fn parse(file: &str, text: &str) -> Result<Option<Self>, DescriptionError> {
        let plant = toml::from_str::<toml::Table>(text).ok();
        if plant.as_ref().and_then(|t| t.get("plant")).and_then(toml::Value::as_str) != Some("slider-crank") {
            return Ok(None);
        }
        let bench: Self = toml::from_str(text)
            .map_err(|e| DescriptionError::Malformed { file: file.into(), message: e.to_string() })?;
        bench.check(file)?;
        Ok(Some(bench))
    }

    fn check(&self, file: &str) -> Result<(), DescriptionError> {
        let most = 1e9;
        let least = 1e-9;
        for (field, value, least, most) in [
            ("rod.length_m", self.rod.length_m, 1e-6, 1e6),
            ("crank.length_m", self.crank.length_m, least, self.rod.length_m),
            ("crank.speed_rpm", self.crank.speed_rpm, 1e-3, 1e7),
            ("crank.revolutions", self.crank.revolutions, 1e-6, 1000.0),
            ("rod.mass_kg", self.rod.mass_kg, least, most),
            ("rod.inertia_kg_m2", self.rod.inertia_kg_m2, 1e-12, most),
            ("slider.mass_kg", self.slider.mass_kg, least, most),
            ("joint.bearing_radius_m", self.joint.bearing_radius_m, 1e-6, 1e3),
            (
                "joint.journal_radius_m",
                self.joint.journal_radius_m,
                least,
                0.9999 * self.joint.bearing_radius_m,
            ),
            ("joint.youngs_modulus_pa", self.joint.youngs_modulus_pa, 1e3, 1e15),
            ("joint.poisson_ratio", self.joint.poisson_ratio, 0.0, 0.5),
            ("joint.restitution", self.joint.restitution, 1e-6, 1.0),
            ("joint.latch_floor_m_s", self.joint.latch_floor_m_s, 1e-12, 1e3),
        ] {
            if !(least..=most).contains(&value) {
                return Err(DescriptionError::OutOfRange {
                    file: file.into(),
                    field: field.into(),
                    found: shown(value),
                    expected: format!("{} to {}", shown(least), shown(most)),
                });
            }
        }
        self.stiffness().map(|_| ()).map_err(|e| DescriptionError::OutOfRange {
            file: file.into(),
            field: "joint".into(),
            found: e.to_string(),
            expected: "a stiffness with its parameters in range".into(),
        })
    }

    fn stiffness(&self) -> Result<Stiffness, LawError> {
        let solid = Material {
            youngs_modulus_pa: self.joint.youngs_modulus_pa,
            poisson_ratio: self.joint.poisson_ratio,
        };
        let (bearing, journal) = (self.joint.bearing_radius_m, self.joint.journal_radius_m);
        let Some(name) = self.joint.stiffness.filter(|name| name.0 != StiffnessKind::Hertz) else {
            let coefficient = hertz_sphere_in_sphere(bearing, &solid, journal, &solid);
            return Ok(Stiffness::Hertz { coefficient });
        };
        let law = name.0.entry().name;
        let length_m = self.joint.length_m.ok_or(LawError::Missing { law, quantity: "length_m" })?;
        name.0.build(&StiffnessParameters::of(contact::Joint {
            bearing_radius_m: bearing,
            radial_clearance_m: bearing - journal,
            length_m,
            bearing: solid,
            journal: solid,
        }))
    }

    /// The plant.
    pub fn plant(&self) -> SliderCrank {
        SliderCrank {
            crank_length_m: self.crank.length_m,
            crank_speed_rad_s: self.crank.speed_rpm * core::f64::consts::PI / 30.0,
            rod_length_m: self.rod.length_m,
            rod_mass_kg: self.rod.mass_kg,
            rod_inertia_kg_m2: self.rod.inertia_kg_m2,
            slider_mass_kg: self.slider.mass_kg,
            radial_clearance_m: self.joint.bearing_radius_m - self.joint.journal_radius_m,
            normal_law: NormalLaw {
                // Checked when it was read; a law changed out of its range since gives no number.
                stiffness: self.stiffness().unwrap_or(Stiffness::Linear { coefficient: f64::NAN }),
                dissipation: self.joint.dissipation.0,
                restitution: self.joint.restitution,
                latch_floor_m_s: self.joint.latch_floor_m_s,
            },
        }
    }

    /// Length of a run in s.
    pub fn duration_s(&self) -> f64 {
        60.0 * self.crank.revolutions / self.crank.speed_rpm
    }
}

/// The published problem: the preset.
pub fn reference_problem() -> Result<SliderCrankBench, DescriptionError> {
    SliderCrankBench::parse(PRESET_NAME, PRESET)?.ok_or_else(|| DescriptionError::Malformed {
        file: PRESET_NAME.into(),
        message: "not a slider-crank".into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refusals_name_the_field_and_other_plants_are_left_alone() {
        let error =
            SliderCrankBench::parse("x", &PRESET.replace("9.5e-3", "10.5e-3")).unwrap_err().to_string();
        assert!(error.contains("joint.journal_radius_m is 0.0105; expected 1e-9 to 0.009999"), "{error}");
        let error = SliderCrankBench::parse("x", &PRESET.replace("mass_kg = 0.14", "mas = 1"))
            .unwrap_err()
            .to_string();
        assert!(error.contains("unknown field `mas`"), "{error}");
        let named = |more: &str| {
            PRESET.replace("dissipation", &format!("stiffness = \"johnson\"\n{more}\ndissipation"))
        };
        let error = SliderCrankBench::parse("x", &named("")).unwrap_err().to_string();
        assert!(error.contains("joint is johnson needs length_m, found none"), "{error}");
        let johnson = SliderCrankBench::parse("x", &named("length_m = 0.02")).unwrap().unwrap().plant();
        assert!(matches!(johnson.normal_law.stiffness, Stiffness::Logarithmic(_)));
        assert_eq!(SliderCrankBench::parse("x", "plant = \"friction-rig\"").unwrap(), None);
        assert_eq!(SliderCrankBench::parse("x", "no toml").unwrap(), None);
    }
}
