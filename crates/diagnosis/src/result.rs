//! What a diagnosis says, as it is written to `diagnosis.json`.

use crate::calibration::{Calibrated, SessionNuisance};
use crate::check::Finding;
use crate::model::Candidate;
use crate::places::Place;
use bench::{Bench, Channel};
use serde::Serialize;

/// The answer in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The causes are known.
    Named,
    /// Several causes fit equally.
    Ambiguous,
    /// Something is wrong, and no known effect explains it.
    Unknown,
    /// Nothing is wrong within the declared uncertainty.
    None,
}

impl Verdict {
    /// The word in JSON and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Named => "named",
            Self::Ambiguous => "ambiguous",
            Self::Unknown => "unknown",
            Self::None => "none",
        }
    }
}

/// A fitted parameter.
#[derive(Clone, Debug, Serialize)]
pub struct ParameterEstimate {
    /// Name in the bench description.
    pub name: String,
    /// Estimate.
    pub value: f64,
    /// Unit.
    pub unit: String,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

/// A cause.
#[derive(Clone, Debug, Serialize)]
pub struct Cause {
    /// Effect in kebab-case.
    pub effect: String,
    /// Sensor, for sensor effects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
    /// Posterior share: that it is a cause, whatever else is.
    pub probability: f64,
    /// Its parameters.
    pub parameters: Vec<ParameterEstimate>,
}

/// An effect that fits as well as a named one.
#[derive(Clone, Debug, Serialize)]
pub struct Ambiguous {
    /// Effect in kebab-case.
    pub effect: String,
    /// Sensor, for sensor effects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
    /// Posterior share.
    pub probability: f64,
    /// Correlation of its projected signature with that of the first one.
    pub correlation: f64,
}

/// Where structure is left in the residual.
#[derive(Clone, Debug, Serialize)]
pub struct Signature {
    /// Channel that shows it most.
    pub channel: Channel,
    /// In words: cycle phase, direction, speed, load, position or time.
    #[serde(rename = "where")]
    pub place: String,
    /// The quantity that explains most of it.
    pub feature: &'static str,
    /// Its rms in the unit of the channel.
    pub rms: f64,
    /// Its rms in units of the noise.
    pub rms_over_noise: f64,
}

/// Error on one channel before and after.
#[derive(Clone, Debug, Serialize)]
pub struct Gain {
    /// Channel.
    pub channel: Channel,
    /// Rms residual of the calibrated nominal bench.
    pub baseline_rms: f64,
    /// Rms residual of the extended bench.
    pub extended_rms: f64,
    /// Rms of the sensor's noise.
    pub noise_rms: f64,
    /// Whether the figures are of samples that were not fitted.
    pub held_out: bool,
    /// Share of the residual's power above the noise that the extension takes away; null where there is none.
    pub explained_share: Option<f64>,
    /// 95 % interval of that share by a block bootstrap.
    pub explained_share_ci95: Option<[f64; 2]>,
}

/// How far an experiment sets an effect apart from the cause.
#[derive(Clone, Debug, Serialize)]
pub struct Separation {
    /// Effect in kebab-case.
    pub effect: String,
    /// Sensor, for sensor effects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
    /// Chi-square that is left after the cause has adjusted everything it may to imitate the effect.
    pub chi_square: f64,
}

/// A recording of an experiment.
#[derive(Clone, Debug, Serialize)]
pub struct Recording {
    /// Lines of TOML that change the description, such as `drive.period_s = 0.5`.
    pub changes: Vec<String>,
    /// The whole changed description, to record with.
    pub bench: String,
}

/// What to measure next; its recordings are diagnosed together.
#[derive(Clone, Debug, Serialize)]
pub struct Experiment {
    /// In words.
    pub words: String,
    /// What to record; empty where nothing on the menu would tell.
    pub recordings: Vec<Recording>,
    /// How far it sets apart each effect that fits as well as the cause.
    pub separation: Vec<Separation>,
}

/// An effect of a hypothesis.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Member {
    /// Effect in kebab-case.
    pub effect: String,
    /// Sensor, for sensor effects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
}

impl From<&Candidate> for Member {
    fn from(candidate: &Candidate) -> Self {
        Self { effect: candidate.kind.name.into(), channel: candidate.channel }
    }
}

/// Causes that passed the selection and do not stand; where nothing passed it, the one with clear evidence that came nearest.
#[derive(Clone, Debug, Serialize)]
pub struct Refused {
    /// One cause, or two together.
    pub causes: Vec<Member>,
    /// Why: `declared-number-at-bound`, `shape-at-bound`, `no-memory`, `size-differs`, `explains-too-little`, `size-uncertain` or
    /// `held-out-uncertain`.
    pub reason: String,
    /// The same as a clause.
    pub words: String,
}

/// A set of causes that was fitted.
#[derive(Clone, Debug, Serialize)]
pub struct Hypothesis {
    /// One cause, or two together.
    pub causes: Vec<Member>,
    /// Posterior share.
    pub probability: f64,
}

