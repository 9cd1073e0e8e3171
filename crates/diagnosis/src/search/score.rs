//! Score test: the evidence of every effect without a refit.
//!
//! The test takes the sensitivity `C` to an effect at size 0 and projects out the part that the
//! uncertain parameters can absorb, with their priors as pseudo-observations. The predicted fall of
//! chi-square is `g' M^-1 g` with
//!
//! * `M = C'C - (J'C)' A^-1 (J'C)`,
//! * `g = C'r - (J'C)' A^-1 (J'r - P z)`,
//! * `A = J'J + P`,
//!
//! where `J` are the sensitivities of the base, `r` its residual, `z` its parameters and `P` the
//! precisions of their priors.

use super::initial_guess;
use super::tuning;
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use crate::fit::least_squares::{Effort, Fit, fit, fit_from};
use crate::fit::linear::{cholesky, dot, gram, project};
use crate::fit::model::{Candidate, Model};
use crate::fit::parameter::Parameter;
use crate::fit::sensitivities::sensitivities;
use crate::fit::simulation::simulate;
use bench::Bench;
use bench::effects::CATALOGUE;
use bench::simulate::RespondError;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;

/// Score of a candidate relative to a fitted base.
pub(crate) struct Score {
    pub(crate) candidate: Candidate,
    /// Predicted fall of chi-square.
    pub(crate) evidence: f64,
    /// Predicted scaled parameters of the effect.
    pub(crate) estimate: Vec<f64>,
    /// Weighted change of the response at these parameters, before the projection.
    signature: Vec<f64>,
    /// `J'` times the signature.
    shadow: DVector<f64>,
}

/// All effects of the catalogue that this bench and these channels can show.
pub(crate) fn candidates(bench: &Bench, data: &Data, excluded: &[String]) -> Vec<Candidate> {
    let mut out = Vec::new();
    for kind in CATALOGUE.iter().filter(|k| !excluded.iter().any(|e| e == k.name)) {
        if kind.parameters(bench).is_empty() {
            continue;
        }
        let plain = Candidate { kind, channel: None, of: None, guess: None };
        if kind.is_per_channel() {
            out.extend(data.channels.iter().map(|&c| Candidate { channel: Some(c), ..plain.clone() }));
        } else if let Some(parts) = kind.parts(bench) {
            out.extend(parts.into_iter().map(|part| Candidate { of: Some(part.into()), ..plain.clone() }));
        } else {
            out.push(plain);
        }
    }
    out
}

/// Scores candidates relative to a fitted base, most evidence first.
pub(crate) fn scores(
    data: &Data,
    noise: &NoiseModel,
    base: &Fit,
    candidates: &[Candidate],
) -> Result<Vec<Score>, RespondError> {
    let Some(information) = cholesky(&base.information_with_bounds_fixed()) else { return Ok(Vec::new()) };
    let projection = Projection { information, gradient: base.gradient() };
    let guessed: Vec<Candidate> = initial_guess::with_guesses(data, noise, base, candidates)?;
    let score = |candidate: &Candidate| Score::new(data, noise, base, &projection, candidate);
    let found: Result<Vec<_>, RespondError> = guessed.par_iter().map(score).collect();
    let mut scores: Vec<Score> = found?.into_iter().flatten().collect();
    scores.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    // Only the best guess of each candidate remains.
    let mut seen: Vec<Candidate> = Vec::with_capacity(scores.len());
    scores.retain(|s| {
        let is_first = !seen.contains(&s.candidate);
        seen.push(s.candidate.clone());
        is_first
    });
    Ok(scores)
}

/// Information and remaining gradient of a base, which project out what its parameters absorb.
struct Projection {
    information: Cholesky<f64, Dyn>,
    gradient: DVector<f64>,
}

impl Score {
    /// `None` if the base's parameters absorb the effect completely.
    fn new(
        data: &Data,
        noise: &NoiseModel,
        base: &Fit,
        projection: &Projection,
        candidate: &Candidate,
    ) -> Result<Option<Self>, RespondError> {
        let nominal = base.model.parameters.len();
        let model = base.model.with_effect(candidate.clone(), noise);
        // At size 0 a shape has no effect.
        let is_size = |i: &usize| model.parameters.get(*i).is_some_and(Parameter::is_size);
        let sizes: Vec<usize> = (nominal..model.parameters.len()).filter(is_size).collect();
        // A guessed size is far from 0, where a derivative at 0 shows nothing.
        let reach = |i: usize| match candidate.guess.filter(|_| candidate.guesses_size()) {
            Some(guess) => guess.value / guess.step,
            None => model.parameters[i].step(),
        };
        let columns: Result<Vec<_>, RespondError> =
            sizes.iter().map(|&i| secant(data, noise, base, &model, (i, reach(i)))).collect();
        let columns = columns?;
        let shadows: Vec<DVector<f64>> = columns.iter().map(|c| project(&base.jacobian, c)).collect();
        let full = gram(&columns);
        let mut survived = full.clone();
        let mut g = project(&columns, &base.residual);
        for (i, shadow) in shadows.iter().enumerate() {
            let absorbed = projection.information.solve(shadow);
            g[i] -= absorbed.dot(&projection.gradient);
            for (j, other) in shadows.iter().enumerate() {
                survived[(i, j)] -= absorbed.dot(other);
            }
        }
        let min_survived = |i: usize| tuning::MIN_SURVIVAL * full[(i, i)].max(f64::MIN_POSITIVE);
        if (0..sizes.len()).any(|i| survived[(i, i)] <= min_survived(i)) {
            return Ok(None);
        }
        let Some(estimate) = cholesky(&survived).map(|c| c.solve(&g)) else { return Ok(None) };
        let mut estimated = sizes.iter().zip(estimate.iter());
        let is_backwards = estimated.any(|(&i, &b)| b < 0.0 && model.parameters[i].is_one_sided());
        let evidence = if is_backwards { 0.0 } else { g.dot(&estimate) };
        let signature = combine(&columns, &estimate);
        let shadow =
            shadows.iter().zip(estimate.iter()).fold(DVector::zeros(nominal), |sum, (s, &b)| sum + s * b);
        let mut own = vec![0.0; model.parameters.len() - nominal];
        for (&i, &b) in sizes.iter().zip(estimate.iter()) {
            own[i - nominal] = b;
        }
        Ok(Some(Self { candidate: candidate.clone(), evidence, estimate: own, signature, shadow }))
    }
}

