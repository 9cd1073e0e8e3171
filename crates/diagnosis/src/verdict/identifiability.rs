//! Parameters of the reported model that the logs do not determine.
//!
//! With the information `F = J'J` of the weighted sensitivities and the precisions `P` of the
//! priors, all in scaled parameters:
//!
//! * `dead`: one prior standard deviation of the parameter changes chi-square by less than
//!   [`tuning::DEAD_CHI_SQUARE`].
//! * `at-bound`: the estimate lies on a bound of its range, so its interval means little.
//! * `not-pinned`: its standard deviation is above [`tuning::PRIOR_SHARE`] of its prior's, so the
//!   estimate comes from the prior.
//! * `correlated`: two estimates correlate by more than [`tuning::MAX_CORRELATION`], so only a
//!   combination is known.
//! * `flat-direction`: an eigenvector of `P^-1/2 F P^-1/2` with several parameters has an
//!   eigenvalue below [`tuning::FLAT_EIGENVALUE`]. A common change of them by their priors'
//!   deviations changes no measured channel.
//! * `sign`: all sizes of a cause with the opposite sign change chi-square by less than
//!   [`tuning::SIGN_CHI_SQUARE`], such as the tilt of a bearing whose shaft is driven and loaded in
//!   its middle.
//!
//! A guessed size has no prior; its step takes the place of one. The analysis is linear at the
//! optimum and does not follow curved valleys.

use super::explanation::Explanation;
use super::tuning;
use crate::data::logs::Data;
use crate::digits::four_digits;
use crate::fit::linear::{cholesky, dot};
use crate::fit::nuisance::Nuisance;
use crate::fit::parameter::Parameter;
use crate::fit::simulation::simulate;
use nalgebra::{DMatrix, SymmetricEigen};
use schemars::JsonSchema;
use serde::Serialize;

/// Parameters of the reported model that the logs do not determine.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Identifiability {
    /// `dead`, `at-bound`, `not-pinned`, `correlated`, `sign` or `flat-direction`.
    pub kind: &'static str,
    /// The parameters concerned.
    pub parameters: Vec<String>,
    /// Measure of the kind: change of chi-square over one prior standard deviation (`dead`), the
    /// bound, the share of the prior's standard deviation (`not-pinned`), the correlation, the
    /// change of chi-square (`sign`), the eigenvalue (`flat-direction`).
    pub value: f64,
    /// The same as a sentence.
    pub words: String,
}

/// Parameters of a model with what logs determine about them.
pub(crate) struct Determination<'a> {
    pub(crate) parameters: &'a [Parameter],
    /// Scaled parameters.
    pub(crate) z: &'a [f64],
    /// Standard deviations in scaled units.
    pub(crate) deviations: &'a [f64],
    /// Information of the data on the scaled parameters, without priors.
    pub(crate) fisher: &'a DMatrix<f64>,
}

/// Lists the parameters that the logs do not determine, simple kinds first.
pub(crate) fn identifiability(data: &Data, explanation: &Explanation) -> Vec<Identifiability> {
    let Some(mut analysis) = Analysis::new(Determination {
        parameters: &explanation.model.parameters,
        z: &explanation.z,
        deviations: &explanation.deviations,
        fisher: &explanation.fisher,
    }) else {
        return Vec::new();
    };
    analysis.list_dead();
    analysis.list_at_bound();
    analysis.list_not_pinned();
    analysis.list_correlated(0.0);
    analysis.list_signs(data, explanation);
    analysis.list_flat_directions();
    analysis.out
}

/// Lists the declared parameters that logs do not show or do not separate, before any fit.
pub(crate) fn not_determined(determination: Determination<'_>) -> Vec<Identifiability> {
    let Some(mut analysis) = Analysis::new(determination) else { return Vec::new() };
    analysis.list_dead();
    analysis.list_not_pinned();
    analysis.list_correlated(tuning::INSEPARABLE_SHARE);
    analysis.list_flat_directions();
    analysis.out
}

/// Information about the parameters of a model, and the list so far.
struct Analysis<'a> {
    determination: Determination<'a>,
    /// Information of the data in units of the priors.
    information: DMatrix<f64>,
    /// Name of each parameter.
    names: Vec<String>,
    /// True for each parameter that the logs do not show.
    dead: Vec<bool>,
    out: Vec<Identifiability>,
}

