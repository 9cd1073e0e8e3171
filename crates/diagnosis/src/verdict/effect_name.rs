//! Name of an effect in the result of a diagnosis.

use crate::fit::model::Candidate;
use bench::Channel;
use schemars::JsonSchema;
use serde::Serialize;

/// Name of an effect, with its sensor or its part of a mechanism.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct EffectName {
    /// Effect in kebab-case.
    pub effect: String,
    /// Sensor, for sensor effects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
    /// Body or joint, for effects on a part of a mechanism.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
}

impl From<&Candidate> for EffectName {
    fn from(candidate: &Candidate) -> Self {
        Self { effect: candidate.kind.name.into(), channel: candidate.channel, of: candidate.part() }
    }
}
