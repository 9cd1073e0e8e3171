//! Periodograms of a fitted base's residual over time or position.
//!
//! Coordinates are in s, m or rad, and wave numbers in cycles per unit of them. The residual is
//! weighted, so white noise has unit variance. The sums are computed directly and not by a fast
//! Fourier transform, because samples may be missing and positions are uneven.

use super::tuning;
use crate::data::logs::Data;
use crate::fit::least_squares::Fit;
use rayon::prelude::*;

/// Number of wave numbers that are computed together; a power of 2. It sets the speed, and rounding
/// errors of the results only.
const BATCH: usize = 64;

/// Evenly spaced wave numbers.
#[derive(Clone, Copy)]
pub(crate) struct Grid {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) step: f64,
}

/// The base's residual over a coordinate: one value per fitted sample, with the index of its block.
pub(crate) struct Spectrum<'a> {
    pub(crate) data: &'a Data,
    pub(crate) base: &'a Fit,
    pub(crate) coordinates: Vec<(usize, f64)>,
}

/// A peak of a periodogram.
#[derive(Clone, Copy)]
struct Peak {
    waves: f64,
    /// Power relative to white noise of unit variance.
    power: f64,
}

/// Highest peaks: of all channels together, and of each one in the order of the data's channels.
type Highest = (Peak, Vec<Peak>);

impl Spectrum<'_> {
    /// The highest peak of all channels together, and significant peaks of single channels.
    ///
    /// A base that is far from the noise is wrong in several places, and the effect itself may be
    /// highest in one channel only.
    pub(crate) fn peaks(
        &self,
        is_used: &(impl Fn(f64) -> bool + Sync),
        grid: Grid,
    ) -> Vec<(Option<usize>, f64)> {
        let Some((together, single)) = self.highest(is_used, grid) else { return Vec::new() };
        let min_power = ((grid.to - grid.from) / grid.step).max(1.0).ln() + tuning::PEAK_MARGIN;
        let mut single: Vec<(usize, Peak)> =
            single.into_iter().enumerate().filter(|(_, p)| p.power > min_power).collect();
        single.sort_by(|a, b| b.1.power.total_cmp(&a.1.power));
        let mut peaks = vec![(None, together.waves)];
        for (channel, peak) in single {
            let resolution = grid.step / tuning::PERIODOGRAM_STEP;
            let is_separate = |(_, other): &(_, f64)| (other - peak.waves).abs() > resolution;
            if peaks.len() < tuning::MAX_PEAKS && peaks.iter().all(is_separate) {
                peaks.push((Some(channel), peak.waves));
            }
        }
        peaks
    }

    /// Wave number at which the residual of a channel, or of all channels together, has most power.
    pub(crate) fn peak(
        &self,
        channel: Option<usize>,
        is_used: &(impl Fn(f64) -> bool + Sync),
        grid: Grid,
    ) -> Option<f64> {
        let (together, single) = self.highest(is_used, grid)?;
        Some(channel.map_or(Some(together), |c| single.get(c).copied())?.waves)
    }

    /// Highest peaks of the periodogram on a grid of wave numbers.
    fn highest(&self, is_used: &(impl Fn(f64) -> bool + Sync), grid: Grid) -> Option<Highest> {
        let count = ((grid.to - grid.from) / grid.step).ceil();
        if !(1.0..tuning::MAX_WAVE_NUMBERS).contains(&count) {
            return None;
        }
        let count = count as usize;
        let batch_peaks = |batch: usize| {
            let first = grid.from + grid.step * (batch * BATCH) as f64;
            let (powers, samples) = self.powers(is_used, first, grid.step);
            let best = |powers: &[f64; BATCH]| {
                let peak = |(k, power): (usize, &f64)| Peak {
                    waves: grid.from + grid.step * k as f64,
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
        let batches: Vec<Highest> =
            (0..count.div_ceil(BATCH)).into_par_iter().filter_map(batch_peaks).collect();
        batches.into_iter().reduce(|a, b| {
            let single = a.1.into_iter().zip(b.1).map(|(a, b)| higher(a, b)).collect();
            (higher(a.0, b.0), single)
        })
    }

    /// Powers at a batch of wave numbers from `first` on, a row for each channel, and the number of
    /// samples used.
    ///
    /// The channels of a log share its coordinates, and neighbouring wave numbers differ by the
    /// same rotation. So each sample needs two sines for [`BATCH`] wave numbers, and products for
    /// everything else.
    fn powers(
        &self,
        is_used: &(impl Fn(f64) -> bool + Sync),
        first: f64,
        step: f64,
    ) -> (Vec<[f64; BATCH]>, u32) {
        let channels = &self.data.channels;
        let block = |place: &(usize, f64)| self.data.blocks.get(place.0);
        let is_same_log =
            |a: &(usize, f64), b: &(usize, f64)| block(a).map(|b| b.log) == block(b).map(|b| b.log);
        let mut powers = vec![[0.0; BATCH]; channels.len()];
        let (mut begin, mut samples) = (0, 0);
        for log in self.coordinates.chunk_by(is_same_log) {
            let mut parts: Vec<(usize, &[f64])> = Vec::new();
            for part in log.chunk_by(|a, b| a.0 == b.0) {
                let own = part.first().and_then(block).map(|b| b.channel);
                let row = channels.iter().position(|c| Some(*c) == own);
                parts.extend(row.zip(self.base.residual.get(begin..begin + part.len())));
                begin += part.len();
            }
            let length = log.iter().take_while(|c| Some(c.0) == log.first().map(|f| f.0)).count();
            let mut sums = vec![[[0.0; BATCH]; 2]; parts.len()];
            for (i, (_, x)) in log.iter().take(length).enumerate().filter(|(_, (_, x))| is_used(*x)) {
                let [cosines, sines] = cosines_and_sines(first * x, step * x);
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
        (powers, samples)
    }
}

/// The peak with more power; the first one if both are equal.
fn higher(a: Peak, b: Peak) -> Peak {
    if b.power > a.power { b } else { a }
}

/// Cosines and sines of `first`, `first + step`, ... cycles.
fn cosines_and_sines(first: f64, step: f64) -> [[f64; BATCH]; 2] {
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
    fn repeated_rotation_gives_the_cosine_and_sine_of_every_angle() {
        let [cosines, sines] = cosines_and_sines(0.37, 0.213);
        for (k, (c, s)) in cosines.iter().zip(&sines).enumerate() {
            let (sine, cosine) = (std::f64::consts::TAU * (0.37 + 0.213 * k as f64)).sin_cos();
            assert!((c - cosine).abs() < 1e-12 && (s - sine).abs() < 1e-12, "{k}: {c} {s}");
        }
    }
}
