//! Standard deviations of estimates that hold where the model of the noise does not.
//!
//! With weighted sensitivities `J`, residual `r`, precisions `P` of the priors and `A = J'J + P`, three answers for each parameter:
//!
//! * `A^-1`: the noise is as the model says, the same everywhere ([`crate::noise`] has already widened it by excess and correlation);
//! * the sandwich `A^-1 (B + P) A^-1`, `B = G/(G-1) sum s_b s_b'`, with scores `s_b = J_b' r_b` of `G` stretches that are longer than the
//!   correlation (Liang and Zeger 1986): noise may be larger where a parameter has its information, as at reversals;
//! * the same over whole sessions, or over whole cycles where there are fewer than three sessions, as a factor of Student's t with `G - 1`
//!   degrees over the normal one: what differs from session to session moves an estimate as a whole, and many samples of
//!   few sessions do not average it out. It counts where the scores of the sessions differ by more than the sensors' own noise makes them in
//!   [`CHANCE`] of all cases: of three sessions alone it would be three times too wide nearly always.
//!
//! The largest stands. So an interval is too wide rather than too narrow where the three disagree; in a log with the
//! noise that the model says the sandwich's own scatter makes it wider by some per cent. What none of them sees: a
//! bend of the model beyond its sensitivities, and a bias that all sessions share.

use crate::fit::Fit;
use crate::linear::factor;
use crate::noise::NoiseModel;
use crate::session::Data;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};
use std::collections::BTreeMap;

/// Factor of a standard deviation to a 95 % interval.
pub(crate) const NINETY_FIVE: f64 = 1.96;
/// Length of a stretch in correlation times, and most stretches of a session.
const STRETCH: f64 = 8.0;
const MOST_STRETCHES: usize = 64;
/// Stretches below which a sandwich says nothing.
const LEAST_STRETCHES: usize = 8;
/// Sessions, or cycles, below which nothing is known between them.
const LEAST_SESSIONS: usize = 3;
/// Chance that sessions which differ by the noise alone count as different.
const CHANCE: f64 = 0.05;

/// The standard deviations in scaled units: a 95 % interval is [`NINETY_FIVE`] of them to either side.
pub(crate) fn deviations(data: &Data, noise: &NoiseModel, fit: &Fit) -> Vec<f64> {
    let plain = fit.deviations();
    let Some(inverse) = factor(&fit.information()).map(|c| c.inverse()) else { return plain };
    let own: Vec<f64> =
        data.stacked(|_, _| 0.0).iter().map(|(b, _)| noise.of(data.blocks[*b].channel).own_share()).collect();
    let stretched = scores(fit, &stretches(data, noise), None);
    let within = sandwich(fit, &inverse, &stretched);
    let between = between(&inverse, &scores(fit, &groups(data), Some(&own)));
    let larger = |i: usize| {
        let other = |v: &[f64]| v.get(i).copied().unwrap_or_default();
        plain[i].max(other(&within)).max(other(&between))
    };
    (0..plain.len()).map(larger).collect()
}

/// The group of each fitted sample: every stretch of every session is one, over all channels.
fn stretches(data: &Data, noise: &NoiseModel) -> Vec<usize> {
    let correlation = data.channels.iter().map(|c| noise.of(*c).correlation).fold(1.0, f64::max);
    let length =
        |samples: usize| (STRETCH * correlation).max((samples / MOST_STRETCHES) as f64).ceil().max(1.0);
    let place = |(session, i): (usize, usize), samples: usize| (session, i / length(samples) as usize);
    numbered(data, |s, i| place((s.number, i), s.uses.len()))
}

/// The group of each fitted sample: its session, or its cycle where there are few sessions.
fn groups(data: &Data) -> Vec<usize> {
    let by_session = data.sessions.len() >= LEAST_SESSIONS;
    numbered(data, |s, i| {
        let cycle = s.phase.as_ref().and_then(|p| p.get(i)).map_or(0, |p| p.floor().max(0.0) as usize);
        (s.number, if by_session { 0 } else { cycle })
    })
}

