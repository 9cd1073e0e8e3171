//! Error on held-out samples before and after, with intervals from a block bootstrap.

use crate::fit::Fit;
use crate::noise::NoiseModel;
use crate::nuisance::simulate_all;
use crate::result::Gain;
use crate::session::{Columns, Data, Use};
use bench::Channel;
use bench::respond::RespondError;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

const DRAWS: usize = 500;
/// Any constant: the interval shall be the same on every run.
const SEED: u64 = 0x50_49_4e_54;
/// Blocks of a cycle: what is drawn again is held-out samples of one stretch of time, however many fitted ones lie between.
const BLOCKS_PER_CYCLE: f64 = 8.0;
/// The same where all that is asked is whether the error falls at all: what a cause explains may lie in an eighth of a cycle, and of so few blocks many a
/// draw would have none.
const FINE_BLOCKS_PER_CYCLE: f64 = 32.0;
const LEAST_BLOCK: usize = 8;

/// Sums of squares of a block of held-out samples, by channel in the data's order.
struct Sums {
    before: Vec<f64>,
    after: Vec<f64>,
    count: Vec<f64>,
}

fn blocks(data: &Data, per_cycle: f64, before: &Columns, after: &Columns) -> Vec<Sums> {
    let mut out = Vec::new();
    for (number, session) in data.sessions.iter().enumerate() {
        let cycles = session.phase.as_ref().and_then(|p| Some(p.last()? - p.first()?)).unwrap_or(1.0);
        let length = session.uses.len() as f64 / cycles.max(1.0) / per_cycle;
        let length = (length as usize).max(LEAST_BLOCK);
        let held: Vec<usize> = (0..session.uses.len()).filter(|i| session.uses[*i] == Use::Held).collect();
        for stretch in held.chunk_by(|a, b| a / length == b / length) {
            let zero = vec![0.0; data.channels.len()];
            let mut sums = Sums { before: zero.clone(), after: zero.clone(), count: zero };
            for (i, block) in data.blocks.iter().enumerate().filter(|(_, b)| b.session == number) {
                let Some(c) = data.channels.iter().position(|c| *c == block.channel) else { continue };
                let power = |columns: &Columns| stretch.iter().map(|k| columns[i][*k].powi(2)).sum::<f64>();
                sums.before[c] += power(before);
                sums.after[c] += power(after);
                sums.count[c] += stretch.len() as f64;
            }
            out.push(sums);
        }
    }
    out
}

/// Lower and upper end of the middle share of draws of a statistic over resampled blocks.
fn bootstrap(count: usize, tail: f64, statistic: impl Fn(&[usize]) -> f64) -> Option<[f64; 2]> {
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut draws: Vec<f64> = (0..DRAWS)
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

/// Whether the error on held-out samples falls, all channels in units of their noise, at the lower 95 % bound.
pub(crate) fn improves(
    data: &Data,
    noise: &NoiseModel,
    before: &Fit,
    after: &Fit,
) -> Result<bool, RespondError> {
    let residual = |fit: &Fit| -> Result<Columns, RespondError> {
        Ok(data.residual(&simulate_all(data, noise, &fit.model, &fit.z)?.0.columns))
    };
    let (b, a) = (residual(before)?, residual(after)?);
    let falls: Vec<f64> = blocks(data, FINE_BLOCKS_PER_CYCLE, &b, &a)
        .iter()
        .map(|s| {
            let of = |(i, &c): (usize, &Channel)| noise.weight(c).powi(2) * (s.before[i] - s.after[i]);
            data.channels.iter().enumerate().map(of).sum()
        })
        .collect();
    let fall = bootstrap(falls.len(), 0.05, |picks| picks.iter().map(|&i| falls[i]).sum());
    Ok(fall.is_some_and(|[low, _]| low > 0.0))
}

/// Share of the power above the noise, and its interval.
type Share = (Option<f64>, Option<[f64; 2]>);

fn share(sums: &[Sums], power: impl Fn(&Sums) -> (f64, f64, f64), effective: f64) -> Share {
    let total = |picks: &mut dyn Iterator<Item = usize>| {
        picks.fold((0.0, 0.0, 0.0), |t, i| {
            let p = power(&sums[i]);
            (t.0 + p.0, t.1 + p.1, t.2 + p.2)
        })
    };
    let of = |(before, after, noise): (f64, f64, f64)| ((before - after) / (before - noise)).min(1.0);
    let all = total(&mut (0..sums.len()));
    // Power that is lost in the scatter of the noise has no share worth telling.
    if all.0 - all.2 < 3.0 * all.2 * (2.0 / effective.max(1.0)).sqrt() {
        return (None, None);
    }
    (Some(of(all)), bootstrap(sums.len(), 0.025, |picks| of(total(&mut picks.iter().copied()))))
}

/// Gains by channel, and the share over all channels in units of their noise.
pub(crate) fn gains(
    data: &Data,
    noise: &NoiseModel,
    before: &Columns,
    after: &Columns,
) -> (Vec<Gain>, Share) {
    let sums = blocks(data, BLOCKS_PER_CYCLE, before, after);
    let floor = |c: Channel| noise.of(c).floor;
    let gains = data.channels.iter().enumerate().map(|(i, &channel)| {
        let power = |s: &Sums| (s.before[i], s.after[i], s.count[i] * floor(channel).powi(2));
        let count: f64 = sums.iter().map(|s| s.count[i]).sum();
        let rms = |read: fn(&Sums, usize) -> f64| {
            (sums.iter().map(|s| read(s, i)).sum::<f64>() / count.max(1.0)).sqrt()
        };
        let (explained_share, explained_share_ci95) =
            share(&sums, power, count / noise.of(channel).correlation);
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
    let whole = |s: &Sums| {
        data.channels.iter().enumerate().fold((0.0, 0.0, 0.0), |t, (i, &c)| {
            let w = floor(c).powi(-2);
            (t.0 + w * s.before[i], t.1 + w * s.after[i], t.2 + s.count[i])
        })
    };
    let gains = gains.collect();
    (gains, share(&sums, whole, noise.effective_samples(data)))
}
