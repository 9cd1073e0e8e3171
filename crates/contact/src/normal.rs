//! Normal contact law: stiffness times dissipation.
//!
//! [`NormalLaw`] latches the approach speed, as the literature prints it; [`FactorisedLaw`] is the
//! same with selectable damping. Deformation in m, rates in m/s, force in N, never negative: a dry
//! surface cannot pull.

use crate::damping::Damping;
use crate::dissipation::Dissipation;
use crate::error::{LawError, above_zero};
use crate::real::Real;
use crate::stiffness::Stiffness;

/// `F = F_el(d) (1 + chi(e) d'/max(d'0, floor))`, clamped at 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalLaw<T = f64> {
    /// Elastic part.
    pub stiffness: Stiffness<T>,
    /// Dissipation factor.
    pub dissipation: Dissipation,
    /// Nominal restitution, `0 < e <= 1`.
    pub restitution: T,
    /// Floor of the latched approach speed in m/s, above 0; see [`crate::DEFAULT_LATCH_FLOOR_M_S`].
    pub latch_floor_m_s: T,
}

impl<T: Real> NormalLaw<T> {
    /// Creates a law after checking restitution and floor.
    pub fn new(
        stiffness: Stiffness<T>,
        dissipation: Dissipation,
        restitution: T,
        latch_floor_m_s: T,
    ) -> Result<Self, LawError> {
        dissipation.check_restitution(restitution)?;
        above_zero("latch floor (m/s)", latch_floor_m_s)?;
        Ok(Self { stiffness, dissipation, restitution, latch_floor_m_s })
    }

    /// Normal force in N, never negative.
    ///
    /// `deformation_m` is positive in contact, `rate_m_s` its derivative, `latched_rate_m_s` the
    /// rate at onset.
    pub fn force_n(&self, deformation_m: T, rate_m_s: T, latched_rate_m_s: T) -> T {
        let ratio = rate_m_s / latched_rate_m_s.max(self.latch_floor_m_s);
        let factor = T::ONE + self.dissipation.factor(self.restitution) * ratio;
        (self.stiffness.force_n(deformation_m) * factor).max(T::ZERO)
    }
}

/// `F = F_el(d) (1 + chi q)`, clamped at 0, with the ratio `q` of a [`Damping`]; the factor is
/// computed once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FactorisedLaw<T = f64> {
    stiffness: Stiffness<T>,
    factor: T,
    damping: Damping<T>,
}

impl<T: Real> FactorisedLaw<T> {
    /// Creates a law after checking restitution and floor or reference speed.
    pub fn new(
        stiffness: Stiffness<T>,
        dissipation: Dissipation,
        restitution: T,
        damping: Damping<T>,
    ) -> Result<Self, LawError> {
        damping.check()?;
        let factor = dissipation.factor(dissipation.check_restitution(restitution)?);
        Ok(Self { stiffness, factor, damping })
    }

    /// Elastic part.
    pub fn stiffness(&self) -> &Stiffness<T> {
        &self.stiffness
    }

    /// Damping of the law.
    pub fn damping(&self) -> &Damping<T> {
        &self.damping
    }

    /// Normal force in N, never negative; the arguments are those of [`NormalLaw::force_n`].
    pub fn force_n(&self, deformation_m: T, rate_m_s: T, latched_rate_m_s: T) -> T {
        let factor = T::ONE + self.factor * self.damping.rate_ratio(rate_m_s, latched_rate_m_s);
        (self.stiffness.force_n(deformation_m) * factor).max(T::ZERO)
    }
}

