//! Tests for structure that remains in the residual of the extended bench.
//!
//! * Repeatable structure: in logs of two and more cycles, an F test compares the means over bins
//!   of the cycle's phase with their scatter between cycles. The repeatable part is model error,
//!   the remainder is noise of any colour.
//! * Drift: a chi-square test compares the means of complete cycles with 0. A log without cycles is
//!   cut into short blocks instead, and relies on its declared noise, which is white by definition.
//! * Excess: if the noise is declared, a residual with a larger rms is structure, such as an
//!   oscillation that averages out in every bin. So is an excess in the held-out samples alone: a
//!   change in the held-out half does not repeat and may average out over a cycle.
//!
//! Structure below [`tuning::MIN_STRUCTURE_RMS`] of the noise is negligible, even if it is
//! significant.

use super::signature::describe;
use super::tuning;
use crate::data::logs::{Block, Columns, Data};
use crate::data::noise::NoiseModel;
use crate::data::split::Use;
use crate::data::tuning::RMS_SIGMAS;
use crate::statistics::square_deviations;
use bench::Channel;
use bench::statistics::mean;
use schemars::JsonSchema;
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};
use std::collections::BTreeMap;

/// Structure that remains in the residual.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct RemainingStructure {
    /// Channel that shows it most.
    pub channel: Channel,
    /// Sentence about the quantity that it varies with.
    #[serde(rename = "where")]
    pub place: String,
    /// Quantity that explains most of it.
    pub feature: &'static str,
    /// Rms in the unit of the channel.
    pub rms: f64,
    /// Rms in units of the noise.
    pub rms_over_noise: f64,
}

/// The strongest remaining structure, if any.
pub(crate) fn strongest_structure(
    data: &Data,
    noise: &NoiseModel,
    residual: &Columns,
) -> Option<RemainingStructure> {
    // Two tests of each channel share the error.
    let limit = tuning::STRUCTURE_FAMILY_ERROR / (2.0 * data.channels.len().max(1) as f64);
    let found = data.channels.iter().filter_map(|&channel| {
        let parts: Vec<(&Block, &Vec<f64>)> =
            data.blocks.iter().zip(residual).filter(|(b, _)| b.channel == channel).collect();
        let rms = [repeatable_structure(data, noise, channel, &parts), drift(data, noise, channel, &parts)]
            .into_iter()
            .filter(|(chance, rms)| {
                *chance < limit && *rms > tuning::MIN_STRUCTURE_RMS * noise.channel(channel).floor
            })
            .map(|(_, rms)| rms)
            .fold(
                excess_rms(noise, channel).max(held_out_excess_rms(data, noise, residual, channel)),
                f64::max,
            );
        (rms > 0.0).then_some((channel, rms, rms / noise.channel(channel).floor))
    });
    let (channel, rms, rms_over_noise) = found.max_by(|a, b| a.2.total_cmp(&b.2))?;
    let (feature, place) = describe(data, residual, channel);
    Some(RemainingStructure { channel, place, feature, rms, rms_over_noise })
}

/// Rms of a residual beyond its declared noise; 0 if it is no larger.
fn excess_rms(noise: &NoiseModel, channel: Channel) -> f64 {
    let n = noise.channel(channel);
    if n.is_declared() && n.excess > tuning::MAX_RMS_OVER_DECLARED {
        n.floor * (n.excess * n.excess - 1.0).sqrt()
    } else {
        0.0
    }
}

/// Rms of the held-out residual beyond the declared noise; 0 if it is no larger.
fn held_out_excess_rms(data: &Data, noise: &NoiseModel, residual: &Columns, channel: Channel) -> f64 {
    let n = noise.channel(channel);
    let squares =
        data.blocks.iter().zip(residual).filter(|(b, _)| b.channel == channel).flat_map(|(b, values)| {
            values.iter().zip(data.uses(b)).filter(|(_, u)| **u == Use::HeldOut).map(|(v, _)| v * v)
        });
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    let count = f64::max(count, 1.0);
    let power: f64 = sum / count - n.floor.powi(2);
    // An rms scatters by 1/sqrt(2 n).
    let scatter = RMS_SIGMAS * (n.correlation_samples / (2.0 * count)).sqrt();
    let max_rms = tuning::MAX_RMS_OVER_DECLARED + scatter;
    if n.is_declared() && power > (max_rms * max_rms - 1.0) * n.floor.powi(2) { power.sqrt() } else { 0.0 }
}

