//! Consistency of a cause's size over the logs: a true cause has the same size in every part of
//! them.
//!
//! The fitted effect is divided into bins of a quantity of [`crate::data::features`], each with a
//! separate size. A score test compares these sizes, with all fitted parameters free; it has one
//! degree of freedom less than bins. An imitation is too large at some speeds, loads, positions or
//! times and too small at others. Unrelated structure does not change the size there on average.
//! The noise counts at its floor, with the correlation of neighbouring samples only, so that the
//! remainder of an imitation does not count as noise.
//!
//! Effects with fitted shapes (a speed, a time constant) are not tested, because the test would
//! respond to an error of the shape. The exception is an effect of the speed alone, which has one
//! size for rising and falling speed. An inconsistency counts if it is significant and at least
//! [`tuning::MIN_INCONSISTENCY_SHARE`] of the cause's fall of chi-square.

use super::tuning;
use crate::data::features::{FEATURES, Feature};
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use crate::data::tuning::MIN_FEATURE_SPAN;
use crate::fit::least_squares::Fit;
use crate::fit::linear::{cholesky, dot, gram, project};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, SymmetricEigen};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Significant differences of the size of a model's causes.
#[derive(Clone, Copy, Default)]
pub(crate) struct Inconsistency {
    /// True if the size of a cause differs between parts of the logs.
    pub(crate) is_significant: bool,
    /// True if the size of a cause differs between rising and falling speed.
    pub(crate) is_hysteretic: bool,
}

/// Change of the magnitude of the speed: positive while it rises.
const SPEED_CHANGE: Feature = Feature {
    name: "change of speed",
    bins: 2,
    read: |log, i| Some(log.speed.get(i + 1).or(log.speed.get(i))?.abs() - log.speed.get(i)?.abs()),
};

/// Tests the causes of a fit for differences of their size.
pub(crate) fn inconsistency(
    data: &Data,
    floors: &NoiseModel,
    noise: &NoiseModel,
    fit: &Fit,
) -> Inconsistency {
    inconsistency_from(0, data, (floors, noise), fit)
}

/// Tests the last cause of a fit, in units of the noise with all that remains. The
/// correlation counts twice, so that only a clear difference speaks against a cause.
pub(crate) fn last_inconsistency(data: &Data, noise: &NoiseModel, fit: &Fit) -> Inconsistency {
    inconsistency_from(fit.model.effects.len().saturating_sub(1), data, (noise, noise), fit)
}

/// Tests the causes from the one at `start` on.
fn inconsistency_from(
    start: usize,
    data: &Data,
    (floors, noise): (&NoiseModel, &NoiseModel),
    fit: &Fit,
) -> Inconsistency {
    let Some(test) = SizeTest::new(data, floors, noise, fit) else { return Inconsistency::default() };
    let model = &fit.model;
    let count = ((FEATURES.len() + 1) * model.effects.len()).max(1) as f64;
    let max_chance = tuning::INCONSISTENCY_FAMILY_ERROR / count;
    let mut found = Inconsistency::default();
    for (which, candidate) in model.effects.iter().enumerate().skip(start) {
        let (sizes, shapes): (Vec<usize>, Vec<usize>) =
            model.effect_parameters(which).into_iter().partition(|&i| model.parameters[i].is_size());
        let features = if shapes.is_empty() { FEATURES } else { &[] };
        let is_of_speed = shapes.is_empty() || candidate.kind.is_function_of_speed;
        let speed_change = is_of_speed.then_some((&SPEED_CHANGE, true));
        let Some(effect) = test.effect(&sizes) else { continue };
        for (feature, is_speed_change) in features.iter().map(|f| (f, false)).chain(speed_change) {
            let Some(places) = bins(data, feature) else { continue };
            if test.is_inconsistent(&effect, &places, max_chance) {
                found.is_significant = true;
                found.is_hysteretic |= is_speed_change;
            }
        }
    }
    found
}

/// A fit in units of the noise floors.
struct SizeTest<'a> {
    fit: &'a Fit,
    residual: Vec<f64>,
    jacobian: Vec<Vec<f64>>,
    /// Information of data and priors.
    information: Cholesky<f64, Dyn>,
    covariance: DMatrix<f64>,
    /// Remaining gradient.
    gradient: DVector<f64>,
    /// Variance of a mean relative to white noise.
    colour: f64,
}

/// A fitted effect of a [`SizeTest`].
struct Effect {
    /// Weighted response to its sizes.
    response: Vec<f64>,
    /// Fall of chi-square that its sizes explain.
    evidence: f64,
}

