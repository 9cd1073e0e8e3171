//! Candidates of the first stage with their evidence.

use crate::search::contender::Contender;
use crate::search::stage::Stage;
use bench::Channel;
use schemars::JsonSchema;
use serde::Serialize;

/// A candidate of the first stage.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct RankedCandidate {
    /// Effect in kebab-case.
    pub effect: String,
    /// Sensor, for sensor effects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
    /// Body or joint, for effects on a part of a mechanism.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// Fall of chi-square relative to the bench without the candidate, after the joint refit.
    pub evidence: f64,
    /// Posterior probability.
    pub probability: f64,
    /// True if it was fitted to all samples; otherwise its evidence is from the first cycle, where
    /// it was eliminated.
    pub refitted: bool,
}

/// The candidates of a stage; `known` is the probability that the cause is not unknown.
pub(crate) fn ranking(stage: &Stage, known: f64) -> Vec<RankedCandidate> {
    let refitted = stage.contenders.iter().map(|c: &Contender| RankedCandidate {
        effect: c.candidate.kind.name.into(),
        channel: c.candidate.channel,
        of: c.candidate.part(),
        evidence: c.evidence,
        probability: known * c.probability,
        refitted: true,
    });
    let searched = stage.others.iter().map(|(candidate, evidence)| RankedCandidate {
        effect: candidate.kind.name.into(),
        channel: candidate.channel,
        of: candidate.part(),
        evidence: *evidence,
        probability: 0.0,
        refitted: false,
    });
    refitted.chain(searched).collect()
}