/// Returns whether the residual exceeds the declared noise in held-out samples only, in at least
/// one channel.
pub(crate) fn is_confined_to_held_out(data: &Data, noise: &NoiseModel, residual: &Columns) -> bool {
    data.channels
        .iter()
        .any(|&c| held_out_excess_rms(data, noise, residual, c) > 0.0 && excess_rms(noise, c) == 0.0)
}

/// Structure that repeats in every cycle: its probability by chance, and its rms.
fn repeatable_structure(
    data: &Data,
    noise: &NoiseModel,
    channel: Channel,
    parts: &[(&Block, &Vec<f64>)],
) -> (f64, f64) {
    let (mut between, mut bins, mut within, mut freedom, mut power) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (block, values) in parts {
        let log = &data.logs[block.log];
        let Some(phase) = &log.phase else { continue };
        let cycles = phase.last().zip(phase.first()).map_or(1.0, |(b, a)| b - a);
        let per_cycle = values.len() as f64 / cycles.max(1.0);
        // Bins several correlation times long are independent.
        let count = (per_cycle / (tuning::BIN_CORRELATION_TIMES * noise.channel(channel).correlation_samples))
            as usize;
        let count = count.clamp(tuning::MIN_PHASE_BINS, tuning::MAX_PHASE_BINS);
        // Sum and count of every bin of every cycle.
        let mut means: BTreeMap<(usize, i64), (f64, f64)> = BTreeMap::new();
        for ((value, phase), _) in values.iter().zip(phase).zip(&log.uses).filter(|(_, u)| **u != Use::Skip) {
            let bin = (phase.rem_euclid(1.0) * count as f64) as usize;
            let entry = means.entry((bin.min(count - 1), phase.floor() as i64)).or_default();
            entry.0 += value;
            entry.1 += 1.0;
        }
        for bin in 0..count {
            let full: Vec<f64> = means
                .range((bin, i64::MIN)..=(bin, i64::MAX))
                .filter(|(_, (_, n))| *n >= tuning::MIN_BIN_FILL * per_cycle / count as f64)
                .map(|(_, (sum, n))| sum / n)
                .collect();
            let k = full.len() as f64;
            if k >= 2.0 {
                let mean = mean(&full);
                let scatter = square_deviations(&full, mean);
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

/// Drift of the means of complete cycles, or of blocks in a log without cycles: its probability by
/// chance, and its rms.
fn drift(data: &Data, noise: &NoiseModel, channel: Channel, parts: &[(&Block, &Vec<f64>)]) -> (f64, f64) {
    let n = noise.channel(channel);
    let (mut chi, mut freedom, mut power) = (0.0, 0.0, 0.0);
    for (block, values) in parts {
        let log = &data.logs[block.log];
        // Noise that is correlated over a complete cycle looks like a drift, so its correlation is
        // not limited to that of sensor noise.
        let correlation = if log.phase.is_none() && n.is_declared() { 1.0 } else { n.correlation_samples };
        let mut means: BTreeMap<i64, (f64, f64)> = BTreeMap::new();
        let length = values.len() as f64;
        for (i, (value, _)) in values.iter().zip(&log.uses).enumerate().filter(|(_, (_, u))| **u != Use::Skip)
        {
            let key = match &log.phase {
                Some(phase) => phase[i].floor() as i64,
                None => (i as f64 / length * tuning::DRIFT_BLOCKS as f64) as i64,
            };
            let entry = means.entry(key).or_default();
            entry.0 += value;
            entry.1 += 1.0;
        }
        let fullest = means.values().map(|m| m.1).fold(0.0, f64::max);
        for (sum, count) in means.values().filter(|m| m.1 >= tuning::MIN_BLOCK_FILL * fullest) {
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
