//! Complete normal laws with their own damping, and an enumeration of all normal laws.
//!
//! ADAMS IMPACT: `F = max(k d^n + STEP(d; 0, 0, d_max, c_max) d', 0)`. The step is the cubic `c_max
//! s^2 (3 - 2 s)`, `s = d/d_max` clamped to 0..1, so the damping starts without a jump. Deformation
//! in m, rates in m/s, force in N, never negative.

use crate::entry::{Entry, Group};
use crate::error::{LawError, above_zero, at_least_zero, needed};
use crate::normal::{FactorisedLaw, NormalLaw};
use crate::real::Real;
use crate::spring_dashpot::SpringDashpot;
use crate::stiffness::Stiffness;

/// IMPACT function of ADAMS.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdamsImpact<T = f64> {
    coefficient: T,
    exponent: T,
    full_damping_n_s_m: T,
    full_damping_depth_m: T,
}

impl<T: Real> AdamsImpact<T> {
    /// `k` in N/m^n above 0, `n` above 0, `c_max` in N s/m, `d_max` in m above 0.
    pub fn new(
        coefficient: T,
        exponent: T,
        full_damping_n_s_m: T,
        full_damping_depth_m: T,
    ) -> Result<Self, LawError> {
        above_zero("coefficient (N/m^n)", coefficient)?;
        above_zero("exponent", exponent)?;
        at_least_zero("full damping (N s/m)", full_damping_n_s_m)?;
        above_zero("depth of full damping (m)", full_damping_depth_m)?;
        Ok(Self { coefficient, exponent, full_damping_n_s_m, full_damping_depth_m })
    }

    /// Elastic part.
    pub fn elastic(&self) -> Stiffness<T> {
        Stiffness::Power { coefficient: self.coefficient, exponent: self.exponent }
    }

    /// Normal force in N, never negative.
    pub fn force_n(&self, deformation_m: T, rate_m_s: T) -> T {
        if deformation_m <= T::ZERO {
            return T::ZERO;
        }
        let share = (deformation_m / self.full_damping_depth_m).min(T::ONE);
        let damping = self.full_damping_n_s_m * share * share * (T::from_f64(3.0) - T::from_f64(2.0) * share);
        (self.coefficient * deformation_m.powf(self.exponent) + damping * rate_m_s).max(T::ZERO)
    }
}

/// Any normal law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContactLaw<T = f64> {
    /// Stiffness times dissipation factor.
    Factorised(FactorisedLaw<T>),
    /// Kelvin-Voigt or Anagnostopoulos.
    SpringDashpot(SpringDashpot<T>),
    /// IMPACT.
    AdamsImpact(AdamsImpact<T>),
}

impl<T: Real> ContactLaw<T> {
    /// Normal force in N, never negative. Only factorised laws with a latch use the latched rate.
    pub fn force_n(&self, deformation_m: T, rate_m_s: T, latched_rate_m_s: T) -> T {
        match self {
            Self::Factorised(law) => law.force_n(deformation_m, rate_m_s, latched_rate_m_s),
            Self::SpringDashpot(law) => law.force_n(deformation_m, rate_m_s),
            Self::AdamsImpact(law) => law.force_n(deformation_m, rate_m_s),
        }
    }

    /// Elastic part, whose work a contact stores.
    pub fn elastic(&self) -> Stiffness<T> {
        match self {
            Self::Factorised(law) => *law.stiffness(),
            Self::SpringDashpot(law) => law.elastic(),
            Self::AdamsImpact(law) => law.elastic(),
        }
    }

    /// Largest deformation in m for which the law is valid, if there is one.
    pub fn largest_deformation_m(&self) -> Option<T> {
        match self {
            Self::Factorised(law) => law.stiffness().largest_deformation_m(),
            Self::SpringDashpot(_) | Self::AdamsImpact(_) => None,
        }
    }
}

impl<T: Real> From<NormalLaw<T>> for ContactLaw<T> {
    fn from(law: NormalLaw<T>) -> Self {
        Self::Factorised(law.into())
    }
}

/// Parameters of the complete laws; each requires those of its formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompleteLawParameters<T = f64> {
    /// `K` in N/m, or `k` in N/m^n.
    pub coefficient: T,
    /// `n` of IMPACT.
    pub exponent: Option<T>,
    /// `c` of Kelvin-Voigt, `c_max` of IMPACT, in N s/m.
    pub damping_n_s_m: Option<T>,
    /// `d_max` of IMPACT in m.
    pub full_damping_depth_m: Option<T>,
    /// `e` of Anagnostopoulos.
    pub restitution: Option<T>,
    /// `m` of Anagnostopoulos in kg.
    pub effective_mass_kg: Option<T>,
}

/// Kind of a complete law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CompleteLawKind {
    /// [`SpringDashpot::kelvin_voigt`].
    KelvinVoigt,
    /// [`SpringDashpot::anagnostopoulos`].
    Anagnostopoulos,
    /// [`AdamsImpact`].
    AdamsImpact,
}

impl CompleteLawKind {
    /// Every complete law.
    pub const ALL: [Self; 3] = [Self::KelvinVoigt, Self::Anagnostopoulos, Self::AdamsImpact];