impl<'a> Analysis<'a> {
    /// `None` without parameters.
    fn new(determination: Determination<'a>) -> Option<Self> {
        let (parameters, count) = (determination.parameters, determination.parameters.len());
        let information = information_in_prior_units(&determination)?;
        let names = parameters.iter().map(|p| p.name().to_owned()).collect();
        let dead = (0..count).map(|i| information[(i, i)] < tuning::DEAD_CHI_SQUARE).collect();
        Some(Self { determination, information, names, dead, out: Vec::new() })
    }

    fn push(&mut self, kind: &'static str, which: &[usize], value: f64, words: String) {
        let parameters = which.iter().filter_map(|&i| self.names.get(i).cloned()).collect();
        self.out.push(Identifiability { kind, parameters, value, words });
    }

    fn parameters(&self) -> &'a [Parameter] {
        self.determination.parameters
    }

    /// Field of `[nuisances]`, for a nuisance parameter of one log.
    fn field(&self, i: usize) -> Option<&'static str> {
        self.parameters().get(i).and_then(Parameter::nuisance).map(Nuisance::field)
    }

    fn list_dead(&mut self) {
        let count = self.dead.len();
        // A nuisance parameter that no log shows is listed once for all logs.
        for name in Nuisance::FIELDS {
            let own: Vec<usize> =
                (0..count).filter(|&i| self.dead[i] && self.field(i) == Some(name)).collect();
            let max = own.iter().map(|&i| self.information[(i, i)]).fold(0.0, f64::max);
            if !own.is_empty() {
                let plural = if own.len() == 1 { "" } else { "s" };
                let words = format!(
                    "the logs do not show {name}, declared for {} log{plural}: it stays at 0",
                    own.len()
                );
                self.push("dead", &own, max, words);
            }
        }
        for i in (0..count).filter(|&i| self.dead[i] && self.field(i).is_none()).collect::<Vec<_>>() {
            let words = format!("the logs do not show {}: the reported value is its prior", self.names[i]);
            self.push("dead", &[i], self.information[(i, i)], words);
        }
    }

    fn list_at_bound(&mut self) {
        for i in 0..self.names.len() {
            let z = self.determination.z.get(i).copied().unwrap_or_default();
            if let Some(bound) = self.parameters()[i].bound_at(z) {
                let words =
                    format!("{} ended at the bound {} of its range", self.names[i], four_digits(bound));
                self.push("at-bound", &[i], bound, words);
            }
        }
    }

    /// Nuisance parameters are omitted: a table shows each beside its declaration.
    fn list_not_pinned(&mut self) {
        for (i, prior) in priors(self.parameters()).into_iter().enumerate() {
            if self.dead[i] || self.parameters()[i].precision <= 0.0 || self.field(i).is_some() {
                continue;
            }
            let share = self.determination.deviations.get(i).copied().unwrap_or(f64::INFINITY) / prior;
            if share > tuning::PRIOR_SHARE {
                let words = format!(
                    "the logs do not determine {}: its standard deviation is {:.0} % of its prior's",
                    self.names[i],
                    100.0 * share.min(1.0)
                );
                self.push("not-pinned", &[i], share, words);
            }
        }
    }

    /// Pairs of which one has at least a share of its prior's standard deviation left.
    fn list_correlated(&mut self, min_share: f64) {
        let priors = priors(self.parameters());
        let left =
            |i: usize| self.determination.deviations.get(i).zip(priors.get(i)).map_or(1.0, |(d, p)| d / p);
        let pairs: Vec<(usize, usize, f64)> =
            self.correlated().into_iter().filter(|&(i, j, _)| left(i).max(left(j)) >= min_share).collect();
        for (i, j, rho) in pairs {
            let words = format!(
                "{} and {} correlate by {rho:+.3}: the logs determine a combination of the two",
                self.names[i], self.names[j]
            );
            self.push("correlated", &[i, j], rho, words);
        }
    }

    /// Pairs of parameters whose estimates correlate by more than [`tuning::MAX_CORRELATION`], with
    /// the correlation.
    fn correlated(&self) -> Vec<(usize, usize, f64)> {
        let n = self.information.nrows();
        let mut precise = self.information.clone();
        for (i, p) in self.parameters().iter().enumerate() {
            precise[(i, i)] += if p.precision > 0.0 { 1.0 } else { 0.0 };
        }
        let Some(covariance) = cholesky(&precise).map(|c| c.inverse()) else { return Vec::new() };
        let rho = |i: usize, j: usize| covariance[(i, j)] / (covariance[(i, i)] * covariance[(j, j)]).sqrt();
        let is_live = |i: usize| self.information[(i, i)] >= tuning::DEAD_CHI_SQUARE;
        let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
        pairs
            .map(|(i, j)| (i, j, rho(i, j)))
            .filter(|&(i, j, rho)| rho.abs() > tuning::MAX_CORRELATION && is_live(i) && is_live(j))
            .collect()
    }

    fn list_signs(&mut self, data: &Data, explanation: &Explanation) {
        let model = &explanation.model;
        for which in 0..model.effects.len() {
            let own = model.effect_parameters(which).into_iter();
            let sizes: Vec<usize> = own.filter(|&i| model.parameters[i].is_size()).collect();
            let change = mirror_change(data, explanation, &sizes);
            if let Some(change) = change.filter(|change| change.abs() < tuning::SIGN_CHI_SQUARE) {
                let names: Vec<&str> = sizes.iter().map(|&i| self.names[i].as_str()).collect();
                let together = if names.len() > 1 { " together" } else { "" };
                let words = format!(
                    "the logs do not determine the sign of {}{together}: the opposite fits as well",
                    names.join(" and ")
                );
                self.push("sign", &sizes, change, words);
            }
        }
    }

    /// Dead parameters are omitted: any combination of them is flat.
    fn list_flat_directions(&mut self) {
        let live: Vec<usize> = (0..self.dead.len()).filter(|&i| !self.dead[i]).collect();
        if live.is_empty() {
            return;
        }
        let eigen = SymmetricEigen::new(self.information.select_rows(&live).select_columns(&live));
        for (k, &value) in eigen.eigenvalues.iter().enumerate() {
            let component = |(row, &i): (usize, &usize)| (i, eigen.eigenvectors[(row, k)]);
            let all = live.iter().enumerate().map(component);
            let parts: Vec<(usize, f64)> = all.filter(|(_, c)| c.abs() > tuning::NAMED_COMPONENT).collect();
            let is_flat = value < tuning::FLAT_EIGENVALUE;
            if !is_flat || parts.len() < 2 {
                continue;
            }
            let sign = parts.first().map_or(1.0, |p| p.1.signum());
            let terms = parts.iter().map(|(i, c)| format!("{:+.2} {}", sign * c, self.names[*i]));
            let sum = terms.collect::<Vec<_>>().join(" ");
            let which: Vec<usize> = parts.iter().map(|p| p.0).collect();
            let words = format!("no measured channel shows {sum} (in prior standard deviations)");
            self.push("flat-direction", &which, value.max(0.0), words);
        }
    }
}

