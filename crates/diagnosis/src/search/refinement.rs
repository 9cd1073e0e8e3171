//! Refinement of candidates: the likely ones are refitted, and the best ones to their optimum.
//!
//! Simulations take most of the time of a diagnosis, so each candidate gets only as many as its
//! elimination needs: first a score, then a rough fit from the base's own sensitivities, and a fit
//! to the optimum only if it is near the best.

use super::plausibility::is_plausible;
use super::score::{Score, rough_refit};
use super::size_search::Origin;
use super::threshold::bic_penalty;
use super::tuning;
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use crate::data::views::Views;
use crate::fit::least_squares::{Effort, Fit, fit_from};
use crate::fit::linear::dot;
use crate::fit::model::Candidate;
use crate::fit::simulation::simulate;
use bench::effects::Guess;
use bench::simulate::RespondError;
use rayon::prelude::*;

/// Returns whether a fit is so far from the noise that its sensitivities mean little.
pub(crate) fn is_far_from_noise(fit: &Fit) -> bool {
    fit.objective > tuning::FAR_CHI_SQUARE * fit.residual.len() as f64
}

/// Returns whether an effect changes the same number as a declared parameter on a bound of
/// calibration.
fn moves_parameter_at_bound(base: &Fit, noise: &NoiseModel, candidate: &Candidate) -> bool {
    let at_bound = base.at_bound();
    if !at_bound.contains(&true) {
        return false;
    }
    let model = base.model.with_effect(candidate.clone(), noise);
    let mut z = base.z.clone();
    z.resize(model.parameters.len(), 0.0);
    let is_at_bound = |i: usize| model.alias(&z, i).and_then(|(own, _)| at_bound.get(own).copied());
    (base.z.len()..z.len()).any(|i| is_at_bound(i).unwrap_or_default())
}

/// Fitted candidates, and the eliminated ones with their fall of chi-square on the first cycle.
pub(crate) type Refined = (Vec<Fit>, Vec<(Candidate, f64)>);

/// Fits the likely candidates.
///
/// Near the noise, sensitivities hold and scores select the candidates. A base that is far from the
/// noise has moved its parameters to imitate the missing effect, and its scores mean little. Then
/// every effect of the plant is searched for on the first cycle.
pub(crate) fn refine(
    views: &Views,
    noise: &NoiseModel,
    base: &Fit,
    scored: &[Score],
) -> Result<Refined, RespondError> {
    if is_far_from_noise(base) {
        search_and_refine(views, noise, base, scored)
    } else {
        Ok((refine_by_score(&views.fitted, noise, base, scored)?, Vec::new()))
    }
}

/// Fits the candidates with the highest scores.
fn refine_by_score(
    data: &Data,
    noise: &NoiseModel,
    base: &Fit,
    scored: &[Score],
) -> Result<Vec<Fit>, RespondError> {
    let best = scored.first().map_or(0.0, |s| s.evidence);
    let (min, max) = (
        (tuning::MIN_SCORE_SHARE * best - tuning::SCORE_MARGIN).max(tuning::MIN_SCORE),
        if best < tuning::SMALL_SCORE { tuning::MAX_REFITS_SMALL_SCORE } else { tuning::MAX_REFITS },
    );
    // An effect on a number at its bound is refitted whatever its score: the response is nonlinear
    // there.
    let (at_bound, others): (Vec<&Score>, Vec<&Score>) =
        scored.iter().partition(|s| moves_parameter_at_bound(base, noise, &s.candidate));
    let likely = others.into_iter().filter(|s| s.evidence > min).take(max);
    let group: Vec<&Score> = at_bound.into_iter().chain(likely).collect();
    let rough: Result<Vec<Fit>, RespondError> =
        group.par_iter().map(|s| rough_refit(data, noise, base, s)).collect();
    let mut rough = rough?;
    rough.retain(|f| is_plausible(data, f));
    converge_likely(data, noise, rough)
}