impl<'a> SizeTest<'a> {
    /// `None` if the information is not positive definite.
    fn new(data: &Data, floors: &NoiseModel, noise: &NoiseModel, fit: &'a Fit) -> Option<Self> {
        // Factor from the weights of the fit to those of the floors.
        let ratio = |block: usize| {
            data.blocks.get(block).map_or(1.0, |b| floors.weight(b.channel) / noise.weight(b.channel))
        };
        let rows: Vec<f64> = data.map_fitted(|_, _| 0.0).into_iter().map(|(block, _)| ratio(block)).collect();
        let scaled =
            |column: &Vec<f64>| -> Vec<f64> { column.iter().zip(&rows).map(|(c, w)| c * w).collect() };
        let residual = scaled(&fit.residual);
        let jacobian: Vec<Vec<f64>> = fit.jacobian.iter().map(scaled).collect();
        let mut information = gram(&jacobian);
        let mut gradient = project(&jacobian, &residual);
        for (i, p) in fit.model.parameters.iter().enumerate() {
            information[(i, i)] += p.precision;
            gradient[i] -= p.precision * fit.z[i];
        }
        let information = cholesky(&information)?;
        let (covariance, colour) = (information.inverse(), colour(&residual));
        Some(Self { fit, residual, jacobian, information, covariance, gradient, colour })
    }

    /// The effect with these sizes; `None` if their covariance is not positive definite.
    fn effect(&self, sizes: &[usize]) -> Option<Effect> {
        let mut response = vec![0.0; self.residual.len()];
        for &i in sizes {
            response.iter_mut().zip(&self.jacobian[i]).for_each(|(e, c)| *e += self.fit.z[i] * c);
        }
        let z = DVector::from_iterator(sizes.len(), sizes.iter().map(|&i| self.fit.z[i]));
        let block = cholesky(&self.covariance.select_rows(sizes).select_columns(sizes))?;
        Some(Effect { response, evidence: block.solve(&z).dot(&z) })
    }

    /// Returns whether the size of an effect differs between bins, with a chance below
    /// `max_chance`.
    fn is_inconsistent(&self, effect: &Effect, places: &(Vec<usize>, usize), max_chance: f64) -> bool {
        let Some((chi, freedom)) = self.score(&effect.response, places) else { return false };
        let chance = ChiSquared::new(freedom).map_or(1.0, |d| d.sf(chi / self.colour));
        chance < max_chance
            && chi - self.colour * freedom >= tuning::MIN_INCONSISTENCY_SHARE * effect.evidence
    }

    /// Chi-square and degrees of freedom of separate sizes in every bin.
    fn score(&self, response: &[f64], (places, count): &(Vec<usize>, usize)) -> Option<(f64, f64)> {
        let (mut g, mut own) = (DVector::<f64>::zeros(*count), DVector::<f64>::zeros(*count));
        let mut shadows = vec![DVector::<f64>::zeros(self.jacobian.len()); *count];
        for (i, &bin) in places.iter().enumerate() {
            let e = response[i];
            g[bin] += e * self.residual[i];
            own[bin] += e * e;
            shadows[bin].iter_mut().zip(&self.jacobian).for_each(|(s, j)| *s += e * j[i]);
        }
        // The part that the fitted parameters absorb is projected out, as in
        // `crate::search::score`.
        let mut m = DMatrix::from_diagonal(&own);
        for (b, shadow) in shadows.iter().enumerate() {
            let absorbed = self.information.solve(shadow);
            g[b] -= absorbed.dot(&self.gradient);
            for (c, other) in shadows.iter().enumerate() {
                m[(b, c)] -= absorbed.dot(other);
            }
        }
        let eigen = SymmetricEigen::new(m);
        let min = tuning::MIN_EIGENVALUE * own.amax();
        let (mut chi, mut freedom) = (0.0, 0.0);
        for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value > min {
                chi += vector.dot(&g).powi(2) / value;
                freedom += 1.0;
            }
        }
        (freedom > 0.0).then_some((chi, freedom))
    }
}

/// Variance of a mean relative to white noise, from the correlation of neighbours.
fn colour(residual: &[f64]) -> f64 {
    let rho =
        dot(residual, residual.get(1..).unwrap_or_default()) / dot(residual, residual).max(f64::MIN_POSITIVE);
    let rho = rho.clamp(0.0, tuning::MAX_NEIGHBOUR_CORRELATION);
    (1.0 + rho) / (1.0 - rho)
}

/// Bin of every fitted sample, and the number of bins of equal counts.
fn bins(data: &Data, feature: &Feature) -> Option<(Vec<usize>, usize)> {
    let values: Vec<f64> = data
        .map_fitted(|log, i| (feature.read)(log, i).unwrap_or(f64::NAN))
        .into_iter()
        .map(|v| v.1)
        .collect();
    let mut sorted = values.clone();
    sorted.sort_by(f64::total_cmp);
    let (first, last) = (*sorted.first()?, *sorted.last()?);
    if (last - first).is_nan() || last - first <= MIN_FEATURE_SPAN * last.abs().max(first.abs()) {
        return None;
    }
    let mut edges: Vec<f64> = (1..feature.bins)
        .filter_map(|k| sorted.get(k * sorted.len() / feature.bins).copied())
        .filter(|e| *e > first)
        .collect();
    edges.dedup();
    let count = edges.len() + 1;
    Some((values.iter().map(|v| edges.partition_point(|e| e <= v)).collect(), count))
}