/// Something that the logs do not tell of the last model's parameters.
#[derive(Clone, Debug, Serialize)]
pub struct Identifiability {
    /// `dead`, `at-bound`, `not-pinned`, `correlated`, `sign` or `flat-direction`.
    pub kind: &'static str,
    /// The parameters concerned.
    pub parameters: Vec<String>,
    /// Change of chi-square over one prior standard deviation (dead), the bound, the share of the prior's standard
    /// deviation (not pinned), the correlation, the change of chi-square (sign), the eigenvalue (flat direction).
    pub value: f64,
    /// In words.
    pub words: String,
}

/// Noise of one channel.
#[derive(Clone, Debug, Serialize)]
pub struct Noise {
    /// Channel.
    pub channel: Channel,
    /// White noise, one standard deviation.
    pub floor: f64,
    /// Whether the floor was declared; otherwise it comes from the log.
    pub declared: bool,
    /// `declared`, `repeats` (what does not repeat from cycle to cycle) or `differences` (of neighbouring samples).
    pub source: &'static str,
    /// What the description declares.
    pub declared_floor: Option<f64>,
    /// What the log shows: from repeats where it has three cycles, else from differences.
    pub measured_floor: f64,
    /// Whole cycles that were compared, 0 where there are fewer than three.
    pub repeats: usize,
    /// Share of the power of the calibrated nominal bench's residual that repeats: model error, not noise.
    pub repeatable_share: Option<f64>,
    /// In words, where the declared floor is far from the measured one.
    pub finding: Option<String>,
    /// Rms of the last residual over the floor, where above 1.
    pub excess: f64,
    /// Samples that count as one because the residual is correlated.
    pub correlation_samples: f64,
}

/// A candidate of the first step.
#[derive(Clone, Debug, Serialize)]
pub struct Ranked {
    /// Effect in kebab-case.
    pub effect: String,
    /// Sensor, for sensor effects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
    /// Fall of chi-square against the bench without it, after the joint refit.
    pub evidence: f64,
    /// Posterior share.
    pub probability: f64,
    /// Whether it was fitted to everything; else it was out of the race on the first cycle, and the evidence is from there.
    pub refitted: bool,
}

/// A residual over a log, for pictures.
#[derive(Clone, Debug)]
pub struct Series {
    /// The log.
    pub source: String,
    /// Channel.
    pub channel: Channel,
    /// Time in s.
    pub time_s: Vec<f64>,
    /// Phase in cycles, where the motion repeats.
    pub phase: Option<Vec<f64>>,
    /// Measured.
    pub measured: Vec<f64>,
    /// Measured less simulated with the calibrated nominal bench.
    pub before: Vec<f64>,
    /// Measured less simulated with the extended bench.
    pub after: Vec<f64>,
    /// Whether a sample was held out.
    pub held_out: Vec<bool>,
}

/// The result.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// What reading and checking the logs found, the gravest first, and what was done to the data.
    pub checks: Vec<Finding>,
    /// The answer.
    pub verdict: Verdict,
    /// Causes, the main one first.
    pub causes: Vec<Cause>,
    /// Posterior share of: nothing is wrong.
    pub probability_none: f64,
    /// Posterior share of: something is wrong that no effect explains.
    pub probability_unknown: f64,
    /// Sets of causes that were fitted, most likely first; with the two shares above they add up to 1.
    pub hypotheses: Vec<Hypothesis>,
    /// Effects that fit as well as the causes.
    pub ambiguous_with: Vec<Ambiguous>,
    /// Causes that were found beyond those, or where none was the candidate that comes nearest, and what speaks against them.
    pub refused: Option<Refused>,
    /// Structure that is left.
    pub signature: Option<Signature>,
    /// Where the residual lives, before and after.
    pub places: Vec<Place>,
    /// Error before and after, by channel.
    pub gain: Vec<Gain>,
    /// Share of the repeatable residual over all channels, in units of their noise, that the extension explains.
    pub explained_share: Option<f64>,
    /// 95 % interval of that share.
    pub explained_share_ci95: Option<[f64; 2]>,
    /// What to measure next, in words.
    pub next_experiment: Option<String>,
    /// The same with what to record, and how far it would set the effects apart.
    pub experiment: Option<Experiment>,
    /// Path of the extended bench, once it is written.
    pub extended_bench: Option<String>,
    /// Parameters that calibration moved.
    pub calibrated: Vec<Calibrated>,
    /// What the sessions have of their own, where the description declares any.
    pub nuisances: Vec<SessionNuisance>,
    /// Noise by channel.
    pub noise: Vec<Noise>,
    /// What the logs do not tell of the last model's parameters; empty where they tell everything.
    pub identifiability: Vec<Identifiability>,
    /// Candidates of the first step, most evidence first.
    pub ranking: Vec<Ranked>,
    /// Evidence that a cause had to pass.
    pub threshold: f64,
    /// The bench with calibrated parameters and found effects.
    #[serde(skip)]
    pub extended: Option<Bench>,
    /// Residuals before and after.
    #[serde(skip)]
    pub series: Vec<Series>,
}
