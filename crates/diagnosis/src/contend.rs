//! The race of a stage: which candidates are refitted, and how far.
//!
//! Simulations are what a diagnosis costs, so each candidate gets as many as it takes to see that it is out: a score, a rough
//! fit from the base's own sensitivities, and only near the best a fit to the optimum.

use crate::fit::{Effort, Fit, fit_from, simulate};
use crate::linear::dot;
use crate::model::Candidate;
use crate::noise::NoiseModel;
use crate::rank::{Score, refit};
use crate::search::Origin;
use crate::select::Views;
use crate::session::Data;
use bench::Bench;
use bench::effects::Guess;
use bench::respond::RespondError;
use rayon::prelude::*;

/// Candidates that are refitted.
const GROUP: usize = 8;
/// Chi-square over samples from which a base counts as far off.
const FAR: f64 = 1.5;
/// Distance of objectives on the first cycle, absolute and relative, within which a candidate is fitted on everything,
/// and most of those.
const NEAR: f64 = 400.0;
const NEAR_SHARE: f64 = 1.0;
const CLOSE: usize = 4;
/// How far behind the best a rough fit may be and yet win, absolute and relative to what is above the noise.
const ROUGH: f64 = 60.0;
const ROUGH_SHARE: f64 = 0.3;
/// Most candidates that a search takes to the optimum on the first cycle.
const LIKELY: usize = 5;
/// Least score that is worth a refit.
const WORTH: f64 = 4.0;
/// Near the optimum scores hold: a candidate is out of the race below this share of the best one's, less a margin.
const SHARE: f64 = 0.4;
const MARGIN: f64 = 30.0;
/// Score below which nothing will be accepted, and how many are refitted then.
const SLIGHT: f64 = 12.0;
const FEW: usize = 2;

/// Whether a fit is so far from the noise that its sensitivities mean little.
pub(crate) fn far_off(fit: &Fit) -> bool {
    fit.objective > FAR * fit.residual.len() as f64
}

/// Whether an effect moves the very number of a declared parameter that has gone as far as it may.
fn moves_stopped(base: &Fit, noise: &NoiseModel, candidate: &Candidate) -> bool {
    let stopped = base.stopped();
    if !stopped.contains(&true) {
        return false;
    }
    let model = base.model.with(*candidate, noise);
    let mut z = base.z.clone();
    z.resize(model.parameters.len(), 0.0);
    let number = |i: usize| model.alias(&z, i).and_then(|(own, _)| stopped.get(own).copied());
    (base.z.len()..z.len()).any(|i| number(i).unwrap_or_default())
}

/// Fitted candidates, and the others with their evidence.
pub(crate) type Contest = (Vec<Fit>, Vec<(Candidate, f64)>);

