//! Structure in the last residual that no candidate has taken away.
//!
//! Logs of two and more cycles are their own judge: what repeats from cycle to cycle is model error, what does not is
//! noise, of whatever colour (means over bins of the cycle's phase, their scatter between cycles as pure error, an F
//! test). Means of whole cycles are tested against zero for drifts. A log without cycles is only as good as its
//! declared noise, which is white by definition: means of short blocks are tested against it.
//! Where noise is declared, a residual that is larger than it as a whole is structure too, wherever it sits: an oscillation
//! that averages out in every bin. So is one that is larger than that only where nothing was fitted: what begins in the half of a log that is held out is
//! nothing that repeats, and may average out over a cycle.
//! Structure below [`LEAST_RMS`] of the noise is nobody's business, however significant.

use crate::noise::NoiseModel;
use crate::result::Signature;
use crate::session::{Block, Columns, Data, Use};
use crate::structure;
use bench::Channel;
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};
use std::collections::BTreeMap;

/// Rms of structure, in units of the noise, below which it is ignored.
const LEAST_RMS: f64 = 0.2;
/// Rms of a residual over the declared noise from which it is larger than noise; what a declaration may be off by.
const LARGER: f64 = 1.2;
/// Chance that a clean log shows structure, shared by channels and tests.
const FAMILY_ERROR: f64 = 0.002;
const MOST_BINS: usize = 24;
const LEAST_BINS: usize = 4;
/// Blocks of a log without cycles.
const BLOCKS: usize = 48;

/// The strongest structure that is left, if any.
pub(crate) fn find(data: &Data, noise: &NoiseModel, residual: &Columns) -> Option<Signature> {
    let limit = FAMILY_ERROR / (2.0 * data.channels.len().max(1) as f64);
    let found = data.channels.iter().filter_map(|&channel| {
        let parts: Vec<(&Block, &Vec<f64>)> =
            data.blocks.iter().zip(residual).filter(|(b, _)| b.channel == channel).collect();
        let rms = [repeating(data, noise, channel, &parts), wandering(data, noise, channel, &parts)]
            .into_iter()
            .filter(|(chance, rms)| *chance < limit && *rms > LEAST_RMS * noise.of(channel).floor)
            .map(|(_, rms)| rms)
            .fold(larger(noise, channel).max(held_out(data, noise, residual, channel)), f64::max);
        (rms > 0.0).then_some((channel, rms, rms / noise.of(channel).floor))
    });
    let (channel, rms, rms_over_noise) = found.max_by(|a, b| a.2.total_cmp(&b.2))?;
    let (feature, place) = structure::describe(data, residual, channel);
    Some(Signature { channel, place, feature, rms, rms_over_noise })
}

/// Rms of what a residual has above its declared noise; 0 where it is no larger.
fn larger(noise: &NoiseModel, channel: Channel) -> f64 {
    let n = noise.of(channel);
    if n.declared && n.excess > LARGER { n.floor * (n.excess * n.excess - 1.0).sqrt() } else { 0.0 }
}

/// Rms of what the held-out samples have above the declared noise; 0 where it is no larger.
fn held_out(data: &Data, noise: &NoiseModel, residual: &Columns, channel: Channel) -> f64 {
    let n = noise.of(channel);
    let squares =
        data.blocks.iter().zip(residual).filter(|(b, _)| b.channel == channel).flat_map(|(b, values)| {
            values.iter().zip(data.uses(b)).filter(|(_, u)| **u == Use::Held).map(|(v, _)| v * v)
        });
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    let count = f64::max(count, 1.0);
    let power: f64 = sum / count - n.floor.powi(2);
    // An rms scatters by 1/sqrt(2 n).
    let larger = LARGER + 3.0 * (n.correlation / (2.0 * count)).sqrt();
    if n.declared && power > (larger * larger - 1.0) * n.floor.powi(2) { power.sqrt() } else { 0.0 }
}

/// Whether what is left is larger than the declared noise where nothing was fitted, and only there: by channel, since each has its own noise.
pub(crate) fn is_late(data: &Data, noise: &NoiseModel, residual: &Columns) -> bool {
    data.channels.iter().any(|&c| held_out(data, noise, residual, c) > 0.0 && larger(noise, c) == 0.0)
}

