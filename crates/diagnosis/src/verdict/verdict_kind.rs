//! Verdict of a diagnosis.

use schemars::JsonSchema;
use serde::Serialize;

/// Verdict of a diagnosis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The causes explain the residual, or most of it.
    Named,
    /// Several causes fit equally.
    Ambiguous,
    /// Some causes certainly help, and an error remains that no known effect explains.
    Partial,
    /// The logs show an error of the simulation that no known effect explains.
    Unknown,
    /// The simulation agrees with the logs within the declared uncertainty.
    None,
}

impl Verdict {
    /// Name in JSON and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Named => "named",
            Self::Ambiguous => "ambiguous",
            Self::Partial => "partial",
            Self::Unknown => "unknown",
            Self::None => "none",
        }
    }
}
