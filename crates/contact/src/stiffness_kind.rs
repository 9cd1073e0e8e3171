//! Stiffness parts by name, and their checked construction from a joint.

use crate::entry::{Entry, Group};
use crate::error::{LawError, above_zero, needed};
use crate::joint::Joint;
use crate::logarithmic::{Logarithmic, LogarithmicKind};
use crate::real::Real;
use crate::stiffness::{Stiffness, hertz_sphere_in_sphere};

/// Kind of a stiffness part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StiffnessKind {
    /// [`Stiffness::Linear`].
    Linear,
    /// [`Stiffness::Hertz`].
    Hertz,
    /// [`Stiffness::Power`].
    Power,
    /// [`Stiffness::HybridAsPrinted`].
    HybridAsPrinted,
    /// [`Stiffness::LiuTimesLength`].
    LiuTimesLength,
    /// `Stiffness::pereira`.
    Pereira,
    /// [`Stiffness::Logarithmic`].
    Logarithmic(LogarithmicKind),
}

/// Parameters of the stiffness parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StiffnessParameters<T = f64> {
    /// Geometry and materials.
    pub joint: Joint<T>,
    /// `K` in N/m^n: required by `linear` and `power`, replaces the spheres' `K` in `hertz`, not
    /// used by the others.
    pub coefficient: Option<T>,
    /// `n`: required by `power` only.
    pub exponent: Option<T>,
}

impl<T> StiffnessParameters<T> {
    /// Parameters of a joint without explicit coefficient and exponent.
    pub const fn from_joint(joint: Joint<T>) -> Self {
        Self { joint, coefficient: None, exponent: None }
    }
}

impl<T: Real> Stiffness<T> {
    /// Builds the stiffness part of a name of the catalogue.
    pub fn from_name(name: &str, parameters: &StiffnessParameters<T>) -> Result<Self, LawError> {
        StiffnessKind::from_name(name).ok_or(LawError::UnknownName { group: "stiffness" })?.build(parameters)
    }
}

impl StiffnessKind {
    /// Every stiffness part.
    pub const ALL: [Self; 14] = [
        Self::Linear,
        Self::Hertz,
        Self::Power,
        Self::HybridAsPrinted,
        Self::LiuTimesLength,
        Self::Pereira,
        Self::Logarithmic(LogarithmicKind::Johnson),
        Self::Logarithmic(LogarithmicKind::Radzimovsky),
        Self::Logarithmic(LogarithmicKind::Goldsmith),
        Self::Logarithmic(LogarithmicKind::GoldsmithHalfPlane),
        Self::Logarithmic(LogarithmicKind::DubowskyFreudenstein),
        Self::Logarithmic(LogarithmicKind::DubowskyFreudensteinHalfPlane),
        Self::Logarithmic(LogarithmicKind::Esdu78035),
        Self::Logarithmic(LogarithmicKind::Esdu78035HalfPlane),
    ];

