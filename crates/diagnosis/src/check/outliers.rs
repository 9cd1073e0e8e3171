//! Outliers: isolated readings far from the prediction by their neighbours.

use super::finding::{Finding, Severity};
use super::resolution::{inner, step};
use super::tuning;
use crate::digits::four_digits;
use crate::statistics::{range, robust_deviation};
use bench::{Bench, Channel, MeasuredLog, Role};

/// Finds isolated readings whose prediction error is many times the scatter of the errors around
/// them; returns for each row whether to keep it.
///
/// An impact is as short as an outlier. So a reading is no outlier if the simulation (`expected`)
/// has an impact nearby, or another output an event at the same time.
pub(super) fn find_outliers<'a>(
    bench: &Bench,
    log: &MeasuredLog,
    role: Role,
    expected: impl Fn(Channel) -> Option<&'a [f64]>,
    findings: &mut Vec<Finding>,
) -> Vec<bool> {
    let mut keep = vec![true; log.time_s.len()];
    let of_role = log.channels.iter().filter(|(c, _)| bench.role(**c) == role);
    let channels: Vec<(Channel, Neighbours<'_>)> = of_role
        .filter_map(|(&channel, values)| {
            let declared = bench.sensors().get(&channel).map_or(0.0, bench::signals::Sensor::floor);
            Some((channel, Neighbours::new(&log.time_s, values, expected(channel), declared)?))
        })
        .collect();
    for (channel, neighbours) in &channels {
        let has_event_elsewhere = |row: usize| {
            role == Role::Output && channels.iter().any(|(c, n)| c != channel && n.has_event_near(row))
        };
        let Some((found, largest)) = neighbours.outliers(has_event_elsewhere) else { continue };
        for row in &found {
            if let Some(keep) = keep.get_mut(*row) {
                *keep = false;
            }
        }
        let words = format!(
            "{} isolated readings up to {} {} off",
            found.len(),
            four_digits(largest),
            channel.unit()
        );
        findings.push(
            Finding::new(Severity::Doubtful, &log.source, channel.name(), "outliers", words)
                .cause("external interference, or a loose contact")
                .evidence("outliers", found.len() as f64)
                .evidence("rows", log.time_s.len() as f64)
                .evidence("largest", largest)
                .applied("left out these rows"),
        );
    }
    keep
}

/// Number of points that determine a cubic.
const CUBIC_POINTS: usize = 4;

/// Prediction of a reading: the cubic through the two good readings on either side, as a sum of
/// Lagrange polynomials.
fn predicted(time_s: &[f64], values: &[f64], good: &[bool], row: usize) -> Option<f64> {
    let before = (0..row).rev().filter(|&i| good.get(i) == Some(&true)).take(2);
    let after = (row + 1..values.len()).filter(|&i| good.get(i) == Some(&true)).take(2);
    let near: Vec<(f64, f64)> =
        before.chain(after).filter_map(|i| Some((*time_s.get(i)?, *values.get(i)?))).collect();
    if near.len() < CUBIC_POINTS {
        return None;
    }
    let t = *time_s.get(row)?;
    let term = |(j, &(tj, vj)): (usize, &(f64, f64))| {
        let others = near.iter().enumerate().filter(|(k, _)| *k != j);
        vj * others.map(|(_, (tk, _))| (t - tk) / (tj - tk)).product::<f64>()
    };
    Some(near.iter().enumerate().map(term).sum())
}

/// Readings and their predictions.
struct Neighbours<'a> {
    time_s: &'a [f64],
    values: &'a [f64],
    /// Reading minus prediction.
    errors: Vec<f64>,
    /// Scatter that the error of each reading is compared with.
    scatter: Vec<f64>,
}