/// Fits the likely candidates; the others with their evidence from the first cycle.
///
/// Near the optimum the scores say which: sensitivities hold. A base that is far off has bent its parameters to imitate
/// what it lacks, and scores there mean little; then every effect of the plant is searched for on the first cycle.
pub(crate) fn contend(
    views: &Views,
    noise: &NoiseModel,
    base: &Fit,
    scored: &[Score],
) -> Result<Contest, RespondError> {
    let data = &views.fitted;
    if !far_off(base) {
        let best = scored.first().map_or(0.0, |s| s.evidence);
        let (least, most) = ((SHARE * best - MARGIN).max(WORTH), if best < SLIGHT { FEW } else { GROUP });
        // What moves a number that calibration would have moved farther is in the race whatever its score: there the response bends.
        let (bent, straight): (Vec<&Score>, Vec<&Score>) =
            scored.iter().partition(|s| moves_stopped(base, noise, &s.candidate));
        let likely = straight.into_iter().filter(|s| s.evidence > least).take(most);
        let group: Vec<&Score> = bent.into_iter().chain(likely).collect();
        let rough: Result<Vec<Fit>, RespondError> =
            group.par_iter().map(|s| refit(data, noise, base, s)).collect();
        let fits = polished(data, noise, rough?);
        return Ok((fits?, Vec::new()));
    }
    // What comes after the first cycle, or is reached after it only, cannot be found in it: an onset and the end of a reading start from their guess, on
    // everything. An axis is cheap.
    let is_axis = matches!(base.model.at(&base.z).common, Bench::FrictionRig(_));
    let is_late =
        |s: &Score| is_axis && matches!(s.candidate.kind.guess, Guess::Onset(_) | Guess::LargestReading);
    let (late, early): (Vec<&Score>, Vec<&Score>) = scored.iter().partition(|s| is_late(s));
    let of_plant = early.iter().filter(|s| s.candidate.channel.is_none());
    let of_sensors = early.iter().filter(|s| s.candidate.channel.is_some()).take(GROUP);
    let group: Vec<&Score> = of_plant.chain(of_sensors).copied().collect();
    let coarse = views.coarse.as_ref().unwrap_or(data);
    let origin = Origin::new(coarse, noise, base)?;
    let glance = |s: &&Score| Ok((s.candidate, origin.search(base, s)?));
    let found: Result<Vec<_>, RespondError> = group.par_iter().map(glance).collect();
    let mut found = found?;
    // Of an effect that the plant takes in no size there is nothing to go on from.
    found.retain(|(_, (_, objective))| objective.is_finite());
    found.sort_by(|a, b| a.1.1.total_cmp(&b.1.1));
    found.truncate(LIKELY);
    // To the optimum on the first cycle, then on everything for those that come near the best.
    let settle = |(candidate, (z, _)): (Candidate, (Vec<f64>, f64))| {
        fit_from(coarse, noise, base.model.with(candidate, noise), z, None, Effort::FAIR)
    };
    let settled: Result<Vec<Fit>, RespondError> = found.into_par_iter().map(settle).collect();
    let mut settled = settled?;
    settled.sort_by(|a, b| a.objective.total_cmp(&b.objective));
    let best = settled.first().map_or(0.0, |f| f.objective);
    let near = NEAR.max(NEAR_SHARE * best);
    let close = settled.iter().take(CLOSE).take_while(|f| f.objective < best + near).count();
    let far = settled.split_off(close);
    let imitation = simulate(coarse, &base.model.at(&base.z), None)?;
    let imitation = noise.stack(coarse, &coarse.residual(&imitation.columns));
    let taken = |f: &Fit| Some((*f.model.chosen.last()?, dot(&imitation, &imitation) - f.objective));
    let others = far.iter().filter_map(taken).collect();
    let rough: Result<Vec<Fit>, RespondError> =
        settled.into_par_iter().map(|f| fit_from(data, noise, f.model, f.z, None, Effort::GLANCE)).collect();
    let late: Result<Vec<Fit>, RespondError> =
        late.into_par_iter().map(|s| refit(data, noise, base, s)).collect();
    let rough = rough?.into_iter().chain(late?).collect();
    Ok((polished(data, noise, rough)?, others))
}

/// Rough fits of which those that may win are taken to the optimum. A fresh set of sensitivities costs two simulations a
/// parameter; what is far behind the best needs none.
fn polished(data: &Data, noise: &NoiseModel, rough: Vec<Fit>) -> Result<Vec<Fit>, RespondError> {
    let samples = noise.effective_samples(data).max(2.0);
    let criterion = |f: &Fit| f.objective + f.model.parameters.len() as f64 * samples.ln();
    let best = rough.iter().map(criterion).fold(f64::INFINITY, f64::min);
    let noisy = rough.first().map_or(0, |f| f.residual.len()) as f64;
    let behind = ROUGH + ROUGH_SHARE * (best - noisy).max(0.0);
    let polish = |f: Fit| {
        if criterion(&f) > best + behind {
            return Ok(f);
        }
        fit_from(data, noise, f.model, f.z, Some(f.jacobian), Effort::FULL)
    };
    rough.into_par_iter().map(polish).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rank::tests::{calibrated, plain};

    #[test]
    fn what_moves_a_stopped_number_races_and_nothing_else_does_for_that() {
        let (_, noise, base) = calibrated(12.0);
        assert!(moves_stopped(&base, &noise, &plain("coulomb-level")));
        assert!(!moves_stopped(&base, &noise, &plain("viscous-friction")));
        let (_, noise, base) = calibrated(1.0);
        assert!(!moves_stopped(&base, &noise, &plain("coulomb-level")));
    }
}