/// Searches for every effect of the plant and the most likely ones of sensors on the first cycle,
/// and fits the best to all samples.
fn search_and_refine(
    views: &Views,
    noise: &NoiseModel,
    base: &Fit,
    scored: &[Score],
) -> Result<Refined, RespondError> {
    let data = &views.fitted;
    // The first cycle does not show an onset or a sensor limit that come later. These start from
    // their guess, on all samples. An axis is inexpensive to simulate.
    let is_axis = base.model.at(&base.z).common.is_axis();
    let is_late =
        |s: &Score| is_axis && matches!(s.candidate.kind.guess, Guess::Onset(_) | Guess::LargestReading);
    let (late, early): (Vec<&Score>, Vec<&Score>) = scored.iter().partition(|s| is_late(s));
    let of_plant = early.iter().filter(|s| s.candidate.channel.is_none());
    let of_sensors = early.iter().filter(|s| s.candidate.channel.is_some()).take(tuning::MAX_REFITS);
    let group: Vec<&Score> = of_plant.chain(of_sensors).copied().collect();
    let first_cycle = views.first_cycle.as_ref().unwrap_or(data);
    let mut near = search_sizes(first_cycle, noise, base, &group)?;
    near.retain(|f| is_plausible(data, f));
    let best = near.first().map_or(0.0, |f| f.objective);
    let margin = tuning::NEAR_CHI_SQUARE.max(tuning::NEAR_SHARE * best);
    let is_near = |f: &&Fit| f.objective < best + margin;
    let far = near.split_off(near.iter().take(tuning::MAX_FULL_FITS).take_while(is_near).count());
    let simulated_base = simulate(first_cycle, &base.model.at(&base.z), None)?;
    let residual = noise.stack(first_cycle, &first_cycle.residual(&simulated_base.columns));
    let fall = |f: &Fit| Some((f.model.effects.last()?.clone(), dot(&residual, &residual) - f.objective));
    let others = far.iter().filter_map(fall).collect();
    let rough: Result<Vec<Fit>, RespondError> =
        near.into_par_iter().map(|f| fit_from(data, noise, f.model, f.z, None, Effort::ROUGH)).collect();
    let late: Result<Vec<Fit>, RespondError> =
        late.into_par_iter().map(|s| rough_refit(data, noise, base, s)).collect();
    let rough = rough?.into_iter().chain(late?).filter(|f| is_plausible(data, f)).collect();
    Ok((converge_likely(data, noise, rough)?, others))
}

/// Searches for the sizes of candidates on few samples and fits the best there, best first;
/// candidates that the plant cannot simulate at any size are dropped.
fn search_sizes(
    few: &Data,
    noise: &NoiseModel,
    base: &Fit,
    candidates: &[&Score],
) -> Result<Vec<Fit>, RespondError> {
    let origin = Origin::new(few, noise, base)?;
    let search = |s: &&Score| Ok((s.candidate.clone(), origin.search(base, s)?));
    let found: Result<Vec<_>, RespondError> = candidates.par_iter().map(search).collect();
    let mut found = found?;
    found.retain(|(_, (_, objective))| objective.is_finite());
    found.sort_by(|a, b| a.1.1.total_cmp(&b.1.1));
    found.truncate(tuning::MAX_CONVERGED_SEARCHES);
    let converge = |(candidate, (z, _)): (Candidate, (Vec<f64>, f64))| {
        fit_from(few, noise, base.model.with_effect(candidate, noise), z, None, Effort::LIMITED)
    };
    let fits: Result<Vec<Fit>, RespondError> = found.into_par_iter().map(converge).collect();
    let mut fits = fits?;
    fits.sort_by(|a, b| a.objective.total_cmp(&b.objective));
    Ok(fits)
}

/// Fits to their optimum those rough fits that may become the best one.
///
/// Each fresh set of sensitivities costs two simulations per parameter; fits far from the best one
/// are not worth them.
fn converge_likely(data: &Data, noise: &NoiseModel, rough: Vec<Fit>) -> Result<Vec<Fit>, RespondError> {
    let bic = |f: &Fit| f.objective + bic_penalty(f.model.parameters.len(), data, noise);
    let best = rough.iter().map(bic).fold(f64::INFINITY, f64::min);
    let expected = rough.first().map_or(0, |f| f.residual.len()) as f64;
    let margin = tuning::ROUGH_MARGIN + tuning::ROUGH_SHARE * (best - expected).max(0.0);
    let converge = |f: Fit| {
        if bic(&f) > best + margin {
            return Ok(f);
        }
        fit_from(data, noise, f.model, f.z, Some(f.jacobian), Effort::FULL)
    };
    rough.into_par_iter().map(converge).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{calibrated, plain};

    #[test]
    fn only_effects_on_a_parameter_at_its_bound_are_refined_regardless_of_their_score() {
        let (_, noise, base) = calibrated(12.0);
        assert!(moves_parameter_at_bound(&base, &noise, &plain("coulomb-level")));
        assert!(!moves_parameter_at_bound(&base, &noise, &plain("viscous-friction")));
        let (_, noise, base) = calibrated(1.0);
        assert!(!moves_parameter_at_bound(&base, &noise, &plain("coulomb-level")));
    }
}
