//! Error on held-out samples before and after, with intervals from a block bootstrap.

use super::held_out_nuisances::simulate_all;
use super::least_squares::Fit;
use super::tuning;
use crate::data::logs::{Columns, Data};
use crate::data::noise::NoiseModel;
use crate::data::split::Use;
use bench::Channel;
use bench::simulate::RespondError;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use schemars::JsonSchema;
use serde::Serialize;

/// Error of one channel before and after the extension.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Gain {
    /// Channel.
    pub channel: Channel,
    /// Rms residual of the calibrated nominal bench, or of the bench without one of its causes.
    pub baseline_rms: f64,
    /// Rms residual of the extended bench.
    pub extended_rms: f64,
    /// Rms of the sensor's noise.
    pub noise_rms: f64,
    /// True if the figures are of held-out samples.
    pub held_out: bool,
    /// Share of the residual power above the noise that the extension removes; null if there is no
    /// such power.
    pub explained_share: Option<f64>,
    /// 95 % interval of that share, from a block bootstrap.
    pub explained_share_ci95: Option<[f64; 2]>,
}

/// Sums over a block of held-out samples, by channel in the order of the data.
struct Sums {
    /// Squares of the residual before the extension.
    before: Vec<f64>,
    /// Squares of the residual after the extension.
    after: Vec<f64>,
    /// Number of samples.
    count: Vec<f64>,
}

/// Sums over blocks of held-out samples, of which a cycle has `per_cycle`.
fn held_out_blocks(data: &Data, per_cycle: f64, before: &Columns, after: &Columns) -> Vec<Sums> {
    let mut out = Vec::new();
    for (number, log) in data.logs.iter().enumerate() {
        let cycles = log.phase.as_ref().and_then(|p| Some(p.last()? - p.first()?)).unwrap_or(1.0);
        let length = log.uses.len() as f64 / cycles.max(1.0) / per_cycle;
        let length = (length as usize).max(tuning::MIN_BLOCK_SAMPLES);
        let held_out: Vec<usize> = (0..log.uses.len()).filter(|i| log.uses[*i] == Use::HeldOut).collect();
        for period in held_out.chunk_by(|a, b| a / length == b / length) {
            let zero = vec![0.0; data.channels.len()];
            let mut sums = Sums { before: zero.clone(), after: zero.clone(), count: zero };
            for (i, block) in data.blocks.iter().enumerate().filter(|(_, b)| b.log == number) {
                let Some(c) = data.channels.iter().position(|c| *c == block.channel) else { continue };
                let power = |columns: &Columns| period.iter().map(|k| columns[i][*k].powi(2)).sum::<f64>();
                sums.before[c] += power(before);
                sums.after[c] += power(after);
                sums.count[c] += period.len() as f64;
            }
            out.push(sums);
        }
    }
    out
}

/// Quantiles `tail` and `1 - tail` of a statistic over resampled blocks.
fn bootstrap(count: usize, tail: f64, statistic: impl Fn(&[usize]) -> f64) -> Option<[f64; 2]> {
    let mut rng = ChaCha8Rng::seed_from_u64(tuning::BOOTSTRAP_SEED);
    let mut draws: Vec<f64> = (0..tuning::BOOTSTRAP_DRAWS)
        .map(|_| {
            let picks: Vec<usize> =
                (0..count).map(|_| (rng.next_u64() % count.max(1) as u64) as usize).collect();
            statistic(&picks)
        })
        .filter(|v| v.is_finite())
        .collect();
    draws.sort_by(f64::total_cmp);
    let low = (tail * draws.len() as f64) as usize;
    Some([*draws.get(low)?, *draws.get(draws.len().checked_sub(low + 1)?)?])
}

/// Returns whether the error on held-out samples, a weighted sum over all channels, falls
/// significantly, at [`tuning::IMPROVEMENT_LEVEL`].
pub(crate) fn lowers_held_out_error(
    data: &Data,
    noise: &NoiseModel,
    before: &Fit,
    after: &Fit,
) -> Result<bool, RespondError> {
    let residual = |fit: &Fit| all_residuals(data, noise, fit);
    Ok(is_lower(data, noise, &residual(before)?, &residual(after)?))
}

