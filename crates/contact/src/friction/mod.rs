//! Dry friction. Sliding speeds in m/s, forces in N along the sliding direction, so that friction
//! has the opposite sign.
//!
//! Laws without memory are functions of normal force and speed: [`FrictionLaw`], [`SlidingLaw`].
//! Those with memory have a state that the caller keeps, so that an integrator can step it and a
//! run can be repeated: [`Karnopp`], [`Dahl`], [`LuGre`], [`SevenParameter`]. All scale with the
//! normal force, which varies on a bench: stiffness and damping of the bristles are given per
//! newton of it.

mod dahl;
mod karnopp;
mod lugre;
mod seven_parameter;
mod sliding;
mod stribeck;

pub use dahl::Dahl;
pub use karnopp::{Karnopp, KarnoppState};
pub use lugre::LuGre;
pub use seven_parameter::{SevenParameter, SevenParameterState};
pub use sliding::{SlidingLaw, SlidingParameters};
pub use stribeck::{FrictionLaw, StribeckShape};

use crate::entry::{Entry, Group};

/// Kind of a friction law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FrictionKind {
    /// [`SlidingLaw::Coulomb`].
    Coulomb,
    /// [`SlidingLaw::RegularisedLinear`].
    RegularisedLinear,
    /// [`SlidingLaw::Ambrosio`].
    Ambrosio,
    /// [`SlidingLaw::Threlfall`].
    Threlfall,
    /// [`StribeckShape::Tustin`].
    StribeckTustin,
    /// [`StribeckShape::Gauss`].
    StribeckGauss,
    /// [`SlidingLaw::BengisuAkay`].
    BengisuAkay,
    /// [`SlidingLaw::BrownMcPhee`].
    BrownMcPhee,
    /// [`Karnopp`].
    Karnopp,
    /// [`Dahl`].
    Dahl,
    /// [`LuGre`].
    LuGre,
    /// [`SevenParameter`].
    SevenParameter,
}

impl FrictionKind {
    /// Every friction law.
    pub const ALL: [Self; 12] = [
        Self::Coulomb,
        Self::RegularisedLinear,
        Self::Ambrosio,
        Self::Threlfall,
        Self::StribeckTustin,
        Self::StribeckGauss,
        Self::BengisuAkay,
        Self::BrownMcPhee,
        Self::Karnopp,
        Self::Dahl,
        Self::LuGre,
        Self::SevenParameter,
    ];

    /// Returns the law of a name of the catalogue.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.entry().name == name)
    }

    /// Decides whether the law keeps a state between steps.
    pub const fn has_state(self) -> bool {
        matches!(self, Self::Dahl | Self::LuGre | Self::SevenParameter)
    }

    /// Decides whether a contact with this law sticks and slides.
    pub const fn sticks(self) -> bool {
        matches!(self, Self::Coulomb | Self::Karnopp | Self::SevenParameter)
    }

    /// Name, description, source and range.
    pub const fn entry(self) -> Entry {
        let (name, description, source, range) = match self {
            Self::Coulomb => ("coulomb", "constant, 0 at rest", "Coulomb 1785", "discontinuous at rest"),
            Self::RegularisedLinear => {
                ("regularised-linear", "linear ramp to Coulomb's", "general", "creeps at rest")
            }
            Self::Ambrosio => {
                ("ambrosio", "none up to v0, ramp to v1", "Ambrosio 2003 (recalled)", "creeps at rest")
            }
            Self::Threlfall => {
                ("threlfall", "exponential rise to Coulomb's", "Threlfall 1978 (recalled)", "creeps at rest")
            }
            Self::StribeckTustin => {
                ("stribeck-tustin", "exponential fall, exponent 1", "Tustin 1947", "creeps at rest")
            }
            Self::StribeckGauss => {
                ("stribeck-gauss", "exponential fall, exponent 2", "Bo and Pavelescu 1982", "creeps at rest")
            }
            Self::BengisuAkay => (
                "bengisu-akay",
                "parabolic rise, exponential fall",
                "Bengisu and Akay 1994 (recalled)",
                "creeps at rest",
            ),
            Self::BrownMcPhee => {
                ("brown-mcphee", "smooth Stribeck curve", "Brown and McPhee 2016", "creeps at rest")
            }
            Self::Karnopp => {
                ("karnopp", "balance in a band of speeds", "Karnopp 1985", "needs the applied force")
            }
            Self::Dahl => ("dahl", "yielding spring", "Dahl 1968", "no static excess"),
            Self::LuGre => (
                "lugre",
                "bristles with a Stribeck curve",
                "Canudas de Wit et al. 1995",
                "passive for s1 |v| <= 4 g",
            ),
            Self::SevenParameter => (
                "seven-parameter",
                "spring, delayed Stribeck curve, rising break-away",
                "Armstrong-Helouvry et al. 1994 (recalled)",
                "step after step, not a rate",
            ),
        };
        Entry { group: Group::Friction, name, description, source, range }
    }
}
