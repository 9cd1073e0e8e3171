//! Which effects could explain the residual: a score test for every one, a joint refit for the likely ones.
//!
//! The score test takes the sensitivity `C` to an effect at zero, projects out what the uncertain parameters can absorb
//! (with their priors as pseudo-observations), and gives the fall of chi-square that the effect promises, `g' M^-1 g`
//! with `M = C'C - (J'C)' A^-1 (J'C)`, `g = C'r - (J'C)' A^-1 (J'r - P z)`, `A = J'J + P`.

use crate::fit::{Effort, Fit, fit, fit_from, sensitivities, simulate};
use crate::guess;
use crate::linear::{dot, factor, gram, project};
use crate::model::{Candidate, Model};
use crate::noise::NoiseModel;
use crate::parameter::Parameter;
use crate::session::Data;
use bench::Bench;
use bench::effects::CATALOGUE;
use bench::respond::RespondError;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Share of an effect's sensitivity that has to survive the projection.
const LEAST_SURVIVAL: f64 = 1e-13;

/// The score of a candidate against a fitted model.
pub(crate) struct Score {
    pub(crate) candidate: Candidate,
    /// Promised fall of chi-square.
    pub(crate) evidence: f64,
    /// Promised scaled parameters.
    pub(crate) estimate: Vec<f64>,
    /// Signature of those: weighted, before the projection.
    signature: Vec<f64>,
    /// `J'` of the signature.
    shadow: DVector<f64>,
}

/// Every effect of the catalogue that this bench and these channels can show.
pub(crate) fn candidates(bench: &Bench, data: &Data, excluded: &[String]) -> Vec<Candidate> {
    let mut out = Vec::new();
    for kind in CATALOGUE.iter().filter(|k| !excluded.iter().any(|e| e == k.name)) {
        if kind.parameters(bench).is_empty() {
            continue;
        }
        if kind.per_channel {
            out.extend(data.channels.iter().map(|&c| Candidate { kind, channel: Some(c), guess: None }));
        } else {
            out.push(Candidate { kind, channel: None, guess: None });
        }
    }
    out
}

/// Scores candidates against a fitted model, most evidence first.
pub(crate) fn scores(
    data: &Data,
    noise: &NoiseModel,
    base: &Fit,
    candidates: &[Candidate],
) -> Result<Vec<Score>, RespondError> {
    let Some(information) = factor(&base.held_information()) else { return Ok(Vec::new()) };
    let left = base.gradient();
    let nominal = base.model.parameters.len();
    let score = |candidate: &Candidate| -> Result<Option<Score>, RespondError> {
        let model = base.model.with(*candidate, noise);
        // At size 0 shapes show nothing.
        let sized = |i: &usize| model.parameters.get(*i).is_some_and(Parameter::is_size);
        let which: Vec<usize> = (nominal..model.parameters.len()).filter(sized).collect();
        // A derivative at 0 is blind to what is guessed.
        let reach = |i: usize| match candidate.guess.filter(|_| candidate.guesses_size()) {
            Some(guess) => guess.value / guess.step,
            None => model.parameters[i].step(),
        };
        let columns: Result<Vec<_>, RespondError> =
            which.iter().map(|&i| secant(data, noise, base, &model, (i, reach(i)))).collect();
        let columns = columns?;
        let shadows: Vec<DVector<f64>> = columns.iter().map(|c| project(&base.jacobian, c)).collect();
        let whole = gram(&columns);
        let mut survived = whole.clone();
        let mut g = project(&columns, &base.residual);
        for (i, shadow) in shadows.iter().enumerate() {
            let absorbed = information.solve(shadow);
            g[i] -= absorbed.dot(&left);
            for (j, other) in shadows.iter().enumerate() {
                survived[(i, j)] -= absorbed.dot(other);
            }
        }
        if (0..which.len()).any(|i| survived[(i, i)] <= LEAST_SURVIVAL * whole[(i, i)].max(f64::MIN_POSITIVE))
        {
            return Ok(None);
        }
        let Some(estimate) = factor(&survived).map(|c| c.solve(&g)) else { return Ok(None) };
        let backwards =
            which.iter().zip(estimate.iter()).any(|(&i, &b)| b < 0.0 && model.parameters[i].one_sided());
        let evidence = if backwards { 0.0 } else { g.dot(&estimate) };
        let signature = combine(&columns, &estimate);
        let shadow =
            shadows.iter().zip(estimate.iter()).fold(DVector::zeros(nominal), |sum, (s, &b)| sum + s * b);
        let mut own = vec![0.0; model.parameters.len() - nominal];
        for (&i, &b) in which.iter().zip(estimate.iter()) {
            own[i - nominal] = b;
        }
        Ok(Some(Score { candidate: *candidate, evidence, estimate: own, signature, shadow }))
    };
    let guessed: Vec<Candidate> = guess::guessed(data, noise, base, candidates)?;
    let found: Result<Vec<_>, RespondError> = guessed.par_iter().map(score).collect();
    let mut scores: Vec<Score> = found?.into_iter().flatten().collect();
    scores.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    // Of a candidate with several guesses the best one stays.
    let mut seen: Vec<Candidate> = Vec::with_capacity(scores.len());
    scores.retain(|s| {
        let first = !seen.contains(&s.candidate);
        seen.push(s.candidate);
        first
    });
    Ok(scores)
}