/// Residual of all samples, held-out logs with nuisance parameters of their own.
pub(crate) fn all_residuals(data: &Data, noise: &NoiseModel, fit: &Fit) -> Result<Columns, RespondError> {
    Ok(data.residual(&simulate_all(data, noise, &fit.model, &fit.z)?.0.columns))
}

/// Returns whether residuals are significantly lower on held-out samples, as
/// [`lowers_held_out_error`] does.
pub(crate) fn is_lower(data: &Data, noise: &NoiseModel, before: &Columns, after: &Columns) -> bool {
    let falls: Vec<f64> = held_out_blocks(data, tuning::IMPROVEMENT_BLOCKS_PER_CYCLE, before, after)
        .iter()
        .map(|s| {
            let fall_of = |(i, &c): (usize, &Channel)| noise.weight(c).powi(2) * (s.before[i] - s.after[i]);
            data.channels.iter().enumerate().map(fall_of).sum()
        })
        .collect();
    let fall =
        bootstrap(falls.len(), tuning::IMPROVEMENT_LEVEL, |picks| picks.iter().map(|&i| falls[i]).sum());
    fall.is_some_and(|[low, _]| low > 0.0)
}

/// Share of the power above the noise, and its 95 % interval.
type Share = (Option<f64>, Option<[f64; 2]>);

/// Share of the `power` (before, after and of the noise) that the extension removes; none if the
/// power before is within the scatter of the noise of `effective` independent samples.
fn explained_share(sums: &[Sums], power: impl Fn(&Sums) -> (f64, f64, f64), effective: f64) -> Share {
    let total = |picks: &mut dyn Iterator<Item = usize>| {
        picks.fold((0.0, 0.0, 0.0), |t, i| {
            let p = power(&sums[i]);
            (t.0 + p.0, t.1 + p.1, t.2 + p.2)
        })
    };
    let share_of = |(before, after, noise): (f64, f64, f64)| ((before - after) / (before - noise)).min(1.0);
    let all = total(&mut (0..sums.len()));
    if all.0 - all.2 < tuning::MIN_POWER_SIGMAS * all.2 * (2.0 / effective.max(1.0)).sqrt() {
        return (None, None);
    }
    let interval =
        bootstrap(sums.len(), tuning::TAIL_95, |picks| share_of(total(&mut picks.iter().copied())));
    (Some(share_of(all)), interval)
}

/// Gains by channel, and the explained share over all channels in units of their noise.
pub(crate) fn gains(
    data: &Data,
    noise: &NoiseModel,
    before: &Columns,
    after: &Columns,
) -> (Vec<Gain>, Share) {
    let sums = held_out_blocks(data, tuning::GAIN_BLOCKS_PER_CYCLE, before, after);
    let floor = |c: Channel| noise.channel(c).floor;
    let gains = data.channels.iter().enumerate().map(|(i, &channel)| {
        let power = |s: &Sums| (s.before[i], s.after[i], s.count[i] * floor(channel).powi(2));
        let count: f64 = sums.iter().map(|s| s.count[i]).sum();
        let rms = |read: fn(&Sums, usize) -> f64| {
            (sums.iter().map(|s| read(s, i)).sum::<f64>() / count.max(1.0)).sqrt()
        };
        let (explained_share, explained_share_ci95) =
            explained_share(&sums, power, count / noise.channel(channel).correlation_samples);
        Gain {
            channel,
            baseline_rms: rms(|s, i| s.before[i]),
            extended_rms: rms(|s, i| s.after[i]),
            noise_rms: floor(channel),
            held_out: true,
            explained_share,
            explained_share_ci95,
        }
    });
    let weighted = |s: &Sums| {
        data.channels.iter().enumerate().fold((0.0, 0.0, 0.0), |t, (i, &c)| {
            let w = floor(c).powi(-2);
            (t.0 + w * s.before[i], t.1 + w * s.after[i], t.2 + s.count[i])
        })
    };
    let gains = gains.collect();
    (gains, explained_share(&sums, weighted, noise.effective_samples(data)))
}