/// Change of the response from no effect to a size, per scaled unit.
///
/// It is one-sided, because a score only selects candidates for a refit, and a second simulation of
/// every effect would take a third of a diagnosis. An effect that changes the same number as a
/// declared parameter gets that parameter's sensitivity, see [`sensitivities`].
fn secant(
    data: &Data,
    noise: &NoiseModel,
    base: &Fit,
    model: &Model,
    (place, size): (usize, f64),
) -> Result<Vec<f64>, RespondError> {
    let mut z = base.z.clone();
    z.resize(model.parameters.len(), 0.0);
    if let Some((own, factor)) = model.alias(&z, place)
        && let Some(column) = base.jacobian.get(own)
    {
        return Ok(column.iter().map(|v| factor * v).collect());
    }
    let size = if size > model.parameters[place].bounds().1 { -size } else { size };
    z[place] = size;
    let mut change = simulate(data, &model.at(&z), Some(&base.simulation))?.columns;
    for (there, here) in change.iter_mut().zip(&base.simulation.columns) {
        there.iter_mut().zip(here).for_each(|(t, h)| *t = (*t - h) / size);
    }
    Ok(noise.stack(data, &change))
}

/// Sum of columns, each times its factor.
fn combine(columns: &[Vec<f64>], factors: &DVector<f64>) -> Vec<f64> {
    let mut out = vec![0.0; columns.first().map_or(0, Vec::len)];
    for (column, &f) in columns.iter().zip(factors.iter()) {
        out.iter_mut().zip(column).for_each(|(o, c)| *o += f * c);
    }
    out
}

/// Correlation of two projected signatures, 0 to 1.
pub(crate) fn correlation(base: &Fit, a: &Score, b: &Score) -> f64 {
    let information: DMatrix<f64> = base.information_with_bounds_fixed();
    let Some(information) = cholesky(&information) else { return 0.0 };
    let inner =
        |a: &Score, b: &Score| dot(&a.signature, &b.signature) - information.solve(&a.shadow).dot(&b.shadow);
    let norm = (inner(a, a) * inner(b, b)).sqrt();
    if norm > 0.0 { (inner(a, b).abs() / norm).min(1.0) } else { 0.0 }
}

/// Refits a candidate roughly, together with all parameters of `base`, from the base's own
/// sensitivities.
pub(crate) fn rough_refit(
    data: &Data,
    noise: &NoiseModel,
    base: &Fit,
    score: &Score,
) -> Result<Fit, RespondError> {
    let model = base.model.with_effect(score.candidate.clone(), noise);
    let mut z = base.z.clone();
    z.extend(&score.estimate);
    for (z, p) in z.iter_mut().zip(&model.parameters) {
        let (min, max) = p.bounds();
        *z = z.clamp(min, max);
    }
    // A size that the plant cannot simulate, such as wear beyond the clearance, is no start.
    let Ok(simulation) = simulate(data, &model.at(&z), Some(&base.simulation)) else {
        z.truncate(base.z.len());
        z.resize(model.parameters.len(), 0.0);
        return fit(data, noise, model, z);
    };
    let added: Vec<usize> = (base.z.len()..z.len()).collect();
    let mut jacobian = base.jacobian.clone();
    jacobian.extend(sensitivities(data, noise, &model, &z, &simulation, &added)?);
    fit_from(data, noise, model, z, Some(jacobian), Effort::ROUGH)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{calibrated, four_bar, plain};

    #[test]
    fn an_effect_is_a_candidate_on_every_joint_and_an_impossible_size_is_no_start() {
        let (bench, (data, noise, base)) = four_bar();
        let mut wear = candidates(&bench, &data, &[]);
        wear.retain(|candidate| candidate.kind.name == "clearance-wear");
        let mut scores = scores(&data, &noise, &base, &wear).unwrap();
        let mut parts: Vec<_> = scores.iter().filter_map(|score| score.candidate.part()).collect();
        parts.sort();
        assert_eq!(parts, ["crank_coupler", "rocker_coupler"]);
        // Far beyond the clearance, to which the bounds of the effect do not limit it.
        scores[0].estimate = vec![-1e3];
        let model = base.model.with_effect(scores[0].candidate.clone(), &noise);
        let z = [&base.z[..], &[-40.0]].concat();
        assert!(simulate(&data, &model.at(&z), None).is_err());
        rough_refit(&data, &noise, &base, &scores[0]).unwrap();
    }

    #[test]
    fn a_parameter_at_its_bound_absorbs_nothing_of_an_effect() {
        let (data, noise, base) = calibrated(12.0);
        assert!(base.at_bound().contains(&true), "{:?}", base.z);
        let [score] = &scores(&data, &noise, &base, &[plain("coulomb-level")]).unwrap()[..] else {
            panic!("one score")
        };
        let refitted = rough_refit(&data, &noise, &base, score).unwrap();
        let fall = base.objective - refitted.objective;
        assert!((score.evidence / fall - 1.0).abs() < 0.1, "{} of {fall}", score.evidence);
    }
}
