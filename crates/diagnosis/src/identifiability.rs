//! What the logs tell of the parameters of the last model, and what they do not.
//!
//! From `F = J'J` of the weighted sensitivities and the priors' precisions `P`, all in scaled parameters:
//!
//! * `dead`: one prior standard deviation of the parameter changes chi-square by less than [`DEAD`]: the logs do not show it;
//! * `at-bound`: the estimate lies on a bound of its range, so its interval means little;
//! * `not-pinned`: its standard deviation is above [`PRIOR_SHARE`] of its prior's: the number is the prior's, not the logs';
//! * `correlated`: the estimates of a pair correlate by more than [`CORRELATED`]: only a combination of the two is known;
//! * `flat-direction`: an eigenvector of `P^-1/2 F P^-1/2` whose eigenvalue is below [`FLAT`], with several parameters in it: moving
//!   them together by their prior's size changes nothing that was measured;
//! * `sign`: a cause with all its sizes of the opposite sign changes chi-square by less than [`SIGN`]: a tilt of a bearing to the other
//!   side, where the shaft is driven and loaded in its middle.
//!
//! A size that a guess gave has no prior; its own step stands for one. Linear at the optimum: a valley that bends is only
//! seen where it starts.

use crate::digits::four_digits;
use crate::fit::simulate;
use crate::linear::{dot, factor};
use crate::nuisance::Nuisance;
use crate::parameter::Parameter;
use crate::result::Identifiability;
use crate::session::Data;
use crate::verdict::End;
use nalgebra::{DMatrix, SymmetricEigen};

const DEAD: f64 = 0.01;
const PRIOR_SHARE: f64 = 0.9;
const CORRELATED: f64 = 0.95;
const FLAT: f64 = 0.1;
const SIGN: f64 = 4.0;
/// Components of a unit vector that are named.
const NAMED: f64 = 0.25;

/// Everything that is not well known, plain things first.
pub(crate) fn identifiability(data: &Data, end: &End) -> Vec<Identifiability> {
    let parameters = &end.model.parameters;
    let names: Vec<String> = parameters.iter().map(|p| p.name().to_owned()).collect();
    let priors = priors(end);
    let n = parameters.len();
    let Some(scaled) = told(end) else { return Vec::new() };
    let mut out = Vec::new();
    let dead: Vec<bool> = (0..n).map(|i| scaled[(i, i)] < DEAD).collect();
    let mut say = |kind: &'static str, which: &[usize], value: f64, words: String| {
        let parameters = which.iter().filter_map(|&i| names.get(i).cloned()).collect();
        out.push(Identifiability { kind, parameters, value, words });
    };
    // What shows in no session is said once for all of them.
    let field = |i: usize| parameters[i].nuisance().map(Nuisance::field);
    for name in Nuisance::FIELDS {
        let own: Vec<usize> = (0..n).filter(|&i| dead[i] && field(i) == Some(name)).collect();
        let most = own.iter().map(|&i| scaled[(i, i)]).fold(0.0, f64::max);
        if let [_, ..] = own.as_slice() {
            let words =
                format!("the logs do not show {name}, declared of {}: it stays at 0", sessions(own.len()));
            say("dead", &own, most, words);
        }
    }
    for i in (0..n).filter(|&i| dead[i] && field(i).is_none()) {
        let words = format!("the logs do not show {}: what is reported is its prior", names[i]);
        say("dead", &[i], scaled[(i, i)], words);
    }
    for (i, p) in parameters.iter().enumerate() {
        if let Some(bound) = p.bound_at(end.z.get(i).copied().unwrap_or_default()) {
            let words = format!("{} ended at the bound {} of its range", names[i], four_digits(bound));
            say("at-bound", &[i], bound, words);
        }
    }
    // A nuisance stands beside its declaration in a table of its own.
    for i in (0..n).filter(|&i| !dead[i] && parameters[i].precision > 0.0 && field(i).is_none()) {
        let share = end.deviations.get(i).copied().unwrap_or(f64::INFINITY) / priors[i];
        if share > PRIOR_SHARE {
            let words = format!(
                "{} is not pinned by the logs: its standard deviation is {:.0} % of its prior's",
                names[i],
                100.0 * share.min(1.0)
            );
            say("not-pinned", &[i], share, words);
        }
    }
    for (i, j, rho) in correlated(end) {
        let words = format!(
            "{} and {} correlate by {rho:+.3}: the logs tell a combination of the two",
            names[i], names[j]
        );
        say("correlated", &[i, j], rho, words);
    }
    for which in 0..end.model.chosen.len() {
        let sizes: Vec<usize> =
            end.model.of_effect(which).into_iter().filter(|&i| parameters[i].is_size()).collect();
        if let Some(change) = mirrored(data, end, &sizes).filter(|change| change.abs() < SIGN) {
            let own: Vec<&str> = sizes.iter().map(|&i| names[i].as_str()).collect();
            let together = if own.len() > 1 { " together" } else { "" };
            let words = format!(
                "the logs do not tell the sign of {}{together}: the opposite fits as well",
                own.join(" and ")
            );
            say("sign", &sizes, change, words);
        }
    }
    // Of what is dead any combination is flat.
    let live: Vec<usize> = (0..n).filter(|&i| !dead[i]).collect();
    if live.is_empty() {
        return out;
    }
    let eigen = SymmetricEigen::new(scaled.select_rows(&live).select_columns(&live));
    for (k, &value) in eigen.eigenvalues.iter().enumerate().filter(|(_, v)| **v < FLAT) {
        let part = |(place, &i): (usize, &usize)| (i, eigen.eigenvectors[(place, k)]);
        let parts: Vec<(usize, f64)> =
            live.iter().enumerate().map(part).filter(|(_, c)| c.abs() > NAMED).collect();
        if parts.len() < 2 {
            continue;
        }
        let sign = parts.first().map_or(1.0, |p| p.1.signum());
        let sum: Vec<String> = parts.iter().map(|(i, c)| format!("{:+.2} {}", sign * c, names[*i])).collect();
        let which: Vec<usize> = parts.iter().map(|p| p.0).collect();
        let words = format!("no measured channel tells {} (in prior standard deviations)", sum.join(" "));
        say("flat-direction", &which, value.max(0.0), words);
    }
    out
}

