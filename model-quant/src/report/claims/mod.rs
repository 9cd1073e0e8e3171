//! Verdicts on the paper's claims about friction and training (12 to 15), and the types of claims
//! and verdicts.
//!
//! [`torque`] computes torque over load and speed from a rig's records, [`friction`] evaluates it,
//! and [`training`] evaluates the errors of networks. `host-sim` evaluates the other claims on runs
//! of the bench with the same types.

pub mod friction;
pub mod torque;
pub mod training;

use schemars::JsonSchema;
use serde::Serialize;

/// Verdict on a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize)]
pub enum Verdict {
    /// The figures confirm it.
    #[serde(rename = "holds")]
    Holds,
    /// The project's own law has the claimed shape. It stands in for measurements that the paper
    /// does not publish, so this says nothing about the paper's bearings.
    #[serde(rename = "assumed")]
    Assumed,
    /// The figures confirm a part of it.
    #[serde(rename = "partly")]
    Partly,
    /// The figures contradict it.
    #[serde(rename = "does not hold")]
    DoesNotHold,
}

impl Verdict {
    /// Verdict as text.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Assumed => "assumed",
            Self::Partly => "partly",
            Self::DoesNotHold => "does not hold",
        }
    }

    /// Returns `Assumed` instead of `Holds`, for a claim whose data is the project's own law.
    pub const fn of_own_law(self) -> Self {
        match self {
            Self::Holds => Self::Assumed,
            other => other,
        }
    }

    /// Returns whether all conditions of the claim are met.
    pub const fn is_affirmed(self) -> bool {
        matches!(self, Self::Holds | Self::Assumed)
    }

    /// Returns `Holds` if all conditions are met, `Partly` if some are.
    pub fn from_conditions(all: bool, some: bool) -> Self {
        match (all, some) {
            (true, _) => Self::Holds,
            (false, true) => Self::Partly,
            (false, false) => Self::DoesNotHold,
        }
    }

    /// Returns `Holds` if every item is true, `Partly` if at least one is, else `DoesNotHold`; also
    /// without items.
    pub fn from_each(each: impl Iterator<Item = bool>) -> Self {
        let (count, hits) = each.fold((0, 0), |(n, h), ok| (n + 1, h + usize::from(ok)));
        Self::from_conditions(count > 0 && hits == count, hits > 0)
    }
}

/// A claim of the paper with its verdict.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub struct Claim {
    /// Number, 1 to 15.
    pub id: u8,
    /// Text of the claim.
    pub claim: &'static str,
    /// Verdict on it.
    pub verdict: Verdict,
    /// Condition for `Holds`.
    pub threshold: &'static str,
    /// Figures, and the measured cause if it does not hold.
    pub why: String,
}

/// Formats numbers without decimals, separated by commas.
pub fn list(values: impl IntoIterator<Item = f64>) -> String {
    values.into_iter().map(|v| format!("{v:.0}")).collect::<Vec<_>>().join(", ")
}

/// Formats numbers with decimals, separated by commas.
pub fn list_to(digits: usize, values: impl IntoIterator<Item = f64>) -> String {
    values.into_iter().map(|v| format!("{v:.digits$}")).collect::<Vec<_>>().join(", ")
}
