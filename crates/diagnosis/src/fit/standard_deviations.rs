//! Standard deviations of estimates, also if the noise model does not hold.
//!
//! Given weighted sensitivities `J`, residual `r`, precisions `P` of the priors and `A = J'J + P`,
//! three covariances are computed:
//!
//! * `A^-1`: the noise is as the model says, the same everywhere. [`crate::data::noise`] has
//!   already inflated it by excess and correlation.
//! * the sandwich `A^-1 (B + P) A^-1` with `B = G/(G-1) sum s_b s_b'` and scores `s_b = J_b' r_b`
//!   of `G` blocks longer than the correlation (Liang and Zeger 1986). It allows for noise that is
//!   larger where a parameter has its information, such as at reversals.
//! * the same over `G` logs, or over cycles if there are fewer than three logs, widened by the
//!   ratio of Student's t with `G - 1` degrees of freedom to the normal distribution. A difference
//!   between logs shifts all samples of a log, so more samples do not average it out. This
//!   covariance counts only if the scores of the logs differ by more than sensor noise explains,
//!   tested at [`tuning::GROUP_TEST_LEVEL`].
//!
//! The largest one is reported, so an interval is too wide rather than too narrow if they disagree.
//! If the noise model holds, the scatter of the sandwich widens intervals by a few per cent. None
//! of the three includes curvature of the model or a bias that all logs share.

use super::least_squares::Fit;
use super::linear::cholesky;
use super::tuning;
use crate::data::logs::{Data, Log};
use crate::data::noise::NoiseModel;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};
use std::collections::BTreeMap;

/// Standard deviations in scaled units; a 95 % interval extends [`tuning::Z_95`] of them to either
/// side.
pub(crate) fn standard_deviations(data: &Data, noise: &NoiseModel, fit: &Fit) -> Vec<f64> {
    let plain = fit.linear_standard_deviations();
    let Some(inverse) = cholesky(&fit.information()).map(|c| c.inverse()) else { return plain };
    let sensor_shares: Vec<f64> = data
        .map_fitted(|_, _| 0.0)
        .iter()
        .map(|(b, _)| noise.channel(data.blocks[*b].channel).sensor_share())
        .collect();
    let within = sandwich(fit, &inverse, &scores(fit, &time_block(data, noise), None));
    let between = between(&inverse, &scores(fit, &log_or_cycle(data), Some(&sensor_shares)));
    let larger = |i: usize| {
        let other = |v: &[f64]| v.get(i).copied().unwrap_or_default();
        plain[i].max(other(&within)).max(other(&between))
    };
    (0..plain.len()).map(larger).collect()
}

/// Group of each fitted sample: its log and its block of time, over all channels.
fn time_block(data: &Data, noise: &NoiseModel) -> Vec<usize> {
    let correlation = data.channels.iter().map(|c| noise.channel(*c).correlation_samples).fold(1.0, f64::max);
    let length = |samples: usize| {
        (tuning::BLOCK_CORRELATION_TIMES * correlation)
            .max((samples / tuning::MAX_BLOCKS_PER_LOG) as f64)
            .ceil()
            .max(1.0)
    };
    numbered(data, |log, i| (log.index, i / length(log.uses.len()) as usize))
}

/// Group of each fitted sample: its log, or its cycle if there are few logs.
fn log_or_cycle(data: &Data) -> Vec<usize> {
    let has_enough_logs = data.logs.len() >= tuning::MIN_GROUPS;
    numbered(data, |log, i| {
        let cycle = log.phase.as_ref().and_then(|p| p.get(i)).map_or(0, |p| p.floor().max(0.0) as usize);
        (log.index, if has_enough_logs { 0 } else { cycle })
    })
}

/// Numbers the distinct labels of the fitted samples in order of their first occurrence.
fn numbered(data: &Data, label: impl Fn(&Log, usize) -> (usize, usize)) -> Vec<usize> {
    let mut numbers = BTreeMap::new();
    let mut out = Vec::new();
    for block in &data.blocks {
        let log = &data.logs[block.log];
        for i in log.fitted_samples() {
            let next = numbers.len();
            out.push(*numbers.entry(label(log, i)).or_insert(next));
        }
    }
    out
}

/// Score of a group of samples, and the covariance of that score under sensor noise alone.
struct Group {
    score: DVector<f64>,
    fisher: DMatrix<f64>,
}

/// Scores of groups; their covariances too if the share of sensor noise in the variance of each
/// sample is given.
fn scores(fit: &Fit, groups: &[usize], sensor_shares: Option<&[f64]>) -> Vec<Group> {
    let n = fit.jacobian.len();
    let count = groups.iter().max().map_or(0, |max| max + 1);
    let mut out: Vec<Group> =
        (0..count).map(|_| Group { score: DVector::zeros(n), fisher: DMatrix::zeros(n, n) }).collect();
    for (k, (&group, r)) in groups.iter().zip(&fit.residual).enumerate() {
        let Some(group) = out.get_mut(group) else { continue };
        for i in 0..n {
            group.score[i] += fit.jacobian[i][k] * r;
        }
        let Some(share) = sensor_shares.and_then(|shares| shares.get(k)) else { continue };
        for i in 0..n {
            for j in 0..=i {
                group.fisher[(i, j)] += share * fit.jacobian[i][k] * fit.jacobian[j][k];
            }
        }
    }
    out.iter_mut().for_each(|g| g.fisher.fill_upper_triangle_with_lower_triangle());
    out
}

/// Standard deviations from the scores of blocks; none if there are few blocks.
fn sandwich(fit: &Fit, inverse: &DMatrix<f64>, blocks: &[Group]) -> Vec<f64> {
    let count = blocks.len();
    if count < tuning::MIN_BLOCKS {
        return Vec::new();
    }
    let small_sample = count as f64 / (count as f64 - 1.0);
    let variance = |i: usize| {
        let row = inverse.column(i);
        let scatter: f64 = blocks.iter().map(|g| row.dot(&g.score).powi(2)).sum();
        let priors = fit.model.parameters.iter().zip(row.iter()).map(|(p, v)| p.precision * v * v);
        small_sample * scatter + priors.sum::<f64>()
    };
    (0..inverse.nrows()).map(|i| variance(i).sqrt()).collect()
}

/// Standard deviations from the scores of logs; 0 if these differ by sensor noise alone.
fn between(inverse: &DMatrix<f64>, logs: &[Group]) -> Vec<f64> {
    let count = logs.len();
    let freedom = count as f64 - 1.0;
    if count < tuning::MIN_GROUPS {
        return Vec::new();
    }
    let (Ok(chi), Ok(student)) = (ChiSquared::new(freedom), StudentsT::new(0.0, 1.0, freedom)) else {
        return Vec::new();
    };
    let max = chi.inverse_cdf(1.0 - tuning::GROUP_TEST_LEVEL);
    let widening = student.inverse_cdf(1.0 - tuning::TAIL_95) / tuning::Z_95;
    let deviation = |i: usize| {
        let row = inverse.column(i);
        let scatter: Vec<f64> = logs.iter().map(|g| row.dot(&g.score).powi(2)).collect();
        let expected = logs.iter().map(|g| (&g.fisher * row).dot(&row));
        let ratios = scatter.iter().zip(expected).filter(|(_, e)| *e > 0.0).map(|(m, e)| m / e);
        if ratios.sum::<f64>() <= max {
            return 0.0;
        }
        widening * (count as f64 / freedom * scatter.iter().sum::<f64>()).sqrt()
    };
    (0..inverse.nrows()).map(deviation).collect()
}
