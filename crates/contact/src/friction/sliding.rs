//! Friction laws without memory: `F = -N mu(v) sgn v` with different regularisations.
//!
//! Coefficient `mu` for `v > 0`, and what it was checked against:
//!
//! * **Coulomb**: `mu_c`, and 0 at standstill. Public code.
//! * **Regularised linear**: `mu_c min(v/v_1, 1)`. Follows from its description.
//! * **Ambrosio**: 0 up to `v_0`, linear to `mu_c` at `v_1`. Not confirmed.
//! * **Threlfall**: `mu_c (1 - exp(-3 v/v_1))/(1 - exp(-3))` up to `v_1`, then `mu_c`. Not
//!   confirmed.
//! * **Bengisu-Akay**: `mu_s (1 - (v/v_1 - 1)^2)` up to `v_1`, then
//!   `mu_c + (mu_s - mu_c) exp(-(v - v_1)/v_s)`. Not confirmed.
//! * **Brown-McPhee**: `mu_c tanh(4 r) + (mu_s - mu_c) r/(r^2/4 + 3/4)^2` with `r = v/v_1`. The
//!   force has a further part `c v tanh(4 N/N_t)`, `c` in N s/m: beyond `N_t` it does not depend on
//!   the normal force. Public sources and code. The static part peaks at `v_1`, as its authors
//!   meant.
//! * **Stribeck**: [`FrictionLaw`]. The paper and public code.
//!
//! Ambrosio (2003), Threlfall (1978) and Bengisu and Akay (1994) are quoted from memory of later
//! reviews: neither their texts nor an implementation was found. Threlfall's denominator is printed
//! as 0.95, the rounded `1 - exp(-3)`, which leaves a step of .02 % at `v_1`; here the exact value
//! removes it. Bengisu and Akay write the exponent as `xi (v - v_1)`; `v_s` is `1/xi`.
//!
//! All are odd in `v`, dissipate at every speed and tend to Coulomb's law as their speeds tend to 0
//! (tested). None carries a load at standstill: a regularised law creeps. For sticking use a law
//! with a state.

use super::{FrictionLaw, StribeckShape};
use crate::error::{LawError, above_zero, at_least_zero, expect};
use crate::friction::FrictionKind;
use crate::real::Real;

/// Friction law without memory. Coefficients dimensionless, speeds in m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SlidingLaw<T = f64> {
    /// Coulomb, discontinuous.
    Coulomb(SlidingParameters<T>),
    /// Coulomb with a linear ramp up to `full_speed_m_s`.
    RegularisedLinear(SlidingParameters<T>),
    /// Ambrosio 2003.
    Ambrosio(SlidingParameters<T>),
    /// Threlfall 1978.
    Threlfall(SlidingParameters<T>),
    /// Bengisu and Akay 1994.
    BengisuAkay(SlidingParameters<T>),
    /// Brown and McPhee 2016.
    BrownMcPhee(SlidingParameters<T>),
    /// Stribeck, Tustin or Gauss.
    Stribeck(FrictionLaw<T>),
}

/// Parameters of the laws without memory; each uses those of its formula and ignores the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlidingParameters<T = f64> {
    /// `mu_c`, 0 or more.
    pub coulomb_coefficient: T,
    /// `mu_s`, at least `mu_c`.
    pub static_coefficient: T,
    /// `v_0` of Ambrosio's law: no friction below, 0 or more.
    pub still_speed_m_s: T,
    /// `v_1`, where friction is fully developed: above 0 and above `v_0`. The width of the sign
    /// function in Stribeck's law.
    pub full_speed_m_s: T,
    /// `v_s`, over which the static coefficient decays, above 0.
    pub stribeck_speed_m_s: T,
    /// `k` of Stribeck's law in s/m, 0 or more: slope of the coefficient over the speed.
    pub viscous_slope_s_m: T,
    /// `c` of Brown and McPhee in N s/m, 0 or more: slope of the force over the speed.
    pub viscous_damping_n_s_m: T,
    /// `N_t` of Brown and McPhee in N, above 0.
    pub transition_force_n: T,
}