    /// Returns the kind of a name of the catalogue.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.entry().name == name)
    }

    /// Parameters that a description must give with the part, by field.
    pub const fn parameters(self) -> &'static [&'static str] {
        match self {
            Self::Linear | Self::Hertz => &["coefficient"],
            Self::Power => &["coefficient", "exponent"],
            _ => &[],
        }
    }

    /// Builds the part after checking every parameter that it uses.
    pub fn build<T: Real>(self, parameters: &StiffnessParameters<T>) -> Result<Stiffness<T>, LawError> {
        let joint = &parameters.joint;
        let own = || {
            above_zero(
                "coefficient (N/m^n)",
                needed(parameters.coefficient, self.entry().name, "a coefficient")?,
            )
        };
        match self {
            Self::Linear => return Ok(Stiffness::Linear { coefficient: own()? }),
            Self::Power => {
                let exponent = needed(parameters.exponent, self.entry().name, "an exponent")?;
                let exponent = above_zero("exponent", exponent)?;
                return Ok(Stiffness::Power { coefficient: own()?, exponent });
            }
            Self::Hertz if parameters.coefficient.is_some() => {
                return Ok(Stiffness::Hertz { coefficient: own()? });
            }
            _ => joint.check()?,
        }
        let effective_modulus_pa = joint.effective_modulus_pa();
        let radial_clearance_m = joint.radial_clearance_m;
        Ok(match self {
            Self::Linear | Self::Power | Self::Hertz => Stiffness::Hertz {
                coefficient: hertz_sphere_in_sphere(
                    joint.bearing_radius_m,
                    &joint.bearing,
                    joint.journal_radius_m(),
                    &joint.journal,
                ),
            },
            Self::HybridAsPrinted => Stiffness::HybridAsPrinted { effective_modulus_pa, radial_clearance_m },
            Self::LiuTimesLength => Stiffness::LiuTimesLength {
                effective_modulus_pa,
                radial_clearance_m,
                length_m: joint.length_m,
            },
            Self::Pereira => Stiffness::pereira(joint)?,
            Self::Logarithmic(kind) => Stiffness::Logarithmic(Logarithmic::new(kind, joint)),
        })
    }

    /// Name, description, source and range.
    pub const fn entry(self) -> Entry {
        let (name, description, source) = match self {
            Self::Linear => ("linear", "K d", "Hooke"),
            Self::Hertz => ("hertz", "K d^1.5, sphere in sphere", "Hertz 1881"),
            Self::Power => ("power", "K d^n", "general"),
            Self::HybridAsPrinted => {
                ("hybrid-as-printed", "K_n(d) d^1.5, wrong unit, as printed", "Bai and Zhao 2013")
            }
            Self::LiuTimesLength => ("liu-times-length", "L (pi/2) d E* sqrt(d/(2(D+d)))", "Liu et al. 2007"),
            Self::Pereira => ("pereira", "(a D+b) L E*/D d^n, fitted in mm", "Pereira et al. 2011"),
            Self::Logarithmic(LogarithmicKind::Johnson) => {
                ("johnson", "implicit, half-plane solution", "Johnson 1985")
            }
            Self::Logarithmic(LogarithmicKind::Radzimovsky) => {
                ("radzimovsky", "implicit", "Radzimovsky 1953")
            }
            Self::Logarithmic(LogarithmicKind::Goldsmith) => {
                ("goldsmith", "implicit, evaluated in SI", "Goldsmith 1960")
            }
            Self::Logarithmic(LogarithmicKind::GoldsmithHalfPlane) => {
                ("goldsmith-half-plane", "goldsmith with (1-nu^2)/(pi E)", "Goldsmith 1960")
            }
            Self::Logarithmic(LogarithmicKind::DubowskyFreudenstein) => {
                ("dubowsky-freudenstein", "implicit", "Dubowsky and Freudenstein 1971")
            }
            Self::Logarithmic(LogarithmicKind::DubowskyFreudensteinHalfPlane) => (
                "dubowsky-freudenstein-half-plane",
                "dubowsky-freudenstein with (1-nu^2)/(pi E)",
                "Dubowsky and Freudenstein 1971",
            ),
            Self::Logarithmic(LogarithmicKind::Esdu78035) => ("esdu-78035", "implicit", "ESDU 1978"),
            Self::Logarithmic(LogarithmicKind::Esdu78035HalfPlane) => {
                ("esdu-78035-half-plane", "esdu-78035 with (1-nu^2)/(pi E), one pi", "ESDU 1978")
            }
        };
        let range = match self {
            Self::Linear => "K > 0",
            Self::Hertz => "R_B > R_J > 0 or K > 0",
            Self::Power => "K > 0, n > 0",
            Self::HybridAsPrinted | Self::LiuTimesLength => "0 < D < R_B",
            Self::Pereira => "5 um <= D <= 10 mm",
            Self::Logarithmic(_) => "d up to its largest deformation",
        };
        Entry { group: Group::Stiffness, name, description, source, range }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BearingMaterial;
    use crate::material::Material;

    fn parameters() -> StiffnessParameters {
        StiffnessParameters::from_joint(Joint {
            bearing_radius_m: 0.07,
            radial_clearance_m: 0.5e-3,
            length_m: 0.14,
            bearing: BearingMaterial::Babbitt.elastic(),
            journal: Material::STEEL,
        })
    }

    #[test]
    fn every_name_builds_a_rising_force() {
        let parameters = StiffnessParameters { coefficient: Some(1e9), exponent: Some(1.2), ..parameters() };
        for kind in StiffnessKind::ALL {
            let law = Stiffness::from_name(kind.entry().name, &parameters).unwrap();
            let forces = [0.0, 1e-6, 1e-5, 5e-5].map(|d| law.force_n(d));
            assert!(forces.is_sorted_by(|a, b| a < b), "{kind:?}: {forces:?}");
        }
        assert_eq!(
            Stiffness::from_name("hook", &parameters),
            Err(LawError::UnknownName { group: "stiffness" })
        );
    }

    #[test]
    fn missing_and_bad_figures_are_named() {
        for kind in [StiffnessKind::Linear, StiffnessKind::Power] {
            assert!(matches!(kind.build(&parameters()), Err(LawError::Missing { .. })), "{kind:?}");
        }
        let mut bad = parameters();
        bad.joint.radial_clearance_m = 0.08;
        for kind in StiffnessKind::ALL {
            assert!(kind.build(&bad).is_err(), "{kind:?}");
        }
        let mut bad = parameters();
        bad.joint.bearing.poisson_ratio = 0.6;
        let error = StiffnessKind::Logarithmic(LogarithmicKind::Johnson).build(&bad).unwrap_err();
        assert_eq!(error.to_string(), "Poisson's ratio: found 6e-1, expected 0 to 0.5");
    }

    #[test]
    fn an_own_coefficient_replaces_the_spheres() {
        let parameters = StiffnessParameters { coefficient: Some(1e9), ..parameters() };
        assert_eq!(StiffnessKind::Hertz.build(&parameters), Ok(Stiffness::Hertz { coefficient: 1e9 }));
    }
}
