//! Periodograms of a fitted base's residual over time or position: at which waves what repeats has most power.
//!
//! Coordinates are in s, m or rad, waves per unit of them; the residual is weighted, so that white noise has unit variance.
//! Direct sums, as samples are missing and positions uneven; up to 1e6 waves.

use crate::fit::Fit;
use crate::session::Data;
use rayon::prelude::*;

/// Steps of a periodogram in units of its resolution.
pub(crate) const FINENESS: f64 = 0.25;
/// Most guesses of a frequency or a wavelength, and how far above the highest peak of noise a channel's own has to be, in units
/// of the noise's power.
const MOST_PEAKS: usize = 4;
const CLEAR: f64 = 7.0;
/// Waves that a periodogram takes at once, a power of 2.
const BATCH: usize = 64;

/// The base's residual over a coordinate, one value a fitted sample with the number of its block.
pub(crate) struct Spectrum<'a> {
    pub(crate) data: &'a Data,
    pub(crate) base: &'a Fit,
    pub(crate) coordinates: Vec<(usize, f64)>,
}

/// A peak of a periodogram.
#[derive(Clone, Copy)]
struct Peak {
    waves: f64,
    /// Its power over that of white noise of unit variance.
    power: f64,
}

/// The highest peaks of all channels together and of each single one, in the order of the data's channels.
type Highest = (Peak, Vec<Peak>);

impl Spectrum<'_> {
    /// The highest peak of all channels together, and those of single ones that are clearly no noise: a base that is far off is wrong in
    /// several places, and what the effect itself adds may be the highest peak in one channel only.
    pub(crate) fn peaks(
        &self,
        used: &(impl Fn(f64) -> bool + Sync),
        steps: (f64, f64, f64),
    ) -> Vec<(Option<usize>, f64)> {
        let Some((together, single)) = self.highest(used, steps) else { return Vec::new() };
        let clear = ((steps.1 - steps.0) / steps.2).max(1.0).ln() + CLEAR;
        let mut single: Vec<(usize, Peak)> =
            single.into_iter().enumerate().filter(|(_, p)| p.power > clear).collect();
        single.sort_by(|a, b| b.1.power.total_cmp(&a.1.power));
        let mut peaks = vec![(None, together.waves)];
        for (channel, peak) in single {
            let apart = |(_, other): &(_, f64)| (other - peak.waves).abs() > steps.2 / FINENESS;
            if peaks.len() < MOST_PEAKS && peaks.iter().all(apart) {
                peaks.push((Some(channel), peak.waves));
            }
        }
        peaks
    }

    /// Waves per unit of the coordinate at which the residual of a channel, or of all together, has most power.
    pub(crate) fn peak(
        &self,
        channel: Option<usize>,
        used: &(impl Fn(f64) -> bool + Sync),
        steps: (f64, f64, f64),
    ) -> Option<f64> {
        let (together, single) = self.highest(used, steps)?;
        Some(channel.map_or(Some(together), |c| single.get(c).copied())?.waves)
    }

    /// The channels of a log share its coordinates, and neighbouring waves differ by a turn that is the same for all of them:
    /// of each sample and [`BATCH`] waves two sines are computed, the rest is products.
    fn highest(
        &self,
        used: &(impl Fn(f64) -> bool + Sync),
        (from, to, step): (f64, f64, f64),
    ) -> Option<Highest> {
        let count = ((to - from) / step).ceil();
        if !(1.0..1e6).contains(&count) {
            return None;
        }
        let count = count as usize;
        let channels = &self.data.channels;
        let block = |place: &(usize, f64)| self.data.blocks.get(place.0);
        let powers = |batch: usize| {
            let first = from + step * (batch * BATCH) as f64;
            // One row a channel.
            let mut powers = vec![[0.0; BATCH]; channels.len()];
            let (mut begin, mut samples) = (0, 0);
            let same = |a: &(usize, f64), b: &(usize, f64)| {
                block(a).map(|b| b.session) == block(b).map(|b| b.session)
            };
            for log in self.coordinates.chunk_by(same) {
                let mut parts: Vec<(usize, &[f64])> = Vec::new();
                for part in log.chunk_by(|a, b| a.0 == b.0) {
                    let own = part.first().and_then(block).map(|b| b.channel);
                    let row = channels.iter().position(|c| Some(*c) == own);
                    parts.extend(row.zip(self.base.residual.get(begin..begin + part.len())));
                    begin += part.len();
                }
                let length = log.iter().take_while(|c| Some(c.0) == log.first().map(|f| f.0)).count();
                let mut sums = vec![[[0.0; BATCH]; 2]; parts.len()];
                for (i, (_, x)) in log.iter().take(length).enumerate().filter(|(_, (_, x))| used(*x)) {
                    let [cosines, sines] = turns(first * x, step * x);
                    samples += 1;
                    for ((_, values), [c, s]) in parts.iter().zip(&mut sums) {
                        let r = values.get(i).copied().unwrap_or_default();
                        c.iter_mut().zip(&cosines).for_each(|(sum, v)| *sum += r * v);
                        s.iter_mut().zip(&sines).for_each(|(sum, v)| *sum += r * v);
                    }
                }
                for ((row, _), [c, s]) in parts.iter().zip(&sums) {
                    if let Some(powers) = powers.get_mut(*row) {
                        powers.iter_mut().zip(c.iter().zip(s)).for_each(|(p, (c, s))| *p += c * c + s * s);
                    }
                }
            }
            let best = |powers: &[f64; BATCH]| {
                let peak = |(k, power): (usize, &f64)| Peak {
                    waves: from + step * k as f64,
                    power: power / f64::from(samples.max(1)),
                };
                (batch * BATCH..count).zip(powers).map(peak).reduce(higher)
            };
            let mut together = [0.0; BATCH];
            for row in &powers {
                together.iter_mut().zip(row).for_each(|(sum, p)| *sum += p);
            }
            Some((best(&together)?, powers.iter().filter_map(best).collect()))
        };
        let batches: Vec<Highest> = (0..count.div_ceil(BATCH)).into_par_iter().filter_map(powers).collect();
        batches.into_iter().reduce(|a, b| {
            let single = a.1.into_iter().zip(b.1).map(|(a, b)| higher(a, b)).collect();
            (higher(a.0, b.0), single)
        })
    }
}

