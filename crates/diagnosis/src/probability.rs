//! Posterior shares over everything that the answer may be: nothing, each refitted set of causes, something unknown.
//!
//! Among themselves, nothing and the candidates share by their criterion (chi-square and `p ln n_eff`, [`crate::select`]).
//! What is unknown gets its odds against all of these from the last residual:
//!
//! * where the verdict is unknown (a cause was found that does not stand, or calibration went as far as it may), from a share of 0;
//! * where structure is left, from the share `s` of the repeatable held-out residual that the causes explain: even odds at
//!   [`MAIN_SHARE`], where the verdict changes, and a factor of e for every [`SHARE_WIDTH`] beside it. The width is a choice: a
//!   residual that is explained to 90 % is unknown with 5 %;
//! * where nothing is left, from a free-form model (means over bins of the cycle's phase, or of time, in any of the channels),
//!   charged `ln n_eff` for every bin, and at most [`MOST_UNSEEN`]: what the leftover tests pass over is below what counts.

use crate::model::Candidate;
use crate::noise::NoiseModel;
use crate::result::{Hypothesis, Member, Verdict};
use crate::select::Stage;
use crate::session::{Columns, Data, Use};
use crate::standing::MAIN_SHARE;
use crate::verdict::End;

/// Change of the explained share that changes the odds of something unknown by e.
const SHARE_WIDTH: f64 = 0.05;
/// Odds of something unknown, at most, where the leftover tests find nothing.
const MOST_UNSEEN: f64 = 0.05;
/// Bins of the free-form model for every channel.
const BINS: usize = 24;

/// Shares that add up to 1.
pub(crate) struct Shares {
    pub(crate) none: f64,
    pub(crate) unknown: f64,
    pub(crate) hypotheses: Vec<Hypothesis>,
}

/// The shares after the stages that stand, of which `shown` is the end; `share` is what it explains. Where the verdict is unknown, something is, whether or
/// not the leftover tests see it.
pub(crate) fn shares(
    data: &Data,
    stages: &[Stage],
    (standing, verdict): (usize, Verdict),
    shown: &End,
    share: Option<f64>,
) -> Shares {
    let odds = match (&shown.left, share) {
        (left, share) if left.is_some() || verdict == Verdict::Unknown => {
            let share = if standing > 0 { share.unwrap_or_default() } else { 0.0 };
            ((MAIN_SHARE - share) / SHARE_WIDTH).exp()
        }
        _ => (0.5 * free_form(data, &shown.noise, &shown.residual)).exp().min(MOST_UNSEEN),
    };
    let unknown = odds / (1.0 + odds);
    let known = 1.0 - unknown;
    let Some(first) = stages.first() else {
        return Shares { none: known, unknown, hypotheses: Vec::new() };
    };
    let none = known * without(first);
    let mut hypotheses = Vec::new();
    match (stages.get(1), first.contenders.first()) {
        (Some(second), Some(earlier)) if standing > 1 => {
            let (rest, earlier) = (known - none, earlier.candidate);
            add(&mut hypotheses, &[earlier], rest * without(second));
            for (place, c) in second.contenders.iter().enumerate() {
                let beside = if place == 0 { beside(shown, earlier) } else { 1.0 };
                add(&mut hypotheses, &[earlier, c.candidate], rest * c.probability * beside);
                if beside < 1.0 {
                    add(&mut hypotheses, &[c.candidate], rest * c.probability * (1.0 - beside));
                }
            }
        }
        _ => {
            for c in &first.contenders {
                add(&mut hypotheses, &[c.candidate], known * c.probability);
            }
        }
    }
    hypotheses.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    Shares { none, unknown, hypotheses }
}

/// Share of the model before a stage among its candidates and itself.
fn without(stage: &Stage) -> f64 {
    (1.0 - stage.contenders.iter().map(|c| c.probability).sum::<f64>()).clamp(0.0, 1.0)
}

/// Share of the earlier cause beside the best later one.
fn beside(shown: &End, earlier: Candidate) -> f64 {
    shown.causes.iter().find(|(c, _)| *c == earlier).map_or(0.0, |(_, p)| *p)
}

fn add(hypotheses: &mut Vec<Hypothesis>, candidates: &[Candidate], probability: f64) {
    hypotheses.push(Hypothesis { causes: candidates.iter().map(Member::from).collect(), probability });
}

/// What the best free-form model of some channels takes off chi-square, less its charge; below 0 where it is not worth it.
fn free_form(data: &Data, noise: &NoiseModel, residual: &Columns) -> f64 {
    let charge = noise.effective_samples(data).max(2.0).ln();
    let gains = data.channels.iter().map(|&channel| {
        let (mut sums, mut counts) = (vec![0.0; BINS], vec![0.0_f64; BINS]);
        for (block, values) in data.blocks.iter().zip(residual).filter(|(b, _)| b.channel == channel) {
            let Some(session) = data.sessions.get(block.session) else { continue };
            let length = values.len().max(1) as f64;
            for (i, value) in
                values.iter().enumerate().filter(|(i, _)| session.uses.get(*i) != Some(&Use::Skip))
            {
                let place = match session.phase.as_ref().and_then(|p| p.get(i)) {
                    Some(phase) => phase.rem_euclid(1.0),
                    None => i as f64 / length,
                };
                let bin = ((place * BINS as f64) as usize).min(BINS - 1);
                if let (Some(sum), Some(count)) = (sums.get_mut(bin), counts.get_mut(bin)) {
                    *sum += value;
                    *count += 1.0;
                }
            }
        }
        let weight = noise.weight(channel);
        let bins = sums.iter().zip(&counts).filter(|(_, n)| **n > 0.0);
        bins.map(|(sum, n)| (weight * sum).powi(2) / n - charge).sum::<f64>()
    });
    let gains: Vec<f64> = gains.collect();
    let worth: f64 = gains.iter().filter(|g| **g > 0.0).sum();
    if worth > 0.0 { worth } else { gains.iter().copied().fold(f64::NEG_INFINITY, f64::max) }
}