/// The change of the response from no effect to a size, per scaled unit.
///
/// One-sided, as a score only says who is worth a fit: a second simulation of every effect would be a third of a diagnosis. An
/// effect that moves the very number that an uncertain parameter moves has that parameter's sensitivity, see [`sensitivities`].
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

fn combine(columns: &[Vec<f64>], factors: &DVector<f64>) -> Vec<f64> {
    let mut out = vec![0.0; columns.first().map_or(0, Vec::len)];
    for (column, &f) in columns.iter().zip(factors.iter()) {
        out.iter_mut().zip(column).for_each(|(o, c)| *o += f * c);
    }
    out
}

/// Correlation of two projected signatures, 0 to 1.
pub(crate) fn correlation(base: &Fit, a: &Score, b: &Score) -> f64 {
    let information: DMatrix<f64> = base.held_information();
    let Some(information) = factor(&information) else { return 0.0 };
    let inner =
        |a: &Score, b: &Score| dot(&a.signature, &b.signature) - information.solve(&a.shadow).dot(&b.shadow);
    let norm = (inner(a, a) * inner(b, b)).sqrt();
    if norm > 0.0 { (inner(a, b).abs() / norm).min(1.0) } else { 0.0 }
}

/// Refits a candidate together with everything that `base` moves, from the base's own sensitivities: to see what it can take
/// off. [`crate::select`] takes the likely ones to their optimum.
pub(crate) fn refit(data: &Data, noise: &NoiseModel, base: &Fit, score: &Score) -> Result<Fit, RespondError> {
    let model = base.model.with(score.candidate, noise);
    let mut z = base.z.clone();
    z.extend(&score.estimate);
    for (z, p) in z.iter_mut().zip(&model.parameters) {
        let (least, most) = p.bounds();
        *z = z.clamp(least, most);
    }
    // A size that the plant cannot take is no start.
    let Ok(simulation) = simulate(data, &model.at(&z), Some(&base.simulation)) else {
        return fit(data, noise, model, z);
    };
    let added: Vec<usize> = (base.z.len()..z.len()).collect();
    let mut jacobian = base.jacobian.clone();
    jacobian.extend(sensitivities(data, noise, &model, &z, &simulation, &added)?);
    fit_from(data, noise, model, z, Some(jacobian), Effort::GLANCE)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::session::Split;
    use bench::effects::{Effect, kind};
    use bench::record::record;

    /// An effect of the plant as it stands in the catalogue.
    pub(crate) fn plain(name: &str) -> Candidate {
        Candidate { kind: kind(name).unwrap(), channel: None, guess: None }
    }

    /// A rig with `effort` more dry friction than described, of which calibration may take up four.
    pub(crate) fn calibrated(effort: f64) -> (Data, NoiseModel, Fit) {
        let mut bench = Bench::open("friction-rig").unwrap();
        if let Bench::FrictionRig(rig) = &mut bench {
            rig.uncertain = [("axis.coulomb_effort".to_owned(), 1.0)].into();
        }
        let mut truth = bench.clone();
        let parameters = [("coulomb_effort".to_owned(), effort)].into();
        truth.effects_mut().push(Effect { name: "coulomb-level".into(), channel: None, parameters });
        let data = Data::new(&bench, &[record(&truth, 3).unwrap()], &[], Split::Halves).unwrap();
        let described = simulate(&data, &bench, None).unwrap();
        let noise = NoiseModel::floors(&bench, &data, &data.residual(&described.columns));
        let model = Model::nominal(&bench, &data.channels);
        let start = vec![0.0; model.parameters.len()];
        let base = fit(&data, &noise, model, start).unwrap();
        (data, noise, base)
    }

    #[test]
    fn a_number_at_its_bound_takes_up_nothing_of_an_effect() {
        let (data, noise, base) = calibrated(12.0);
        assert!(base.stopped().contains(&true), "{:?}", base.z);
        let [score] = &scores(&data, &noise, &base, &[plain("coulomb-level")]).unwrap()[..] else {
            panic!("one score")
        };
        let refitted = refit(&data, &noise, &base, score).unwrap();
        let fall = base.objective - refitted.objective;
        assert!((score.evidence / fall - 1.0).abs() < 0.1, "{} of {fall}", score.evidence);
    }
}