    /// Parameters of the law that a description gives with it, by field. Restitution and mass
    /// belong to the bearing.
    pub const fn parameters(self) -> &'static [&'static str] {
        match self {
            Self::KelvinVoigt => &["coefficient", "damping_n_s_m"],
            Self::Anagnostopoulos => &["coefficient"],
            Self::AdamsImpact => &["coefficient", "exponent", "damping_n_s_m", "full_damping_depth_m"],
        }
    }

    /// Builds the law after checking every parameter that it uses.
    pub fn build<T: Real>(self, parameters: &CompleteLawParameters<T>) -> Result<ContactLaw<T>, LawError> {
        let need = |value: Option<T>, quantity| needed(value, self.entry().name, quantity);
        let coefficient = parameters.coefficient;
        Ok(match self {
            Self::KelvinVoigt => ContactLaw::SpringDashpot(SpringDashpot::kelvin_voigt(
                coefficient,
                need(parameters.damping_n_s_m, "a damping (N s/m)")?,
            )?),
            Self::Anagnostopoulos => ContactLaw::SpringDashpot(SpringDashpot::anagnostopoulos(
                coefficient,
                need(parameters.restitution, "a restitution")?,
                need(parameters.effective_mass_kg, "an effective mass (kg)")?,
            )?),
            Self::AdamsImpact => ContactLaw::AdamsImpact(AdamsImpact::new(
                coefficient,
                need(parameters.exponent, "an exponent")?,
                need(parameters.damping_n_s_m, "a damping (N s/m)")?,
                need(parameters.full_damping_depth_m, "a depth of full damping (m)")?,
            )?),
        })
    }

    /// Returns the kind of a name of the catalogue.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.entry().name == name)
    }

    /// Name, description, source and range.
    pub const fn entry(self) -> Entry {
        let (name, description, source, range) = match self {
            Self::KelvinVoigt => {
                ("kelvin-voigt", "K d + c d', no tension", "Kelvin and Voigt", "K > 0, c >= 0")
            }
            Self::Anagnostopoulos => (
                "anagnostopoulos",
                "K d + 2 zeta(e) sqrt(K m) d', no tension",
                "Anagnostopoulos 1988, 2004",
                "0 < e <= 1, m > 0",
            ),
            Self::AdamsImpact => (
                "adams-impact",
                "max(k d^n + STEP(d; 0, 0, d_max, c_max) d', 0)",
                "MSC ADAMS, IMPACT function",
                "k, n, d_max > 0, c_max >= 0",
            ),
        };
        Entry { group: Group::Complete, name, description, source, range }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dissipation;

    #[test]
    fn impact_damping_rises_as_the_cubic_step_and_stays() {
        let law = AdamsImpact::new(1e8, 1.5, 1e3, 1e-5).unwrap();
        let damping = |d: f64| (law.force_n(d, 1e-3) - law.force_n(d, 0.0)) / 1e-3;
        assert!((damping(5e-6) - 500.0).abs() < 1e-6);
        assert!((damping(2.5e-6) - 1e3 * 0.15625).abs() < 1e-6);
        assert!((damping(2e-5) - 1e3).abs() < 1e-6);
        assert_eq!(law.force_n(1e-5, -1e3), 0.0);
        assert_eq!(law.force_n(-1e-5, 1.0), 0.0);
        assert!(AdamsImpact::new(1e8, 1.5, 1e3, 0.0).is_err());
    }

    #[test]
    fn every_name_builds_from_its_own_figures_and_names_what_is_missing() {
        let parameters = CompleteLawParameters {
            coefficient: 1e8,
            exponent: Some(1.5),
            damping_n_s_m: Some(1e3),
            full_damping_depth_m: Some(1e-5),
            restitution: Some(0.4),
            effective_mass_kg: Some(2.0),
        };
        for kind in CompleteLawKind::ALL {
            assert!(kind.build(&parameters).unwrap().force_n(1e-5, 0.0, 0.0) > 0.0, "{kind:?}");
        }
        let none = CompleteLawParameters { restitution: None, damping_n_s_m: None, ..parameters };
        for (kind, message) in [
            (CompleteLawKind::KelvinVoigt, "kelvin-voigt needs a damping (N s/m), found none"),
            (CompleteLawKind::Anagnostopoulos, "anagnostopoulos needs a restitution, found none"),
            (CompleteLawKind::AdamsImpact, "adams-impact needs a damping (N s/m), found none"),
        ] {
            assert_eq!(kind.build(&none).unwrap_err().to_string(), message);
        }
    }

    #[test]
    fn the_sum_passes_its_arguments_on() {
        let normal =
            NormalLaw::new(Stiffness::Hertz { coefficient: 1e9 }, Dissipation::Flores, 0.5, 1e-3).unwrap();
        assert_eq!(ContactLaw::from(normal).force_n(1e-5, 0.01, 0.1), normal.force_n(1e-5, 0.01, 0.1));
        let spring = SpringDashpot::kelvin_voigt(1e7, 1e3).unwrap();
        let law = ContactLaw::SpringDashpot(spring);
        assert_eq!(law.force_n(1e-5, 0.01, 9.0), spring.force_n(1e-5, 0.01));
        assert_eq!(law.largest_deformation_m(), None);
    }
}
