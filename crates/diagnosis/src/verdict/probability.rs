//! Posterior probabilities of all possible results: no cause, each refitted set of causes, and an
//! unknown cause.
//!
//! The results without a cause and with each candidate share their probability by BIC
//! ([`crate::search::contender`]). The odds of an unknown cause against all of these come from the
//! residual of the extended bench:
//!
//! * If structure remains beside accepted causes, the odds depend on the share of the repeatable
//!   held-out residual that these explain: even odds at [`tuning::MAIN_SHARE`], where the verdict
//!   changes, and a factor of e for every [`tuning::SHARE_WIDTH`] of difference.
//! * If the verdict is `unknown`, the same rule applies with a share of 0.
//! * If it is `partial`, the same rule applies with odds of at least 1.
//! * Otherwise they are the odds of a free-form model, at most [`tuning::MAX_UNSEEN_ODDS`]. That
//!   model consists of the means over bins of the cycle's phase, or of time, in any of the
//!   channels, with the BIC penalty for every bin.

use super::effect_name::EffectName;
use super::explanation::Explanation;
use super::tuning;
use crate::data::logs::{Columns, Data};
use crate::data::noise::NoiseModel;
use crate::data::split::Use;
use crate::fit::model::Candidate;
use crate::search::selection::Selection;
use crate::search::stage::Stage;
use crate::search::threshold::bic_penalty;
use schemars::JsonSchema;
use serde::Serialize;

/// A fitted set of causes.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Hypothesis {
    /// Causes that act together.
    pub causes: Vec<EffectName>,
    /// Posterior share.
    pub probability: f64,
}

/// Probabilities that add up to 1, those of `hypotheses` included.
pub(crate) struct Shares {
    pub(crate) none: f64,
    pub(crate) unknown: f64,
    pub(crate) hypotheses: Vec<Hypothesis>,
}

/// Posterior probabilities, given the number of accepted causes, whether the verdict is `unknown`,
/// the reported explanation and the `share` that it explains.
pub(crate) fn posterior_shares(
    data: &Data,
    selection: &Selection,
    (accepted, is_unknown): (usize, bool),
    reported: &Explanation,
    share: Option<f64>,
) -> Shares {
    let unknown = if is_unknown {
        share_probability(0.0)
    } else {
        unknown_probability(data, reported, if accepted > 0 { share.unwrap_or_default() } else { 0.0 })
    };
    let known = 1.0 - unknown;
    let first = &selection.first;
    let none = known * base_probability(first);
    let mut hypotheses = Vec::new();
    match (&selection.second, first.contenders.first()) {
        (Some(second), Some(earlier)) if accepted > 1 => {
            let (remaining, earlier) = (known - none, &earlier.candidate);
            add(&mut hypotheses, &[earlier], remaining * base_probability(second));
            for (place, c) in second.contenders.iter().enumerate() {
                let beside = if place == 0 { earlier_probability(reported, earlier) } else { 1.0 };
                add(&mut hypotheses, &[earlier, &c.candidate], remaining * c.probability * beside);
                if beside < 1.0 {
                    add(&mut hypotheses, &[&c.candidate], remaining * c.probability * (1.0 - beside));
                }
            }
        }
        _ => {
            for c in &first.contenders {
                add(&mut hypotheses, &[&c.candidate], known * c.probability);
            }
        }
    }
    hypotheses.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    Shares { none, unknown, hypotheses }
}

/// Probability of an unknown cause beside the causes of an explanation, given the share that these
/// explain.
pub(crate) fn unknown_probability(data: &Data, reported: &Explanation, share: f64) -> f64 {
    if reported.remaining.is_some() {
        return share_probability(share);
    }
    let fall = free_form_fall(data, &reported.noise, &reported.residual);
    let odds = (0.5 * fall).exp().min(tuning::MAX_UNSEEN_ODDS);
    odds / (1.0 + odds)
}

/// Probability of an unknown cause where an error remains beside an explained share.
pub(crate) fn share_probability(share: f64) -> f64 {
    let odds = ((tuning::MAIN_SHARE - share) / tuning::SHARE_WIDTH).exp();
    odds / (1.0 + odds)
}

/// Probability of the base of a stage among its candidates and itself.
fn base_probability(stage: &Stage) -> f64 {
    (1.0 - stage.contenders.iter().map(|c| c.probability).sum::<f64>()).clamp(0.0, 1.0)
}

/// Probability of the earlier cause beside the best later one; 0 if it was dropped.
fn earlier_probability(reported: &Explanation, earlier: &Candidate) -> f64 {
    reported.causes.iter().find(|(c, _)| c == earlier).map_or(0.0, |(_, p)| *p)
}

fn add(hypotheses: &mut Vec<Hypothesis>, candidates: &[&Candidate], probability: f64) {
    hypotheses
        .push(Hypothesis { causes: candidates.iter().copied().map(EffectName::from).collect(), probability });
}

/// Fall of chi-square by the best free-form model of one or more channels, less its BIC penalty;
/// negative if the penalty is larger.
fn free_form_fall(data: &Data, noise: &NoiseModel, residual: &Columns) -> f64 {
    let penalty = bic_penalty(1, data, noise);
    let gains = data.channels.iter().map(|&channel| {
        let (mut sums, mut counts) =
            (vec![0.0; tuning::FREE_FORM_BINS], vec![0.0_f64; tuning::FREE_FORM_BINS]);
        for (block, values) in data.blocks.iter().zip(residual).filter(|(b, _)| b.channel == channel) {
            let Some(log) = data.logs.get(block.log) else { continue };
            let length = values.len().max(1) as f64;
            for (i, value) in values.iter().enumerate().filter(|(i, _)| log.uses.get(*i) != Some(&Use::Skip))
            {
                let place = match log.phase.as_ref().and_then(|p| p.get(i)) {
                    Some(phase) => phase.rem_euclid(1.0),
                    None => i as f64 / length,
                };
                let bin = ((place * tuning::FREE_FORM_BINS as f64) as usize).min(tuning::FREE_FORM_BINS - 1);
                if let (Some(sum), Some(count)) = (sums.get_mut(bin), counts.get_mut(bin)) {
                    *sum += value;
                    *count += 1.0;
                }
            }
        }
        let weight = noise.weight(channel);
        let bins = sums.iter().zip(&counts).filter(|(_, n)| **n > 0.0);
        bins.map(|(sum, n)| (weight * sum).powi(2) / n - penalty).sum::<f64>()
    });
    let gains: Vec<f64> = gains.collect();
    let gain: f64 = gains.iter().filter(|g| **g > 0.0).sum();
    if gain > 0.0 { gain } else { gains.iter().copied().fold(f64::NEG_INFINITY, f64::max) }
}