impl<T: Real> From<NormalLaw<T>> for FactorisedLaw<T> {
    /// Converts the same law without checking its parameters.
    fn from(law: NormalLaw<T>) -> Self {
        Self {
            stiffness: law.stiffness,
            factor: law.dissipation.factor(law.restitution),
            damping: Damping::Latched { floor_m_s: law.latch_floor_m_s },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damping::DEFAULT_LATCH_FLOOR_M_S;
    use proptest::prelude::*;

    const ELASTIC: Stiffness =
        Stiffness::HybridAsPrinted { effective_modulus_pa: 4e10, radial_clearance_m: 2.5e-4 };

    fn factorised(damping: Damping) -> FactorisedLaw {
        FactorisedLaw::new(ELASTIC, Dissipation::ZhiyingQishao, 0.4, damping).unwrap()
    }

    #[test]
    fn bad_figures_are_refused() {
        let law = |e, floor| NormalLaw::new(ELASTIC, Dissipation::Flores, e, floor);
        assert!(law(0.4, 1e-3).is_ok());
        assert!(law(0.0, 1e-3).is_err() && law(1.1, 1e-3).is_err());
        assert!(law(0.4, 0.0).is_err() && law(0.4, f64::NAN).is_err());
        assert!(Damping::from_name("reference", 0.0).is_err());
        assert_eq!(
            Damping::from_name("latch", 1.0),
            Err::<Damping, _>(LawError::UnknownName { group: "damping" })
        );
        for name in Damping::<f64>::NAMES {
            assert!(Damping::from_name(name, 1e-3).is_ok());
        }
    }

    #[test]
    fn a_latched_law_jumps_with_its_onset_and_a_reference_law_does_not() {
        let latched = factorised(Damping::Latched { floor_m_s: 1e-3 });
        let reference = factorised(Damping::Reference { speed_m_s: 0.1 });
        let (slow, fast) = (1e-3, 0.1);
        let at = |law: &FactorisedLaw, onset| law.force_n(2e-5, 1e-3, onset);
        assert!(at(&latched, slow) > 2.0 * at(&latched, fast));
        assert_eq!(at(&reference, slow), at(&reference, fast));
    }

    #[test]
    fn the_reference_law_is_the_latched_one_at_its_speed() {
        let latched = factorised(Damping::Latched { floor_m_s: 1e-3 });
        let reference = factorised(Damping::Reference { speed_m_s: 0.1 });
        let ratio = |law: &FactorisedLaw, speed| law.damping().rate_ratio(speed, speed);
        assert_eq!(ratio(&latched, 0.1), ratio(&reference, 0.1));
        assert_eq!(ratio(&latched, 1.0), ratio(&latched, 0.1));
        assert!((ratio(&reference, 0.01) - 0.1).abs() < 1e-12);
        assert!(ratio(&reference, 0.2) > ratio(&reference, 0.1));
    }

    proptest! {
        #[test]
        fn force_never_pulls_and_vanishes_without_contact(
            d in -1e-3..1e-3_f64, rate in -1.0..1.0_f64, latched in -1.0..1.0_f64, e in 0.05..1.0_f64,
        ) {
            let law = NormalLaw {
                stiffness: ELASTIC,
                dissipation: Dissipation::ZhiyingQishao,
                restitution: e,
                latch_floor_m_s: DEFAULT_LATCH_FLOOR_M_S,
            };
            let force = law.force_n(d, rate, latched);
            prop_assert!(force >= 0.0 && force.is_finite());
            if d <= 0.0 { prop_assert_eq!(force, 0.0); }
            let factorised = FactorisedLaw::from(law);
            prop_assert_eq!(factorised.force_n(d, rate, latched), force, "the default is unchanged");
        }

        #[test]
        fn sustained_contact_is_bounded_and_continuous(rate in -0.02..0.02_f64, onset in 0.0..5e-3_f64) {
            let elastic = ELASTIC.force_n(2e-5);
            let factor: f64 = Dissipation::ZhiyingQishao.factor(0.4);
            let bounded = factorised(Damping::Bounded { floor_m_s: 1e-3 });
            let force = bounded.force_n(2e-5, rate, onset);
            prop_assert!(force <= elastic * (1.0 + factor) * (1.0 + 1e-15));
            prop_assert!(force >= (elastic * (1.0 - factor)).max(0.0));
            // With a speed of .1 m/s, a rate 1e-6 m/s away moves the force by chi 1e-5 of the
            // elastic one.
            let reference = factorised(Damping::Reference { speed_m_s: 0.1 });
            let step = reference.force_n(2e-5, rate + 1e-6, onset) - reference.force_n(2e-5, rate, onset);
            prop_assert!(step >= 0.0 && step <= 1.01 * factor * 1e-5 * elastic);
        }

        #[test]
        fn the_bound_changes_no_free_impact(q in -1.0..1.0_f64, onset in 2e-3..1.0_f64) {
            let latched = factorised(Damping::Latched { floor_m_s: 1e-3 });
            let bounded = factorised(Damping::Bounded { floor_m_s: 1e-3 });
            prop_assert_eq!(bounded.force_n(2e-5, q * onset, onset), latched.force_n(2e-5, q * onset, onset));
        }
    }
}