impl<'a> Neighbours<'a> {
    fn new(time_s: &'a [f64], values: &'a [f64], expected: Option<&[f64]>, declared: f64) -> Option<Self> {
        let good = vec![true; values.len()];
        let errors: Vec<f64> = (0..values.len()).map(|row| error(time_s, values, &good, row)).collect();
        // Half a resolution step is no outlier.
        let inner = range(&inner(values));
        let full = range(values);
        let floor = robust_deviation(errors.iter().copied())
            .max(tuning::PREDICTION_SIGMAS * declared)
            .max(step(values).unwrap_or_default())
            .max(
                tuning::MIN_OUTLIER_SHARE
                    * if inner > 0.0 { full.min(tuning::GROSS_RANGE * inner) } else { full },
            );
        let around = |values: &[f64], row: usize, reach: usize| -> Vec<f64> {
            let to = (row + reach + 1).min(values.len());
            values.get(row.saturating_sub(reach)..to).unwrap_or_default().to_vec()
        };
        let expected_errors: Option<Vec<f64>> = expected
            .filter(|s| s.len() == values.len())
            .map(|s| (0..s.len()).map(|row| error(time_s, s, &good, row).abs()).collect());
        let scatter_at = |row: usize| {
            let local = robust_deviation(around(&errors, row, tuning::NEIGHBOURHOOD_ROWS).into_iter());
            let impact = |e: &Vec<f64>| around(e, row, tuning::IMPACT_ROWS).into_iter().fold(0.0, f64::max);
            floor.max(local).max(expected_errors.as_ref().map_or(0.0, impact))
        };
        let scatter = (0..values.len()).map(scatter_at).collect();
        (floor > 0.0).then_some(Self { time_s, values, errors, scatter })
    }

    /// Error of a reading in scatters.
    fn relative_error(&self, errors: &[f64], row: usize) -> f64 {
        errors.get(row).zip(self.scatter.get(row)).map_or(0.0, |(error, scatter)| error.abs() / scatter)
    }

    /// Returns whether this channel has an event at about the same time.
    fn has_event_near(&self, row: usize) -> bool {
        (row.saturating_sub(1)..=row + 1)
            .any(|i| self.relative_error(&self.errors, i) > tuning::COINCIDENCE_SIGMAS)
    }

    /// Rows of isolated outliers, and the largest error; `None` without any, or with so many that
    /// they are the channel's behaviour.
    fn outliers(&self, has_event_elsewhere: impl Fn(usize) -> bool) -> Option<(Vec<usize>, f64)> {
        let rows = self.values.len();
        let max = ((tuning::MAX_OUTLIER_SHARE * rows as f64) as usize).clamp(1, tuning::MAX_OUTLIERS);
        let is_suspect = |row: &usize| self.relative_error(&self.errors, *row) > tuning::SUSPECT_SIGMAS;
        let suspects: Vec<usize> = (0..rows).filter(is_suspect).collect();
        if suspects.len() > tuning::SUSPECTS_PER_OUTLIER * max {
            return None;
        }
        let worst = |errors: &[f64]| {
            let errors = suspects.iter().map(|&row| (row, self.relative_error(errors, row)));
            errors.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, error)| *error > tuning::OUTLIER_SIGMAS)
        };
        let (mut good, mut errors, mut found) = (vec![true; rows], self.errors.clone(), Vec::new());
        // The worst reading is removed first, because it disturbs the predictions of its
        // neighbours.
        while let Some((row, _)) = worst(&errors) {
            found.push(row);
            if let Some(good) = good.get_mut(row) {
                *good = false;
            }
            let reach = tuning::PREDICTION_REACH_ROWS;
            for i in row.saturating_sub(reach)..(row + reach + 1).min(rows) {
                let is_good = good.get(i) == Some(&true);
                if let Some(e) = errors.get_mut(i) {
                    *e = if is_good { error(self.time_s, self.values, &good, i) } else { 0.0 };
                }
            }
        }
        found.sort_unstable();
        let is_isolated = |run: &&[usize]| {
            run.len() <= tuning::MAX_OUTLIERS_IN_A_ROW && !run.iter().any(|&row| has_event_elsewhere(row))
        };
        let isolated: Vec<usize> =
            found.chunk_by(|a, b| b - a <= 1).filter(is_isolated).flatten().copied().collect();
        if isolated.is_empty() || isolated.len() > max {
            return None;
        }
        let size = |&row: &usize| error(self.time_s, self.values, &good, row).abs();
        let largest = isolated.iter().map(size).fold(0.0, f64::max);
        Some((isolated, largest))
    }
}

/// Reading minus prediction; 0 without a prediction.
fn error(time_s: &[f64], values: &[f64], good: &[bool], row: usize) -> f64 {
    predicted(time_s, values, good, row).zip(values.get(row)).map_or(0.0, |(p, v)| v - p)
}