/// Numbers the distinct labels of the fitted samples in the order in which they first come.
fn numbered(data: &Data, label: impl Fn(&crate::session::Session, usize) -> (usize, usize)) -> Vec<usize> {
    let mut numbers = BTreeMap::new();
    let mut out = Vec::new();
    for block in &data.blocks {
        let session = &data.sessions[block.session];
        for i in session.fitted() {
            let next = numbers.len();
            out.push(*numbers.entry(label(session, i)).or_insert(next));
        }
    }
    out
}

/// What a group of samples says: its score, and what the sensors' own noise would make of its covariance.
struct Group {
    score: DVector<f64>,
    fisher: DMatrix<f64>,
}

/// The scores of groups; with the share of each sample's variance that is its sensor's own also what that makes of their covariance.
fn scores(fit: &Fit, groups: &[usize], own: Option<&[f64]>) -> Vec<Group> {
    let n = fit.jacobian.len();
    let count = groups.iter().max().map_or(0, |most| most + 1);
    let mut out: Vec<Group> =
        (0..count).map(|_| Group { score: DVector::zeros(n), fisher: DMatrix::zeros(n, n) }).collect();
    for (k, (&group, r)) in groups.iter().zip(&fit.residual).enumerate() {
        let Some(group) = out.get_mut(group) else { continue };
        for i in 0..n {
            group.score[i] += fit.jacobian[i][k] * r;
        }
        let Some(share) = own.and_then(|own| own.get(k)) else { continue };
        for i in 0..n {
            for j in 0..=i {
                group.fisher[(i, j)] += share * fit.jacobian[i][k] * fit.jacobian[j][k];
            }
        }
    }
    out.iter_mut().for_each(|g| g.fisher.fill_upper_triangle_with_lower_triangle());
    out
}

/// Standard deviations by the scores of stretches; none where these are few.
fn sandwich(fit: &Fit, inverse: &DMatrix<f64>, stretches: &[Group]) -> Vec<f64> {
    let count = stretches.len();
    if count < LEAST_STRETCHES {
        return Vec::new();
    }
    let factor = count as f64 / (count as f64 - 1.0);
    let variance = |i: usize| {
        let row = inverse.column(i);
        let moved: f64 = stretches.iter().map(|g| row.dot(&g.score).powi(2)).sum();
        let priors = fit.model.parameters.iter().zip(row.iter()).map(|(p, v)| p.precision * v * v);
        factor * moved + priors.sum::<f64>()
    };
    (0..inverse.nrows()).map(|i| variance(i).sqrt()).collect()
}

/// Standard deviations by the scores of sessions, 0 where these differ by the noise alone.
fn between(inverse: &DMatrix<f64>, sessions: &[Group]) -> Vec<f64> {
    let count = sessions.len();
    let freedom = count as f64 - 1.0;
    if count < LEAST_SESSIONS {
        return Vec::new();
    }
    let (Ok(chi), Ok(student)) = (ChiSquared::new(freedom), StudentsT::new(0.0, 1.0, freedom)) else {
        return Vec::new();
    };
    let (most, wider) = (chi.inverse_cdf(1.0 - CHANCE), student.inverse_cdf(0.975) / NINETY_FIVE);
    let deviation = |i: usize| {
        let row = inverse.column(i);
        let moved: Vec<f64> = sessions.iter().map(|g| row.dot(&g.score).powi(2)).collect();
        let expected = sessions.iter().map(|g| (&g.fisher * row).dot(&row));
        let ratios = moved.iter().zip(expected).filter(|(_, e)| *e > 0.0).map(|(m, e)| m / e);
        if ratios.sum::<f64>() <= most {
            return 0.0;
        }
        wider * (count as f64 / freedom * moved.iter().sum::<f64>()).sqrt()
    };
    (0..inverse.nrows()).map(deviation).collect()
}
