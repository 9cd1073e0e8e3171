//! Evidence that a cause must have: family-wise significance and the penalty of the Bayesian
//! information criterion (BIC).

use super::tuning;
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Penalty of the BIC in chi-square: `p ln n_eff` for `parameters` estimated from the independent
/// samples among the fitted ones.
pub(crate) fn bic_penalty(parameters: usize, data: &Data, noise: &NoiseModel) -> f64 {
    parameters as f64 * noise.effective_samples(data).max(2.0).ln()
}

/// Fall of chi-square that chance exceeds with probability [`tuning::FAMILY_ERROR`] for the best of
/// `family` candidates with `parameters` each.
pub(super) fn family_threshold(parameters: usize, family: usize) -> f64 {
    let quantile = 1.0 - tuning::FAMILY_ERROR / family.max(1) as f64;
    ChiSquared::new(parameters.max(1) as f64).map_or(f64::INFINITY, |d| d.inverse_cdf(quantile))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::calibrated;

    #[test]
    fn the_bic_penalty_is_the_logarithm_of_the_independent_samples_for_each_parameter() {
        let (data, noise, _) = calibrated(1.0);
        let samples = data.logs[0].fitted_samples().count() as f64;
        // The noise is not inflated yet: every fitted sample of the only channel is independent.
        assert!(samples > 100.0 && data.channels.len() == 1);
        assert!((bic_penalty(1, &data, &noise) - samples.ln()).abs() < 1e-12);
        assert!((bic_penalty(3, &data, &noise) - 3.0 * samples.ln()).abs() < 1e-12);
    }

    #[test]
    fn two_clean_families_in_a_thousand_pass_the_threshold() {
        // With two degrees of freedom the quantile of chi-square at 1 - e is -2 ln e.
        assert!((family_threshold(2, 1) + 2.0 * 0.002_f64.ln()).abs() < 1e-6);
        assert!((family_threshold(2, 30) + 2.0 * (0.002_f64 / 30.0).ln()).abs() < 1e-6);
        // With one it is the square of the normal quantile at 1 - e/2, 3.090 for 0.002.
        assert!((family_threshold(1, 1) - 3.090_232_f64.powi(2)).abs() < 1e-4);
    }
}