fn higher(a: Peak, b: Peak) -> Peak {
    if b.power > a.power { b } else { a }
}

/// Cosines and sines of `first`, `first + step`, ... turns.
fn turns(first: f64, step: f64) -> [[f64; BATCH]; 2] {
    let [mut cosines, mut sines] = [[0.0; BATCH]; 2];
    (sines[0], cosines[0]) = (std::f64::consts::TAU * first).sin_cos();
    let (mut sine, mut cosine) = (std::f64::consts::TAU * step).sin_cos();
    let mut known = 1;
    while known < BATCH {
        let ((c, new_c), (s, new_s)) = (cosines.split_at_mut(known), sines.split_at_mut(known));
        for ((c, s), (new_c, new_s)) in c.iter().zip(s.iter()).zip(new_c.iter_mut().zip(new_s)) {
            (*new_c, *new_s) = (c * cosine - s * sine, s * cosine + c * sine);
        }
        (cosine, sine) = (cosine * cosine - sine * sine, 2.0 * sine * cosine);
        known *= 2;
    }
    [cosines, sines]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_the_sines_of_their_angles() {
        let [cosines, sines] = turns(0.37, 0.213);
        for (k, (c, s)) in cosines.iter().zip(&sines).enumerate() {
            let (sine, cosine) = (std::f64::consts::TAU * (0.37 + 0.213 * k as f64)).sin_cos();
            assert!((c - cosine).abs() < 1e-12 && (s - sine).abs() < 1e-12, "{k}: {c} {s}");
        }
    }
}
