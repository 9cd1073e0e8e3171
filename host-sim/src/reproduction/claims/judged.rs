//! Claims with all their verdicts: as the paper ran the bench, settled, and asked of the networks.

use super::facts::{Facts, MotionFacts};
use super::{Claim, Verdict, evaluate, evaluate_motion};
use model_quant::report::claims::friction;
use schemars::JsonSchema;
use serde::Serialize;

/// A further verdict with its figures.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub struct Further {
    /// Verdict.
    pub verdict: Verdict,
    /// Figures.
    pub why: String,
}

impl From<Claim> for Further {
    fn from(claim: Claim) -> Self {
        Self { verdict: claim.verdict, why: claim.why }
    }
}

/// A claim with its verdicts. Its own one is that of one cycle from rest, as the paper ran it.
#[derive(Clone, Debug, JsonSchema, Serialize)]
pub(crate) struct Judged {
    /// The claim, and its verdict for one cycle from rest.
    #[serde(flatten)]
    pub claim: Claim,
    /// Verdict in settled operation; none for claims that are not about the bench's motion.
    pub settled: Option<Further>,
    /// Verdict for the outputs of the shipped networks; only claims 12 to 14, whose figures in the
    /// paper show outputs of its networks.
    pub networks: Option<Further>,
}

const NETWORKS: &str = "From the outputs of the shipped networks at the bench's loads; they were trained on \
                        the bench's law with its regularised sign of 1 mm/s";

/// Judges all claims on the paper's runs, on settled runs and on the shipped networks.
pub(crate) fn evaluate_all(facts: &Facts, settled: &MotionFacts) -> Vec<Judged> {
    let mut settled = further(evaluate_motion(settled));
    let mut networks = further(friction::assess_curves(&facts.networks, NETWORKS));
    let judged = |claim: Claim| Judged {
        settled: take(&mut settled, claim.id),
        networks: take(&mut networks, claim.id),
        claim,
    };
    evaluate(facts).into_iter().map(judged).collect()
}

fn further(claims: Vec<Claim>) -> Vec<(u8, Further)> {
    claims.into_iter().map(|claim| (claim.id, claim.into())).collect()
}

fn take(all: &mut Vec<(u8, Further)>, id: u8) -> Option<Further> {
    let place = all.iter().position(|(other, _)| *other == id)?;
    Some(all.swap_remove(place).1)
}
