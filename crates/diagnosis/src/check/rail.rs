//! Rails: readings at the end of a sensor's range while the described bench goes beyond it.

use super::tuning;
use crate::statistics::median;
use std::ops::Range;

/// A channel's readings and their simulation by the described bench.
pub(super) struct Compared<'a> {
    pub(super) values: &'a [f64],
    pub(super) expected: &'a [f64],
    /// Difference that noise does not explain.
    pub(super) margin: f64,
}

impl Compared<'_> {
    /// Number of readings at rails, at either end.
    pub(super) fn rail_readings(&self) -> usize {
        [1.0, -1.0].into_iter().filter_map(|sign| self.rail(sign)).sum()
    }

    /// Number of readings at the largest value (at the smallest one for a negative sign), if the
    /// bench goes beyond it.
    fn rail(&self, sign: f64) -> Option<usize> {
        let value = sign * self.values.iter().map(|v| sign * v).fold(f64::NEG_INFINITY, f64::max);
        let at_end = || self.values.iter().zip(self.expected).filter(|(v, _)| **v == value);
        let count = at_end().count();
        let beyond = at_end().filter(|(_, s)| sign * (**s - value) > self.margin).count();
        let at_value = equal_runs(self.values).filter(|(from, _)| self.values.get(*from) == Some(&value));
        let long = at_value.filter(|(_, length)| *length >= tuning::MIN_RAIL_RUN).count();
        // A stuck sensor does not return to the same reading several times.
        let is_repeated = long >= tuning::MIN_RAIL_RETURNS;
        let share = if is_repeated { tuning::BEYOND_SHARE_REPEATED } else { tuning::BEYOND_SHARE };
        let is_rail = count >= tuning::MIN_RAIL_READINGS && long > 0 && beyond as f64 >= share * count as f64;
        is_rail.then_some(count)
    }

    /// Returns whether a run of equal readings is clipped at a rail: during most of the run the
    /// bench is not inside the range. A stuck sensor keeps its reading when the bench returns.
    pub(super) fn is_clipped(&self, run: Range<usize>, sign: f64) -> bool {
        let max_inside = tuning::MAX_INSIDE_SHARE * run.len() as f64;
        let is_inside = |beyond: &f64| -sign * beyond > self.margin;
        let inside = self.beyond(run).iter().filter(|b| is_inside(b)).count();
        inside as f64 <= max_inside
    }

    /// Distance of the bench beyond each reading of a run of equal ones. The simulation is shifted
    /// to agree with the readings before and after the run.
    fn beyond(&self, run: Range<usize>) -> Vec<f64> {
        let (values, expected) = (self.values, self.expected);
        let offset = |rows: Range<usize>| {
            let beside = values.get(rows.clone()).zip(expected.get(rows)).filter(|(v, _)| !v.is_empty());
            beside.map(|(v, s)| median(v.iter().zip(s).map(|(v, s)| v - s)))
        };
        let before = offset(run.start.saturating_sub(tuning::MIN_RUN)..run.start);
        let after = offset(run.end..(run.end + tuning::MIN_RUN).min(values.len()));
        let [before, after] = [before.or(after), after.or(before)].map(Option::unwrap_or_default);
        let value = values.get(run.start).copied().unwrap_or_default();
        let (start, length) = (run.start as f64, run.len() as f64);
        let shifted = |i: usize, s: &f64| s + before + (after - before) * (i as f64 - start) / length - value;
        run.filter_map(|i| Some(shifted(i, expected.get(i)?))).collect()
    }
}

/// Runs of equal readings, as first index and length.
pub(super) fn equal_runs(values: &[f64]) -> impl Iterator<Item = (usize, usize)> + '_ {
    let mut start = 0;
    values.chunk_by(|a, b| a == b).map(move |run| {
        start += run.len();
        (start - run.len(), run.len())
    })
}

/// The end of the readings at which a value lies: 1 for the largest reading, -1 for the smallest.
pub(super) fn end_of_range(values: &[f64], value: f64) -> Option<f64> {
    [1.0, -1.0].into_iter().find(|sign| values.iter().all(|v| sign * v <= sign * value))
}
