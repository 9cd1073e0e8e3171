//! Result of a diagnosis, as it is written to `diagnosis.json`, and its error.

use crate::check::Finding;
use crate::experiment::proposal::Experiment;
use crate::fit::held_out_gain::Gain;
use crate::verdict::acceptance::Rejection;
use crate::verdict::causes::{Cause, EquivalentEffect};
use crate::verdict::estimates::{CalibratedParameter, LogNuisance};
use crate::verdict::identifiability::Identifiability;
use crate::verdict::noise_summary::Noise;
use crate::verdict::probability::Hypothesis;
use crate::verdict::ranking::RankedCandidate;
use crate::verdict::remaining_structure::RemainingStructure;
use crate::verdict::residual_bins::BinnedResidual;
use crate::verdict::series::Series;
use crate::verdict::verdict_kind::Verdict;
use bench::Bench;
use bench::log::LogError;
use bench::simulate::RespondError;
use schemars::JsonSchema;
use serde::Serialize;

/// Error of a diagnosis.
#[derive(Debug, thiserror::Error)]
pub enum DiagnosisError {
    /// A log is unusable.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The nominal bench cannot be simulated.
    #[error(transparent)]
    Respond(#[from] RespondError),
    /// No log was given.
    #[error("no log given; expected at least one")]
    NoLog,
}

/// Result of a diagnosis.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Diagnosis {
    /// Findings of the checks of the logs and corrections of the data, the most severe first.
    pub checks: Vec<Finding>,
    /// Verdict.
    pub verdict: Verdict,
    /// Causes, the main one first.
    pub causes: Vec<Cause>,
    /// Posterior probability that there is no cause.
    pub probability_none: f64,
    /// Posterior probability of a cause that no effect explains.
    pub probability_unknown: f64,
    /// Fitted sets of causes, most probable first; with the two probabilities above they add up to
    /// 1.
    pub hypotheses: Vec<Hypothesis>,
    /// Effects that fit as well as the causes.
    pub ambiguous_with: Vec<EquivalentEffect>,
    /// Selected causes that are not accepted, or the nearest candidate if none was selected, with
    /// the reason.
    #[serde(rename = "refused")]
    pub rejection: Option<Rejection>,
    /// Structure that remains in the residual.
    pub signature: Option<RemainingStructure>,
    /// Residuals over the quantities that they may depend on, before and after the extension.
    pub places: Vec<BinnedResidual>,
    /// Error before and after the extension, by channel.
    pub gain: Vec<Gain>,
    /// Share of the repeatable residual that the extension explains, over all channels in units of
    /// their noise.
    pub explained_share: Option<f64>,
    /// 95 % interval of that share.
    pub explained_share_ci95: Option<[f64; 2]>,
    /// Next experiment as a sentence.
    pub next_experiment: Option<String>,
    /// Next experiment with its recordings, and how well it would separate the effects.
    pub experiment: Option<Experiment>,
    /// Path of the extended bench, once it is written.
    pub extended_bench: Option<String>,
    /// Parameters of the bench that calibration may move.
    pub calibrated: Vec<CalibratedParameter>,
    /// Nuisance parameters of single logs, if the description declares any.
    pub nuisances: Vec<LogNuisance>,
    /// Noise by channel.
    pub noise: Vec<Noise>,
    /// Parameters of the last model that the logs do not determine.
    pub identifiability: Vec<Identifiability>,
    /// Candidates of the first stage, best first.
    pub ranking: Vec<RankedCandidate>,
    /// Fall of chi-square that the first cause had to exceed.
    pub threshold: f64,
    /// The bench with calibrated parameters and found effects.
    #[serde(skip)]
    pub extended: Option<Bench>,
    /// Measured values and residuals over time.
    #[serde(skip)]
    pub series: Vec<Series>,
}