impl<T: Real> SlidingParameters<T> {
    fn check(&self) -> Result<(), LawError> {
        at_least_zero("Coulomb coefficient", self.coulomb_coefficient)?;
        let holds = self.static_coefficient >= self.coulomb_coefficient;
        expect("static coefficient", self.static_coefficient, holds, "at least the Coulomb coefficient")?;
        at_least_zero("still speed (m/s)", self.still_speed_m_s)?;
        let holds = self.full_speed_m_s > self.still_speed_m_s;
        expect("full speed (m/s)", self.full_speed_m_s, holds, "above the still speed")?;
        above_zero("Stribeck speed (m/s)", self.stribeck_speed_m_s)?;
        at_least_zero("viscous slope (s/m)", self.viscous_slope_s_m)?;
        at_least_zero("viscous damping (N s/m)", self.viscous_damping_n_s_m)?;
        above_zero("transition force (N)", self.transition_force_n)?;
        Ok(())
    }
}

impl<T: Real> SlidingLaw<T> {
    /// Builds a law without memory after checking its parameters.
    pub fn new(kind: FrictionKind, parameters: SlidingParameters<T>) -> Result<Self, LawError> {
        parameters.check()?;
        let stribeck = |shape| {
            Self::Stribeck(FrictionLaw {
                coulomb_coefficient: parameters.coulomb_coefficient,
                static_coefficient: parameters.static_coefficient,
                stribeck_speed_m_s: parameters.stribeck_speed_m_s,
                shape,
                viscous_slope_s_m: parameters.viscous_slope_s_m,
                viscous_onset_m_s: T::ZERO,
                regularisation_m_s: parameters.full_speed_m_s,
            })
        };
        Ok(match kind {
            FrictionKind::Coulomb => Self::Coulomb(parameters),
            FrictionKind::RegularisedLinear => Self::RegularisedLinear(parameters),
            FrictionKind::Ambrosio => Self::Ambrosio(parameters),
            FrictionKind::Threlfall => Self::Threlfall(parameters),
            FrictionKind::BengisuAkay => Self::BengisuAkay(parameters),
            FrictionKind::BrownMcPhee => Self::BrownMcPhee(parameters),
            FrictionKind::StribeckTustin => stribeck(StribeckShape::Tustin),
            FrictionKind::StribeckGauss => stribeck(StribeckShape::Gauss),
            // A law with memory has its own type.
            _ => return Err(LawError::UnknownName { group: "memoryless friction" }),
        })
    }

    /// Builds the law without memory of a name of the catalogue.
    pub fn from_name(name: &str, parameters: SlidingParameters<T>) -> Result<Self, LawError> {
        let kind = FrictionKind::from_name(name).ok_or(LawError::UnknownName { group: "friction" })?;
        Self::new(kind, parameters)
    }

