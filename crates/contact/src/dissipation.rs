//! Dissipation factors `chi(e)`: the share of the approach energy that a contact dissipates.
//!
//! A factor multiplies the elastic force: `F = F_el(d) (1 + chi(e) d'/d'0)`. `e` is the nominal
//! restitution; [`produced_restitution`] gives the restitution that a factor really produces. The
//! factors were compared with public implementations. Hu and Guo's, which one of them halves, was
//! compared with the exact relation (it then agrees within 6 % down to `e = 0.4`).

use crate::entry::{Entry, Group};
use crate::error::{LawError, expect};
use crate::real::Real;
use crate::restitution;

/// Published relation between nominal restitution and damping.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dissipation {
    /// No loss: `chi = 0` (Hertz).
    None,
    /// `chi = 3(1-e)/2`, Hunt and Crossley 1975.
    HuntCrossley,
    /// `chi = 6(1-e)/((2e-1)^2+3)`, Herbert and McWhannell 1977.
    HerbertMcWhannell,
    /// `chi = 3(1-e)/4`, Lee and Wang 1983.
    LeeWang,
    /// `chi = 3(1-e^2)/4`, Lankarani and Nikravesh 1990.
    LankaraniNikravesh,
    /// `chi = (1-e^2)/e`, Gonthier et al. 2004.
    Gonthier,
    /// `chi = (3/4)(1-e^2) exp(2(1-e))`, Zhiying and Qishao 2006: the factor in the paper's hybrid
    /// law.
    ZhiyingQishao,
    /// `chi = 8(1-e)/(5e)`, Flores et al. 2011.
    Flores,
    /// `chi = 3(1-e)/(2e)`, Hu and Guo 2015.
    HuGuo,
    /// `chi = (3/2)(1-e)(11-e)/(1+9e)`, Carvalho and Martins 2019.
    CarvalhoMartins,
    /// The root of `chi (1+e) = ln((1+chi)/(1-chi e))`: produces its nominal restitution.
    Exact,
}

impl Dissipation {
    /// Every factor of the catalogue, for tables and tests.
    pub const ALL: [Self; 11] = [
        Self::None,
        Self::HuntCrossley,
        Self::HerbertMcWhannell,
        Self::LeeWang,
        Self::LankaraniNikravesh,
        Self::Gonthier,
        Self::ZhiyingQishao,
        Self::Flores,
        Self::HuGuo,
        Self::CarvalhoMartins,
        Self::Exact,
    ];

    /// Returns the dimensionless factor for a nominal restitution; infinite at 0 if
    /// `needs_rebound`.
    pub fn factor<T: Real>(self, restitution: T) -> T {
        let e = restitution;
        let (one, of) = (T::ONE, T::from_f64);
        match self {
            Self::None => T::ZERO,
            Self::HuntCrossley => of(1.5) * (one - e),
            Self::HerbertMcWhannell => {
                let centred = of(2.0) * e - one;
                of(6.0) * (one - e) / (centred * centred + of(3.0))
            }
            Self::LeeWang => of(0.75) * (one - e),
            Self::LankaraniNikravesh => of(0.75) * (one - e * e),
            Self::Gonthier => (one - e * e) / e,
            Self::ZhiyingQishao => of(0.75) * (one - e * e) * (of(2.0) * (one - e)).exp(),
            Self::Flores => of(8.0) * (one - e) / (of(5.0) * e),
            Self::HuGuo => of(3.0) * (one - e) / (of(2.0) * e),
            Self::CarvalhoMartins => of(1.5) * (one - e) * (of(11.0) - e) / (one + of(9.0) * e),
            Self::Exact => of(restitution::exact_factor(e.to_f64())),
        }
    }

    /// Decides whether the factor is infinite at a restitution of 0.
    pub(crate) const fn needs_rebound(self) -> bool {
        matches!(self, Self::Gonthier | Self::Flores | Self::HuGuo | Self::Exact)
    }

    /// Checks a nominal restitution: 0 to 1, and above 0 where the factor divides by it.
    pub fn check_restitution<T: Real>(self, restitution: T) -> Result<T, LawError> {
        let e = restitution;
        let name = "restitution";
        if self.needs_rebound() {
            expect(name, e, e > T::ZERO && e <= T::ONE, "above 0, at most 1")
        } else {
            expect(name, e, e >= T::ZERO && e <= T::ONE, "0 to 1")
        }
    }