/// Prior standard deviations in scaled units; 1 for a parameter without prior.
fn priors(parameters: &[Parameter]) -> Vec<f64> {
    let prior = |p: &Parameter| if p.precision > 0.0 { p.precision.sqrt().recip() } else { 1.0 };
    parameters.iter().map(prior).collect()
}

/// Information of the data in units of the priors; `None` without parameters.
fn information_in_prior_units(determination: &Determination<'_>) -> Option<DMatrix<f64>> {
    let (priors, n) = (priors(determination.parameters), determination.parameters.len());
    let fisher = determination.fisher;
    (n > 0 && fisher.nrows() == n)
        .then(|| DMatrix::from_fn(n, n, |i, j| priors[i] * priors[j] * fisher[(i, j)]))
}

/// Change of chi-square on the fitted samples with all sizes of an effect of the opposite sign;
/// `None` if those are out of range.
fn mirror_change(data: &Data, explanation: &Explanation, sizes: &[usize]) -> Option<f64> {
    let mut z = explanation.z.clone();
    for &i in sizes {
        let (min, max) = explanation.model.parameters.get(i)?.bounds();
        let size = z.get_mut(i)?;
        *size = -*size;
        if !(min..=max).contains(size) {
            return None;
        }
    }
    let mirrored = simulate(data, &explanation.model.at(&z), None).ok()?;
    let chi_square = |residual| {
        let weighted = explanation.noise.stack(data, residual);
        dot(&weighted, &weighted)
    };
    Some(chi_square(&data.residual(&mirrored.columns)) - chi_square(&explanation.residual))
}