/// Chance and rms of what repeats in every cycle.
fn repeating(data: &Data, noise: &NoiseModel, channel: Channel, parts: &[(&Block, &Vec<f64>)]) -> (f64, f64) {
    let (mut between, mut bins, mut within, mut freedom, mut power) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (block, values) in parts {
        let session = &data.sessions[block.session];
        let Some(phase) = &session.phase else { continue };
        let cycles = phase.last().zip(phase.first()).map_or(1.0, |(b, a)| b - a);
        let per_cycle = values.len() as f64 / cycles.max(1.0);
        // Bins several correlation times long are independent.
        let count = (per_cycle / (4.0 * noise.of(channel).correlation)) as usize;
        let count = count.clamp(LEAST_BINS, MOST_BINS);
        // Mean of every bin of every cycle.
        let mut means: BTreeMap<(usize, i64), (f64, f64)> = BTreeMap::new();
        for ((value, phase), _) in
            values.iter().zip(phase).zip(&session.uses).filter(|(_, u)| **u != Use::Skip)
        {
            let bin = (phase.rem_euclid(1.0) * count as f64) as usize;
            let entry = means.entry((bin.min(count - 1), phase.floor() as i64)).or_default();
            entry.0 += value;
            entry.1 += 1.0;
        }
        for bin in 0..count {
            let full: Vec<f64> = means
                .range((bin, i64::MIN)..=(bin, i64::MAX))
                .filter(|(_, (_, n))| *n >= 0.6 * per_cycle / count as f64)
                .map(|(_, (sum, n))| sum / n)
                .collect();
            let k = full.len() as f64;
            if k >= 2.0 {
                let mean = full.iter().sum::<f64>() / k;
                let scatter: f64 = full.iter().map(|m| (m - mean).powi(2)).sum();
                between += k * mean * mean;
                bins += 1.0;
                within += scatter;
                freedom += k - 1.0;
                power += mean * mean - scatter / (k * (k - 1.0));
            }
        }
    }
    if bins < 1.0 || within <= 0.0 {
        return (1.0, 0.0);
    }
    let ratio = (between / bins) / (within / freedom);
    let chance = FisherSnedecor::new(bins, freedom).map_or(1.0, |d| d.sf(ratio));
    (chance, (power / bins).max(0.0).sqrt())
}

/// Chance and rms of means of whole cycles, or of blocks where there are no cycles.
fn wandering(data: &Data, noise: &NoiseModel, channel: Channel, parts: &[(&Block, &Vec<f64>)]) -> (f64, f64) {
    let n = noise.of(channel);
    let (mut chi, mut freedom, mut power) = (0.0, 0.0, 0.0);
    for (block, values) in parts {
        let session = &data.sessions[block.session];
        // Noise that is correlated over a whole cycle cannot be told from a drift; correlation counts in full.
        let correlation = if session.phase.is_none() && n.declared { 1.0 } else { n.correlation };
        let mut means: BTreeMap<i64, (f64, f64)> = BTreeMap::new();
        let length = values.len() as f64;
        for (i, (value, _)) in
            values.iter().zip(&session.uses).enumerate().filter(|(_, (_, u))| **u != Use::Skip)
        {
            let key = match &session.phase {
                Some(phase) => phase[i].floor() as i64,
                None => (i as f64 / length * BLOCKS as f64) as i64,
            };
            let entry = means.entry(key).or_default();
            entry.0 += value;
            entry.1 += 1.0;
        }
        let fullest = means.values().map(|m| m.1).fold(0.0, f64::max);
        for (sum, count) in means.values().filter(|m| m.1 >= 0.8 * fullest) {
            let mean = sum / count;
            let variance = (n.floor * n.excess).powi(2) * correlation / count;
            chi += mean * mean / variance;
            freedom += 1.0;
            power += mean * mean - variance;
        }
    }
    if freedom < 1.0 {
        return (1.0, 0.0);
    }
    let chance = ChiSquared::new(freedom).map_or(1.0, |d| d.sf(chi));
    (chance, (power / freedom).max(0.0).sqrt())
}
