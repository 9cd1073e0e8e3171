//! Candidates that a stage has refitted.

use super::score::{Score, correlation};
use super::tuning;
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use crate::fit::least_squares::{Effort, Fit, fit_from};
use crate::fit::linear::cholesky;
use crate::fit::model::Candidate;
use crate::fit::parameter::Parameter;
use bench::simulate::RespondError;
use nalgebra::DVector;

/// A refitted candidate of a stage.
pub(crate) struct Contender {
    pub(crate) candidate: Candidate,
    pub(crate) fit: Fit,
    /// Fall of chi-square relative to the base.
    pub(crate) evidence: f64,
    /// Posterior probability among the contenders and the base.
    pub(crate) probability: f64,
    /// Correlation of its projected signature with that of the best contender.
    pub(crate) correlation: f64,
    /// Chi-square plus the BIC penalty of the parameters that the candidate adds.
    pub(crate) bic: f64,
}

impl Contender {
    /// Returns whether it has more parameters than another contender and the same response, within
    /// what counts as equal.
    pub(crate) fn restates(&self, other: &Self) -> bool {
        let differences = self.fit.residual.iter().zip(&other.fit.residual).map(|(a, b)| (a - b).powi(2));
        self.fit.model.parameters.len() > other.fit.model.parameters.len()
            && differences.sum::<f64>() < tuning::EQUIVALENT_BIC
    }

    /// Returns whether the size of its effect differs from 0 by as much as the evidence indicates,
    /// in its own covariance.
    ///
    /// One significant size suffices, or all sizes together: the cosine and the sine of a ripple
    /// may each be uncertain although its amplitude is significant. Shapes count as known, because
    /// an effect of size 0 has no shape, and if a log shows only the product of a size and a shape,
    /// neither alone is significant. Declared numbers that lie on a bound without the effect count
    /// as known too, because they cannot explain a deviation beyond the bound.
    pub(crate) fn has_significant_size(&self, base: &Fit, threshold: f64) -> bool {
        let fit = &self.fit;
        let own = fit.model.effect_parameters(fit.model.effects.len() - 1);
        let is_size = |i: &usize| fit.model.parameters.get(*i).is_some_and(Parameter::is_size);
        let base_at_bound = base.at_bound();
        let is_at_bound = |i: &usize| base_at_bound.get(*i).copied().unwrap_or_default();
        let is_free = |i: &usize| if own.contains(i) { is_size(i) } else { !is_at_bound(i) };
        let free: Vec<usize> = (0..fit.z.len()).filter(is_free).collect();
        let information = fit.information().select_rows(&free).select_columns(&free);
        let Some(covariance) = cholesky(&information).map(|c| c.inverse()) else { return false };
        let sizes: Vec<usize> = (0..free.len()).filter(|&k| own.contains(&free[k])).collect();
        let z = DVector::from_iterator(sizes.len(), sizes.iter().map(|&k| fit.z[free[k]]));
        let block = covariance.select_rows(&sizes).select_columns(&sizes);
        (0..sizes.len()).any(|k| z[k].powi(2) > threshold * block[(k, k)].max(0.0))
            || cholesky(&block).is_some_and(|c| c.solve(&z).dot(&z) > threshold)
    }

    /// Fits it to its optimum if it has only been fitted roughly.
    pub(super) fn converge(&mut self, data: &Data, noise: &NoiseModel) -> Result<(), RespondError> {
        if self.fit.is_converged {
            return Ok(());
        }
        let (model, z) = (self.fit.model.clone(), self.fit.z.clone());
        let converged = fit_from(data, noise, model, z, Some(self.fit.jacobian.clone()), Effort::FULL)?;
        let fall = self.fit.objective - converged.objective;
        self.evidence += fall;
        self.bic -= fall;
        self.fit = converged;
        Ok(())
    }
}

/// Assigns posterior probabilities from the BIC, among the contenders and the base without any of
/// them.
///
/// `multiplicity` is the part of the threshold beyond the BIC penalty. It counts against all
/// candidates, so that a cause at the threshold has even odds however large the catalogue is.
pub(super) fn assign_probabilities(contenders: &mut [Contender], base: f64, multiplicity: f64) {
    let base = base - multiplicity;
    let min = contenders.iter().map(|c| c.bic).fold(base, f64::min);
    let weight = |bic: f64| (-0.5 * (bic - min)).exp();
    let sum = contenders.iter().fold(weight(base), |sum, c| sum + weight(c.bic));
    contenders.iter_mut().for_each(|c| c.probability = weight(c.bic) / sum);
}

/// Assigns the correlations with the signature of the first contender; 0 for those without a score.
pub(super) fn assign_correlations(contenders: &mut [Contender], base: &Fit, scored: &[Score]) {
    let score_of = |candidate: &Candidate| scored.iter().find(|s| s.candidate == *candidate);
    let Some(best) = contenders.first().and_then(|c| score_of(&c.candidate)) else { return };
    for contender in contenders {
        contender.correlation = score_of(&contender.candidate).map_or(0.0, |s| correlation(base, best, s));
    }
}