    /// Returns the factor of a name of the catalogue.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|law| law.entry().name == name)
    }

    /// Name, description, source and range.
    pub const fn entry(self) -> Entry {
        let (name, description, source) = match self {
            Self::None => ("none", "no loss", "Hertz 1881"),
            Self::HuntCrossley => ("hunt-crossley", "3(1-e)/2", "Hunt and Crossley 1975"),
            Self::HerbertMcWhannell => {
                ("herbert-mcwhannell", "6(1-e)/((2e-1)^2+3)", "Herbert and McWhannell 1977")
            }
            Self::LeeWang => ("lee-wang", "3(1-e)/4", "Lee and Wang 1983"),
            Self::LankaraniNikravesh => ("lankarani-nikravesh", "3(1-e^2)/4", "Lankarani and Nikravesh 1990"),
            Self::Gonthier => ("gonthier", "(1-e^2)/e", "Gonthier et al. 2004"),
            Self::ZhiyingQishao => ("zhiying-qishao", "(3/4)(1-e^2) exp(2(1-e))", "Zhiying and Qishao 2006"),
            Self::Flores => ("flores", "8(1-e)/(5e)", "Flores et al. 2011"),
            Self::HuGuo => ("hu-guo", "3(1-e)/(2e)", "Hu and Guo 2015"),
            Self::CarvalhoMartins => {
                ("carvalho-martins", "(3/2)(1-e)(11-e)/(1+9e)", "Carvalho and Martins 2019")
            }
            Self::Exact => {
                ("exact", "root of chi(1+e) = ln((1+chi)/(1-chi e))", "closed relation, see `restitution`")
            }
        };
        let range = match self {
            Self::None => "any restitution; the rebound is elastic",
            _ if self.needs_rebound() => "0 < e <= 1",
            _ => "0 <= e <= 1",
        };
        Entry { group: Group::Dissipation, name, description, source, range }
    }
}

/// Returns the restitution that a law `F_el(d) (1 + chi d'/d'0)` produces in a free impact. It does
/// not depend on stiffness, exponent, mass and approach speed.
///
/// Solves `chi (1 + e) = ln((1 + chi)/(1 - chi e))` for its positive root; 1 for `chi <= 0`.
/// Computed in double precision.
pub fn produced_restitution<T: Real>(factor: T) -> T {
    T::from_f64(restitution::from_factor(factor.to_f64()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn produced_restitution_matches_the_published_table() {
        for (law, at_04, at_08) in [
            (Dissipation::HuntCrossley, 0.619736, 0.832870),
            (Dissipation::LankaraniNikravesh, 0.701635, 0.847102),
            (Dissipation::LeeWang, 0.768000, 0.909016),
            (Dissipation::HerbertMcWhannell, 0.550309, 0.806980),
            (Dissipation::ZhiyingQishao, 0.398837, 0.787365),
            (Dissipation::Gonthier, 0.397787, 0.768000),
            (Dissipation::Flores, 0.362872, 0.788539),
            (Dissipation::HuGuo, 0.379646, 0.799199),
            (Dissipation::CarvalhoMartins, 0.401093, 0.799989),
            (Dissipation::Exact, 0.4, 0.8),
        ] {
            let at = |e: f64| produced_restitution(law.factor(e));
            assert!((at(0.4) - at_04).abs() < 6e-7, "{law:?} at 0.4: {}", at(0.4));
            assert!((at(0.8) - at_08).abs() < 6e-7, "{law:?} at 0.8: {}", at(0.8));
        }
        assert_eq!(produced_restitution(0.0), 1.0);
    }

    #[test]
    fn hu_and_guo_is_close_to_the_exact_relation_and_half_of_it_is_not() {
        let factor: f64 = Dissipation::HuGuo.factor(0.4);
        assert!((produced_restitution(factor) / 0.4 - 1.0).abs() < 0.06);
        assert!((produced_restitution(0.5 * factor) / 0.4 - 1.0).abs() > 0.4);
    }

    #[test]
    fn a_restitution_of_zero_is_refused_where_the_factor_divides_by_it() {
        for law in Dissipation::ALL {
            assert_eq!(law.check_restitution(0.0).is_err(), law.needs_rebound(), "{law:?}");
            assert_eq!(law.factor(0.0_f64).is_finite(), !law.needs_rebound(), "{law:?}");
            assert!(law.check_restitution(1.01).is_err() && law.check_restitution(f64::NAN).is_err());
            assert!(law.check_restitution(1.0).is_ok());
        }
    }

    proptest! {
        #[test]
        fn factors_fall_to_zero_as_the_impact_becomes_elastic(low in 0.05..0.99_f64, step in 0.0..0.01_f64) {
            for law in Dissipation::ALL {
                prop_assert!(law.factor(low + step) <= law.factor(low), "{:?}", law);
                prop_assert_eq!(law.factor(1.0), 0.0);
            }
        }
    }
}