    /// Friction force in N along the sliding direction: opposed to the sliding speed.
    pub fn force_n(&self, normal_force_n: T, sliding_speed_m_s: T) -> T {
        let v = sliding_speed_m_s;
        let (one, of) = (T::ONE, T::from_f64);
        let p = match self {
            Self::Stribeck(law) => return law.force_n(normal_force_n, v),
            Self::Coulomb(p)
            | Self::RegularisedLinear(p)
            | Self::Ambrosio(p)
            | Self::Threlfall(p)
            | Self::BengisuAkay(p)
            | Self::BrownMcPhee(p) => p,
        };
        let (speed, ratio) = (v.abs(), v.abs() / p.full_speed_m_s);
        let coefficient = match self {
            Self::Coulomb(_) | Self::Stribeck(_) => p.coulomb_coefficient,
            Self::RegularisedLinear(_) => p.coulomb_coefficient * ratio.min(one),
            Self::Ambrosio(_) => {
                let ramp = (speed - p.still_speed_m_s) / (p.full_speed_m_s - p.still_speed_m_s);
                p.coulomb_coefficient * ramp.max(T::ZERO).min(one)
            }
            Self::Threlfall(_) => {
                let developed = |ratio: T| one - (of(-3.0) * ratio).exp();
                p.coulomb_coefficient * developed(ratio.min(one)) / developed(one)
            }
            Self::BengisuAkay(_) if ratio <= one => {
                p.static_coefficient * (one - (ratio - one) * (ratio - one))
            }
            Self::BengisuAkay(_) => {
                let decay = (-(speed - p.full_speed_m_s) / p.stribeck_speed_m_s).exp();
                p.coulomb_coefficient + (p.static_coefficient - p.coulomb_coefficient) * decay
            }
            Self::BrownMcPhee(_) => {
                let width = of(0.25) * ratio * ratio + of(0.75);
                p.coulomb_coefficient * (of(4.0) * ratio).tanh()
                    + (p.static_coefficient - p.coulomb_coefficient) * ratio / (width * width)
            }
        };
        let viscous = match self {
            Self::BrownMcPhee(_) => {
                p.viscous_damping_n_s_m * speed * (of(4.0) * normal_force_n / p.transition_force_n).tanh()
            }
            _ => T::ZERO,
        };
        -(coefficient * normal_force_n + viscous) * v.sign()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const KINDS: [FrictionKind; 8] = [
        FrictionKind::Coulomb,
        FrictionKind::RegularisedLinear,
        FrictionKind::Ambrosio,
        FrictionKind::Threlfall,
        FrictionKind::BengisuAkay,
        FrictionKind::BrownMcPhee,
        FrictionKind::StribeckTustin,
        FrictionKind::StribeckGauss,
    ];

    const PARAMETERS: SlidingParameters = SlidingParameters {
        coulomb_coefficient: 0.15,
        static_coefficient: 0.25,
        still_speed_m_s: 1e-4,
        full_speed_m_s: 1e-3,
        stribeck_speed_m_s: 0.01,
        viscous_slope_s_m: 0.1,
        viscous_damping_n_s_m: 250.0,
        transition_force_n: 100.0,
    };

    fn law(kind: FrictionKind) -> SlidingLaw {
        SlidingLaw::new(kind, PARAMETERS).unwrap()
    }

    #[test]
    fn each_law_is_developed_where_it_says() {
        let at = |kind, v: f64| -law(kind).force_n(1000.0, v);
        assert_eq!(at(FrictionKind::RegularisedLinear, 0.5e-3), 75.0);
        assert_eq!(at(FrictionKind::Ambrosio, 0.9e-4), 0.0);
        assert!((at(FrictionKind::Ambrosio, 0.55e-3) - 75.0).abs() < 1e-9);
        assert!((at(FrictionKind::Threlfall, 1e-3) - 150.0).abs() < 1e-9);
        assert!((at(FrictionKind::Threlfall, 0.999_999e-3) - 150.0).abs() < 1e-3);
        assert_eq!(at(FrictionKind::BengisuAkay, 1e-3), 250.0);
        assert!((at(FrictionKind::BengisuAkay, 1.000_001e-3) - 250.0).abs() < 1e-3);
        assert!((at(FrictionKind::BengisuAkay, 0.011) - (150.0 + 100.0 * (-1.0_f64).exp())).abs() < 1e-9);
        // At v = v_1 Brown and McPhee's width is 1, so both coefficients appear in full.
        let expected = 150.0 * 4.0_f64.tanh() + 100.0 + 250.0 * 1e-3 * 40.0_f64.tanh();
        assert!((at(FrictionKind::BrownMcPhee, 1e-3) - expected).abs() < 1e-9);
        let expected = 150.0 * 8.0_f64.tanh() + 100.0 * 2.0 / (1.75 * 1.75) + 250.0 * 2e-3 * 40.0_f64.tanh();
        assert!((at(FrictionKind::BrownMcPhee, 2e-3) - expected).abs() < 1e-9);
    }

    #[test]
    fn the_viscous_part_of_brown_and_mcphee_is_a_force_that_develops_over_the_transition_force() {
        let parameters = SlidingParameters { transition_force_n: 400.0, ..PARAMETERS };
        let law = |viscous_damping_n_s_m| {
            let parameters = SlidingParameters { viscous_damping_n_s_m, ..parameters };
            SlidingLaw::new(FrictionKind::BrownMcPhee, parameters).unwrap()
        };
        let viscous_n = |n| law(0.0).force_n(n, 0.5) - law(250.0).force_n(n, 0.5);
        // 250 N s/m at .5 m/s: 125 N, whatever the normal force is beyond the transition.
        assert!((viscous_n(100.0) - 125.0 * 1.0_f64.tanh()).abs() < 1e-9);
        assert!((viscous_n(1e4) - 125.0).abs() < 1e-9 && (viscous_n(1e5) - 125.0).abs() < 1e-9);
        // The slope of the other laws is not part of it.
        let steep = SlidingParameters { viscous_slope_s_m: 10.0, viscous_damping_n_s_m: 250.0, ..parameters };
        let steep = SlidingLaw::new(FrictionKind::BrownMcPhee, steep).unwrap();
        assert_eq!(steep.force_n(1e4, 0.5), law(250.0).force_n(1e4, 0.5));
    }

    #[test]
    fn bad_figures_and_laws_with_memory_are_refused() {
        let bad = [
            SlidingParameters { coulomb_coefficient: -0.1, ..PARAMETERS },
            SlidingParameters { static_coefficient: 0.1, ..PARAMETERS },
            SlidingParameters { still_speed_m_s: 1e-3, ..PARAMETERS },
            SlidingParameters { full_speed_m_s: f64::NAN, ..PARAMETERS },
            SlidingParameters { stribeck_speed_m_s: 0.0, ..PARAMETERS },
            SlidingParameters { viscous_damping_n_s_m: -1.0, ..PARAMETERS },
        ];
        for parameters in bad {
            assert!(SlidingLaw::new(FrictionKind::Ambrosio, parameters).is_err());
        }
        assert!(SlidingLaw::from_name("lugre", PARAMETERS).is_err());
        assert!(SlidingLaw::from_name("slippery", PARAMETERS).is_err());
        assert!(SlidingLaw::from_name("stribeck-gauss", PARAMETERS).is_ok());
    }

    proptest! {
        #[test]
        fn friction_is_odd_and_never_drives(n in 0.0..1e5_f64, v in -1.0..1.0_f64) {
            for kind in KINDS {
                let law = law(kind);
                prop_assert!(law.force_n(n, v) * v <= 0.0, "{:?}", kind);
                prop_assert_eq!(law.force_n(n, v), -law.force_n(n, -v), "{:?}", kind);
                prop_assert_eq!(law.force_n(n, 0.0), 0.0);
            }
        }

        #[test]
        fn every_law_tends_to_coulombs_law(v in 1e-3..1.0_f64, n in 1.0..1e5_f64) {
            let parameters = SlidingParameters {
                still_speed_m_s: 1e-9,
                full_speed_m_s: 1e-8,
                stribeck_speed_m_s: 1e-6,
                viscous_slope_s_m: 0.0,
                viscous_damping_n_s_m: 0.0,
                ..PARAMETERS
            };
            for kind in KINDS {
                let law = SlidingLaw::new(kind, parameters).unwrap();
                prop_assert!((law.force_n(n, v) / (-0.15 * n) - 1.0).abs() < 1e-9, "{:?}", kind);
            }
        }
    }
}