/// A nominal parameter's scale is its prior; an effect's prior is in its precision.
fn priors(end: &End) -> Vec<f64> {
    let prior = |p: &Parameter| if p.precision > 0.0 { p.precision.sqrt().recip() } else { 1.0 };
    end.model.parameters.iter().map(prior).collect()
}

/// What the logs tell of the parameters in units of their priors.
fn told(end: &End) -> Option<DMatrix<f64>> {
    let (priors, n) = (priors(end), end.model.parameters.len());
    (n > 0 && end.fisher.nrows() == n)
        .then(|| DMatrix::from_fn(n, n, |i, j| priors[i] * priors[j] * end.fisher[(i, j)]))
}

/// Change of chi-square on the fitted samples with all sizes of an effect of the opposite sign; none where they cannot be.
fn mirrored(data: &Data, end: &End, sizes: &[usize]) -> Option<f64> {
    let mut z = end.z.clone();
    for &i in sizes {
        let (least, most) = end.model.parameters.get(i)?.bounds();
        let place = z.get_mut(i)?;
        *place = -*place;
        if !(least..=most).contains(place) {
            return None;
        }
    }
    let there = simulate(data, &end.model.at(&z), None).ok()?;
    let square = |residual| {
        let stacked = end.noise.stack(data, residual);
        dot(&stacked, &stacked)
    };
    Some(square(&data.residual(&there.columns)) - square(&end.residual))
}

/// Pairs of parameters whose estimates correlate by more than [`CORRELATED`], by their places, with the correlation.
fn correlated(end: &End) -> Vec<(usize, usize, f64)> {
    let Some(scaled) = told(end) else { return Vec::new() };
    let n = scaled.nrows();
    let mut precise = scaled.clone();
    for (i, p) in end.model.parameters.iter().enumerate() {
        precise[(i, i)] += if p.precision > 0.0 { 1.0 } else { 0.0 };
    }
    let Some(covariance) = factor(&precise).map(|c| c.inverse()) else { return Vec::new() };
    let rho = |i: usize, j: usize| covariance[(i, j)] / (covariance[(i, i)] * covariance[(j, j)]).sqrt();
    let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
    pairs
        .map(|(i, j)| (i, j, rho(i, j)))
        .filter(|&(i, j, rho)| rho.abs() > CORRELATED && scaled[(i, i)] >= DEAD && scaled[(j, j)] >= DEAD)
        .collect()
}

fn sessions(count: usize) -> String {
    format!("{count} session{}", if count == 1 { "" } else { "s" })
}
