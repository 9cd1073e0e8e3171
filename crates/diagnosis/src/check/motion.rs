//! Relation of two signals of which one is the derivative of the other: `value = a + g
//! integral(rate) + b t + c rate`.
//!
//! `g` is the ratio of their gains, `c/g` the lead of the value over the rate in s, and `b` an
//! offset of the rate. The rate is integrated, because differentiating the value would amplify
//! noise. The integral across a gap of the log is unknown, so each run between gaps has its own
//! `a`.
//!
//! Limit: no relation is found in a log whose rows come in bursts of a few with gaps in between.

use super::tuning;
use crate::statistics::median;
use bench::statistics::mean;
use bench::{Bench, Channel, MeasuredLog};
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Driven motion of a log.
pub(super) struct Motion<'a> {
    pub(super) value: &'a [f64],
    rate: Option<&'a [f64]>,
}

/// Channels of the driven motion: value and rate.
pub(super) fn drive_channels(bench: &Bench) -> Option<(Channel, Channel)> {
    bench.drive_channels().map(|drive| (drive.position, drive.speed))
}

/// The driven motion of a log; `None` if its value was not measured.
pub(super) fn motion_of<'a>(bench: &Bench, log: &'a MeasuredLog) -> Option<Motion<'a>> {
    let (value, rate) = drive_channels(bench)?;
    let rate = log.channels.get(&rate).map(Vec::as_slice);
    Some(Motion { value: log.channels.get(&value)?, rate })
}

impl Motion<'_> {
    /// Ratio of the gains of value and rate, if they are related.
    pub(super) fn ratio(&self, time_s: &[f64]) -> Option<f64> {
        let relation = relation(time_s, self.value, self.rate?)?;
        (relation.unexplained_share < tuning::MAX_UNRELATED).then_some(relation.ratio)
    }
}

/// Relation of a value to its rate.
pub(super) struct Relation {
    /// Ratio of the gain of the value to that of the rate.
    pub(super) ratio: f64,
    /// Lead of the value over the rate, s.
    pub(super) lead_s: f64,
    /// Rms of the relation's residual over that of the value.
    pub(super) unexplained_share: f64,
}

/// Runs of rows between gaps; `None` if fewer than half of the rows are in runs that are long
/// enough.
fn runs(time_s: &[f64]) -> Option<Vec<Range<usize>>> {
    let intervals = || time_s.windows(2).map(|t| t.last().zip(t.first()).map_or(0.0, |(b, a)| b - a));
    let max_s = tuning::GAP_INTERVALS * median(intervals());
    let ends = intervals().enumerate().filter(|(_, d)| *d > max_s).map(|(i, _)| i + 1);
    let mut from = 0;
    let all = ends.chain([time_s.len()]).map(|to| std::mem::replace(&mut from, to)..to);
    let long: Vec<Range<usize>> = all.filter(|run| run.len() >= tuning::MIN_RUN_ROWS).collect();
    (2 * long.iter().map(Range::len).sum::<usize>() >= time_s.len()).then_some(long)
}

/// Fits the relation of two signals; `None` if one of them does not change, or cannot be separated.
pub(super) fn relation(time_s: &[f64], value: &[f64], rate: &[f64]) -> Option<Relation> {
    let runs = runs(time_s)?;
    let mut integral = vec![0.0; time_s.len()];
    let mut sum = 0.0;
    for (i, (t, v)) in time_s.windows(2).zip(rate.windows(2)).enumerate() {
        let (&[t0, t1], &[v0, v1]) = (t, v) else { return None };
        sum += 0.5 * (v0 + v1) * (t1 - t0);
        *integral.get_mut(i + 1)? = sum;
    }
    // Subtracting the mean of each run removes the unknown integral across the gaps.
    let centred = |values: &[f64]| {
        let centred_run = |run: &Range<usize>| {
            let values = values.get(run.clone()).unwrap_or_default();
            let mean = mean(values);
            values.iter().map(move |v| v - mean).collect::<Vec<_>>()
        };
        DVector::from_vec(runs.iter().flat_map(centred_run).collect())
    };
    let y = centred(value);
    let all = [centred(&integral), centred(rate), centred(time_s)];
    // Motion at constant speed does not separate an offset of the rate; then the offset is taken as
    // 0.
    for columns in [all.as_slice(), all.get(..2)?] {
        let norms: Vec<f64> = columns.iter().map(|c| c.norm()).collect();
        if !norms.iter().chain([&y.norm()]).all(|n| n.is_finite() && *n > 0.0) {
            return None;
        }
        let scaled: Vec<DVector<f64>> = columns.iter().zip(&norms).map(|(c, n)| c / *n).collect();
        let matrix = DMatrix::from_columns(&scaled);
        let normal = matrix.transpose() * &matrix;
        let svd = normal.try_svd(true, true, f64::EPSILON, tuning::MAX_SVD_SWEEPS)?;
        if svd.singular_values.min() < tuning::MIN_SINGULAR_RATIO * svd.singular_values.max() {
            continue;
        }
        let solution = svd.solve(&(matrix.transpose() * &y), 0.0).ok()?;
        let unexplained_share = (&y - &matrix * &solution).norm() / y.norm();
        let coefficient = |i: usize| Some(solution.get(i)? / norms.get(i)?);
        let ratio = coefficient(0)?;
        return Some(Relation { ratio, lead_s: coefficient(1)? / ratio, unexplained_share });
    }
    None
}
