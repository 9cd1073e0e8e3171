//! Assignment of each sample of a log: fitted, held out, for calibration, or skipped.

use super::tuning;

/// Rule that chooses the held-out samples of a log with two or more cycles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Split {
    /// Holds out the second half of the cycles.
    ///
    /// An imitation that fits one half seldom predicts the other. A change in the second half
    /// cannot be learnt.
    Halves,
    /// Divides each cycle into short blocks and holds out every second one; the blocks that one
    /// cycle holds out are fitted in the next.
    ///
    /// So every phase of the motion and every part of the log is both fitted and held out. A block
    /// is several times longer than the correlation of a sensor's noise. Errors that are correlated
    /// over longer times affect both sets.
    Interleaved,
}

/// Use of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Use {
    /// Row that is not used.
    Skip,
    /// Fitted.
    Fit,
    /// Held out: never fitted, but counted in the noise floors and in the choice between causes.
    HeldOut,
    /// Calibrates the nuisance parameters of a held-out log, and nothing else.
    Calibrate,
}

/// Times and phases of a log that its split depends on.
pub(crate) struct Timeline<'a> {
    pub(crate) time_s: &'a [f64],
    pub(crate) phase: Option<&'a [f64]>,
    /// First and last time of the samples that are used, s.
    pub(crate) used_s: (f64, f64),
}

impl Timeline<'_> {
    /// Uses of the samples of a log that is fitted: a part is held out if `split` is given.
    pub(crate) fn fitted_uses(&self, split: Option<Split>) -> Vec<Use> {
        let start = self.time_s.first().copied().unwrap_or_default();
        let end = self.time_s.last().copied().unwrap_or_default();
        let cycles = cycle_count(self.phase);
        let complete = (cycles + tuning::MISSING_CYCLE_SHARE).floor();
        // The first half of the complete cycles, rounded up, is fitted.
        let held_out_from = start + (end - start) * (0.5 * complete).ceil() / cycles.max(1.0);
        let block_s = (end - start) / tuning::BLOCKS_WITHOUT_CYCLES as f64;
        let per_cycle = self.time_s.len() as f64 / cycles.max(1.0);
        let blocks = largest_odd(tuning::BLOCKS_PER_CYCLE.min(per_cycle / tuning::MIN_BLOCK_SAMPLES));
        let phase = |i: usize| self.phase.and_then(|p| p.get(i)).copied().unwrap_or_default();
        self.assign_uses(|i, t| {
            let is_held_out = match split {
                None => false,
                Some(Split::Interleaved) if complete >= 2.0 => {
                    (phase(i) * blocks).floor().rem_euclid(2.0) >= 0.5
                }
                Some(Split::Halves) if complete >= 2.0 => t >= held_out_from,
                Some(_) => ((t - start) / block_s) as usize % 2 == 1,
            };
            if is_held_out { Use::HeldOut } else { Use::Fit }
        })
    }

    /// Uses of the samples of a log that is held out completely.
    ///
    /// With `has_nuisances` its first cycle, or its first eighth if it has fewer than two cycles,
    /// calibrates its nuisance parameters.
    pub(crate) fn held_out_uses(&self, has_nuisances: bool) -> Vec<Use> {
        let mut uses = self.assign_uses(|_, _| Use::HeldOut);
        if has_nuisances {
            let used: Vec<usize> = (0..uses.len()).filter(|&i| uses.get(i) == Some(&Use::HeldOut)).collect();
            let first_cycle = self.phase.and_then(|phase| {
                let start = *phase.get(*used.first()?)?;
                (last_of(phase) - start >= 2.0).then(|| phase.partition_point(|p| *p < start + 1.0))
            });
            let eighth = used.get(used.len() / tuning::CALIBRATION_DIVISOR).copied().unwrap_or_default();
            let end = first_cycle.unwrap_or(eighth);
            let calibrating = uses.iter_mut().take(end).filter(|u| **u == Use::HeldOut);
            calibrating.for_each(|u| *u = Use::Calibrate);
        }
        uses
    }

    fn assign_uses(&self, assign: impl Fn(usize, f64) -> Use) -> Vec<Use> {
        let (from, to) = self.used_s;
        let use_of = |(i, &t): (usize, &f64)| if t < from || t > to { Use::Skip } else { assign(i, t) };
        self.time_s.iter().enumerate().map(use_of).collect()
    }
}

/// Cycles that a phase covers; 0 without a phase.
pub(crate) fn cycle_count(phase: Option<&[f64]>) -> f64 {
    phase.map_or(0.0, |p| last_of(p) - p.first().copied().unwrap_or_default())
}

/// Largest odd integer up to a value, at least 1.
fn largest_odd(value: f64) -> f64 {
    (2.0 * (0.5 * (value - 1.0)).floor() + 1.0).max(1.0)
}

fn last_of(values: &[f64]) -> f64 {
    values.last().copied().unwrap_or_default()
}
