//! The paper's claims about friction and training (12 to 15), judged from numbers; what a claim and a verdict are.
//!
//! [`torque`] gathers torque over load and speed from a rig's records or from networks, [`friction`] judges it, [`training`]
//! judges the errors of networks. `host-sim` judges the other claims, on runs of the bench, with the same types.

pub mod friction;
pub mod torque;
pub mod training;

use serde::Serialize;

/// What became of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Verdict {
    /// The numbers bear it out.
    #[serde(rename = "holds")]
    Holds,
    /// They bear out a part of it.
    #[serde(rename = "partly")]
    Partly,
    /// They do not.
    #[serde(rename = "does not hold")]
    DoesNotHold,
}

impl Verdict {
    /// The verdict in words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Partly => "partly",
            Self::DoesNotHold => "does not hold",
        }
    }

    /// `Holds` if all do, `Partly` if some do.
    pub fn of(all: bool, some: bool) -> Self {
        match (all, some) {
            (true, _) => Self::Holds,
            (false, true) => Self::Partly,
            (false, false) => Self::DoesNotHold,
        }
    }

    /// `Holds` if every one is true, `Partly` if one is, `DoesNotHold` if none is or there is nothing to go by.
    pub fn of_each(each: impl Iterator<Item = bool>) -> Self {
        let (count, hits) = each.fold((0, 0), |(n, h), ok| (n + 1, h + usize::from(ok)));
        Self::of(count > 0 && hits == count, hits > 0)
    }
}

/// A claim of the paper with its verdict.
#[derive(Clone, Debug, Serialize)]
pub struct Claim {
    /// Number, 1 to 15.
    pub id: u8,
    /// What the paper says.
    pub claim: &'static str,
    /// What the runs say to that.
    pub verdict: Verdict,
    /// What would have held.
    pub threshold: &'static str,
    /// The numbers, and the measured cause where it does not hold.
    pub why: String,
}

/// Numbers with a separator, without decimals.
pub fn list(values: impl IntoIterator<Item = f64>) -> String {
    values.into_iter().map(|v| format!("{v:.0}")).collect::<Vec<_>>().join(", ")
}

/// Numbers with a separator and decimals.
pub fn list_to(digits: usize, values: impl IntoIterator<Item = f64>) -> String {
    values.into_iter().map(|v| format!("{v:.digits$}")).collect::<Vec<_>>().join(", ")
}
