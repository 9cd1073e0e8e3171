//! Whether a cause fits in shape: its size has to be the same in every part of the logs.
//!
//! The fitted effect `s` is cut into bins of a quantity of [`crate::structure`], each with a size of its own beside everything that the fit
//! moves: a score test with one degree less than bins. An effect that only imitates another one is too large at some speeds, loads,
//! positions or times and too small at others; structure that has nothing to do with it does not change its size there on average. The noise
//! counts at its floor and with the correlation of neighbouring samples alone: what an imitation leaves must not pass for noise.
//! An effect with shapes of its own to fit (a speed, a time constant) is not asked, since where such a shape is off, the test says so of the shape and not of
//! the effect; but for what follows the speed alone, which has one size while the speed rises and while it falls.
//! A misfit counts where it is beyond chance and at least [`LEAST_SHARE`] of what the cause takes off chi-square.

use crate::fit::Fit;
use crate::linear::{dot, factor, gram, project};
use crate::noise::NoiseModel;
use crate::session::Data;
use crate::structure::{FEATURES, Feature};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Chance that the cause of a log is thought to misfit, shared by all tests of a model.
const FAMILY_ERROR: f64 = 0.002;
/// Share of a cause's chi-square below which a misfit is nobody's business.
const LEAST_SHARE: f64 = 0.03;
/// Eigenvalue, as a share of the largest, from which a direction counts.
const LEAST_EIGENVALUE: f64 = 1e-6;

/// How a model's causes misfit.
#[derive(Clone, Copy, Default)]
pub(crate) struct Misfit {
    /// One of them in any way.
    pub(crate) any: bool,
    /// One of them has another size while the speed rises than while it falls.
    pub(crate) memory: bool,
}

/// Effects with a shape that follow the speed alone.
const OF_SPEED_ALONE: &[&str] = &["stribeck-friction"];

/// Whether the speed rises or falls.
const SPEEDING: Feature = Feature {
    name: "speeding up",
    bins: 2,
    read: |s, i| Some(s.speed.get(i + 1).or(s.speed.get(i))?.abs() - s.speed.get(i)?.abs()),
};

/// How the causes of a fit misfit beyond chance.
pub(crate) fn misfit(data: &Data, floors: &NoiseModel, noise: &NoiseModel, fit: &Fit) -> Misfit {
    // From the weights of the fit to those of the floors.
    let ratio = |block: usize| {
        data.blocks.get(block).map_or(1.0, |b| floors.weight(b.channel) / noise.weight(b.channel))
    };
    let rows: Vec<f64> = data.stacked(|_, _| 0.0).into_iter().map(|(block, _)| ratio(block)).collect();
    let scaled = |column: &Vec<f64>| -> Vec<f64> { column.iter().zip(&rows).map(|(c, w)| c * w).collect() };
    let residual = scaled(&fit.residual);
    let jacobian: Vec<Vec<f64>> = fit.jacobian.iter().map(scaled).collect();
    let mut information = gram(&jacobian);
    let mut left = project(&jacobian, &residual);
    for (i, p) in fit.model.parameters.iter().enumerate() {
        information[(i, i)] += p.precision;
        left[i] -= p.precision * fit.z[i];
    }
    let Some(information) = factor(&information) else { return Misfit::default() };
    let covariance = information.inverse();
    let coloured = neighbours(&residual);
    let tests = ((FEATURES.len() + 1) * fit.model.chosen.len()).max(1) as f64;
    let mut misfit = Misfit::default();
    for which in 0..fit.model.chosen.len() {
        let (own, shapes): (Vec<usize>, Vec<usize>) =
            fit.model.of_effect(which).into_iter().partition(|&i| fit.model.parameters[i].is_size());
        let name = fit.model.chosen[which].kind.name;
        let features = if shapes.is_empty() { FEATURES } else { &[] };
        let speeding = (shapes.is_empty() || OF_SPEED_ALONE.contains(&name)).then_some((&SPEEDING, true));
        let mut effect = vec![0.0; residual.len()];
        for &i in &own {
            effect.iter_mut().zip(&jacobian[i]).for_each(|(e, c)| *e += fit.z[i] * c);
        }
        let z = DVector::from_iterator(own.len(), own.iter().map(|&i| fit.z[i]));
        let Some(block) = factor(&covariance.select_rows(&own).select_columns(&own)) else { continue };
        let taken = block.solve(&z).dot(&z);
        for (feature, is_memory) in features.iter().map(|f| (f, false)).chain(speeding) {
            let Some(places) = bins(data, feature) else { continue };
            let Some((chi, freedom)) =
                score(&jacobian, &residual, &effect, &places, |k| information.solve(k), &left)
            else {
                continue;
            };
            let chance = ChiSquared::new(freedom).map_or(1.0, |d| d.sf(chi / coloured));
            if chance < FAMILY_ERROR / tests && chi - coloured * freedom >= LEAST_SHARE * taken {
                misfit.any = true;
                misfit.memory |= is_memory;
            }
        }
    }
    misfit
}

/// Variance of a mean over that of white noise, from the correlation of neighbours.
fn neighbours(residual: &[f64]) -> f64 {
    let rho =
        dot(residual, residual.get(1..).unwrap_or_default()) / dot(residual, residual).max(f64::MIN_POSITIVE);
    let rho = rho.clamp(0.0, 0.9);
    (1.0 + rho) / (1.0 - rho)
}

/// The bin of every fitted sample, and their number: bins of equal counts.
fn bins(data: &Data, feature: &Feature) -> Option<(Vec<usize>, usize)> {
    let values: Vec<f64> =
        data.stacked(|s, i| (feature.read)(s, i).unwrap_or(f64::NAN)).into_iter().map(|v| v.1).collect();
    let mut sorted = values.clone();
    sorted.sort_by(f64::total_cmp);
    let (first, last) = (*sorted.first()?, *sorted.last()?);
    if (last - first).is_nan() || last - first <= 1e-3 * last.abs().max(first.abs()) {
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

/// Chi-square and degrees of freedom of sizes of their own in every bin.
fn score(
    jacobian: &[Vec<f64>],
    residual: &[f64],
    effect: &[f64],
    (places, count): &(Vec<usize>, usize),
    absorb: impl Fn(&DVector<f64>) -> DVector<f64>,
    left: &DVector<f64>,
) -> Option<(f64, f64)> {
    let (mut g, mut own) = (DVector::<f64>::zeros(*count), DVector::<f64>::zeros(*count));
    let mut shadows = vec![DVector::<f64>::zeros(jacobian.len()); *count];
    for (i, &bin) in places.iter().enumerate() {
        let e = effect[i];
        g[bin] += e * residual[i];
        own[bin] += e * e;
        shadows[bin].iter_mut().zip(jacobian).for_each(|(s, j)| *s += e * j[i]);
    }
    let mut m = DMatrix::from_diagonal(&own);
    for (b, shadow) in shadows.iter().enumerate() {
        let absorbed = absorb(shadow);
        g[b] -= absorbed.dot(left);
        for (c, other) in shadows.iter().enumerate() {
            m[(b, c)] -= absorbed.dot(other);
        }
    }
    let eigen = SymmetricEigen::new(m);
    let least = LEAST_EIGENVALUE * own.amax();
    let (mut chi, mut freedom) = (0.0, 0.0);
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > least {
            chi += vector.dot(&g).powi(2) / value;
            freedom += 1.0;
        }
    }
    (freedom > 0.0).then_some((chi, freedom))
}
