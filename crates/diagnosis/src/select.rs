//! Forward selection of causes: score, refit, compare; then once more on top of the winner.
//!
//! A cause has to lower chi-square by more than the family-wise threshold (chi-square quantile at [`FAMILY_ERROR`]
//! shared by all candidates) and by more than `p ln n_eff`, and has to lower the error on held-out samples. Chi-square
//! counts in units of the noise of the best model at hand, its excess and correlation included, so that structure which
//! no candidate explains makes the test harder rather than every candidate significant.

use crate::contend::{contend, far_off};
use crate::fit::{Effort, Fit, fit, fit_from};
use crate::gain;
use crate::linear::factor;
use crate::model::{Candidate, Model};
use crate::noise::NoiseModel;
use crate::parameter::Parameter;
use crate::rank::{Score, correlation, scores};
use crate::session::Data;
use bench::respond::RespondError;
use nalgebra::DVector;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Chance that a clean log names anything.
const FAMILY_ERROR: f64 = 0.002;
/// Change of a noise weight that calls for another round.
const SETTLED: f64 = 1.15;
const MOST_ROUNDS: usize = 4;
/// Fall of the objective that shows that a base had stuck.
const STUCK: f64 = 1.0;
/// Most causes at once.
pub(crate) const MOST_CAUSES: usize = 2;
/// First causes beside which a second one is looked for where none explains enough.
const LIKELY: usize = 5;
/// Difference of the criterion within which two candidates fit equally: odds of 20 to 1.
const EQUAL: f64 = 6.0;

/// A refitted candidate of a stage.
pub(crate) struct Contender {
    pub(crate) candidate: Candidate,
    pub(crate) fit: Fit,
    /// Fall of chi-square.
    pub(crate) evidence: f64,
    pub(crate) probability: f64,
    /// Correlation of its projected signature with the best one's.
    pub(crate) correlation: f64,
    criterion: f64,
}

/// One step of the forward selection.
pub(crate) struct Stage {
    /// The model before, fitted with this stage's noise.
    pub(crate) base: Fit,
    /// Refitted candidates, best first.
    pub(crate) contenders: Vec<Contender>,
    /// Candidates that were only searched for on the first cycle, with what they took off chi-square there.
    pub(crate) others: Vec<(Candidate, f64)>,
    pub(crate) noise: NoiseModel,
    pub(crate) threshold: f64,
    /// Whether the best one is a cause.
    pub(crate) accepted: bool,
}

/// What keeps the best candidate of a stage from being a cause, clear as its evidence is.
#[derive(Clone, Copy)]
pub(crate) enum Doubt {
    /// Beside what else moves its size may be nothing.
    Size,
    /// Samples that were not fitted do not gain by it for certain.
    HeldOut,
}

impl Stage {
    /// What keeps its best candidate from being a cause, if that is not its evidence.
    pub(crate) fn doubt(&self) -> Option<(&Candidate, Doubt)> {
        let best = self.contenders.first().filter(|c| !self.accepted && c.evidence > self.threshold)?;
        let is_clear = stands_out(&self.base, &best.fit, self.threshold);
        Some((&best.candidate, if is_clear { Doubt::HeldOut } else { Doubt::Size }))
    }

    /// The causes that it ends with, in the order of their names.
    fn causes(&self) -> Vec<(&'static str, Option<bench::Channel>)> {
        let chosen = self.contenders.first().map(|c| &c.fit.model.chosen);
        let mut causes: Vec<_> = chosen.into_iter().flatten().map(|c| (c.kind.name, c.channel)).collect();
        causes.sort_unstable();
        causes
    }

    /// Whether its base is the model of a `fit` before, and has come out of where that had stuck.
    pub(crate) fn frees(&self, data: &Data, fit: &Fit) -> bool {
        self.base.model.chosen == fit.model.chosen
            && self.base.objective < fit.objective_with(data, &self.noise) - STUCK
    }

    /// Contenders that fit as well as the best one. Not what says the same in more words: a fall with speed that ends far beyond the speeds of the log is a
    /// level, and so is a step before its first sample. They keep their share of the probability.
    pub(crate) fn equals(&self) -> impl Iterator<Item = &Contender> {
        let first = self.contenders.first();
        let best = first.map_or(0.0, |c| c.criterion);
        let repeats = move |c: &Contender| first.is_some_and(|first| c.repeats(first));
        self.contenders.iter().skip(1).filter(move |c| c.criterion - best < EQUAL && !repeats(c))
    }
}

impl Contender {
    /// Whether it has more parameters than another one and ends in the same response, but for what counts as equal.
    fn repeats(&self, other: &Self) -> bool {
        let apart = self.fit.residual.iter().zip(&other.fit.residual).map(|(a, b)| (a - b).powi(2));
        self.fit.model.parameters.len() > other.fit.model.parameters.len() && apart.sum::<f64>() < EQUAL
    }
}

fn threshold(parameters: usize, family: usize) -> f64 {
    let quantile = 1.0 - FAMILY_ERROR / family.max(1) as f64;
    ChiSquared::new(parameters.max(1) as f64).map_or(f64::INFINITY, |d| d.inverse_cdf(quantile))
}

/// The logs as a selection needs them.
pub(crate) struct Views {
    /// Everything.
    pub(crate) whole: Data,
    /// Up to the last fitted sample.
    pub(crate) fitted: Data,
    /// The first cycle.
    pub(crate) coarse: Option<Data>,
}

/// Scores, refits and compares candidates on top of `model`. With `floors` the noise grows by what no candidate explains; without, it stays.
pub(crate) fn stage(
    views: &Views,
    floors: Option<&NoiseModel>,
    mut noise: NoiseModel,
    (model, start): (&Model, &[f64]),
    candidates: &[Candidate],
) -> Result<Stage, RespondError> {
    let data = &views.fitted;
    let free: Vec<Candidate> = candidates.iter().filter(|c| !model.chosen.contains(c)).copied().collect();
    let mut start = start.to_vec();
    let (mut round, mut resumed) = (0, false);
    // Where the best candidate of the round before ended: with other noise the race may be run in another way, and must not lose it where that way leaves the
    // effect out.
    let mut champion: Option<(Model, Vec<f64>)> = None;
    loop {
        round += 1;
        if let (Some(coarse), false) = (&views.coarse, resumed) {
            start = fit(coarse, &noise, model.clone(), start)?.z;
        }
        let base = fit(data, &noise, model.clone(), start.clone())?;
        let scored = scores(data, &noise, &base, &free)?;
        let samples = noise.effective_samples(data).max(2.0);
        let (mut fits, others) = contend(views, &noise, &base, &scored)?;
        if let Some((model, z)) = champion.take()
            && !fits.iter().any(|f| f.model.chosen.last() == model.chosen.last())
        {
            fits.push(fit_from(data, &noise, model, z, None, Effort::FAIR)?);
        }
        let contender = |fit: Fit| {
            let added = fit.model.parameters.len() - base.model.parameters.len();
            let candidate = *fit.model.chosen.last()?;
            let criterion = fit.objective + added as f64 * samples.ln();
            let evidence = base.objective - fit.objective;
            Some(Contender { candidate, fit, evidence, probability: 0.0, correlation: 0.0, criterion })
        };
        let mut contenders: Vec<Contender> = fits.into_iter().filter_map(contender).collect();
        contenders.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
        let best = contenders.first().filter(|c| c.criterion < base.objective).map_or(&base, |c| &c.fit);
        if best.model.chosen.len() > model.chosen.len() {
            champion = Some((best.model.clone(), best.z.clone()));
        }
        // Where the best candidate ended may be a better start for the base: evidence must not be a fit that stuck.
        if round < MOST_ROUNDS && best.model.chosen.len() > model.chosen.len() {
            let again = best.z.iter().take(base.z.len()).copied().collect();
            let near = best.jacobian.iter().take(base.z.len()).cloned().collect();
            let again = fit_from(data, &noise, model.clone(), again, Some(near), Effort::GLANCE)?;
            // A base that stays far off lacks an effect for certain, and a better imitation of it changes nothing.
            if again.objective < base.objective - STUCK && !far_off(&again) {
                start = again.z;
                resumed = true;
                continue;
            }
        }
        let next = floors.map(|floors| floors.inflated(data, &data.residual(&best.simulation.columns)));
        if let Some(next) = next.filter(|next| next.change(&noise) > SETTLED && round < MOST_ROUNDS) {
            noise = next;
            start = base.z;
            continue;
        }
        let added =
            contenders.first().map_or(1, |c| c.fit.model.parameters.len() - base.model.parameters.len());
        let threshold = threshold(added, free.len()).max(added as f64 * samples.ln());
        let stands = |c: &Contender| -> Result<bool, RespondError> {
            let is_clear = c.evidence > threshold && stands_out(&base, &c.fit, threshold);
            Ok(is_clear && gain::improves(&views.whole, &noise, &base, &c.fit)?)
        };
        main_effect_first(&mut contenders, stands)?;
        settle_first(data, &noise, &mut contenders)?;
        let charged = added as f64 * samples.ln();
        weigh(&mut contenders, base.objective, threshold - charged);
        relate(&mut contenders, &base, &scored);
        let accepted = contenders.first().map_or(Ok(false), stands)?;
        return Ok(Stage { base, contenders, others, noise, threshold, accepted });
    }
}

/// The pair of causes that explains most, against the noise that a stage ended with: a second cause beside each of the likely first ones, for what looks best
/// alone may imitate two. Moves the pair's first cause to the stage's front. None where another pair does as well.
pub(crate) fn pair(
    views: &Views,
    first: &mut Stage,
    candidates: &[Candidate],
) -> Result<Option<Stage>, RespondError> {
    // Every parameter of both causes is charged: which of them came first must not count.
    let charge = first.noise.effective_samples(&views.fitted).max(2.0).ln();
    let criterion = |stage: &Stage| {
        let fit = stage.contenders.first().map(|c| &c.fit);
        fit.map_or(f64::INFINITY, |f| f.objective + f.model.parameters.len() as f64 * charge)
    };
    let likely =
        first.contenders.iter().take(LIKELY).enumerate().filter(|(_, c)| c.evidence > first.threshold);
    let found: Result<Vec<(usize, Stage)>, RespondError> = likely
        .map(|(place, c)| {
            Ok((place, stage(views, None, first.noise.clone(), (&c.fit.model, &c.fit.z), candidates)?))
        })
        .collect();
    let mut found: Vec<(usize, Stage)> = found?.into_iter().filter(|(_, s)| s.accepted).collect();
    found.sort_by(|(_, a), (_, b)| criterion(a).total_cmp(&criterion(b)));
    let rival = |best: &Stage, other: &Stage| {
        criterion(other) < criterion(best) + EQUAL && other.causes() != best.causes()
    };
    if found.first().is_some_and(|(_, best)| found.iter().any(|(_, other)| rival(best, other))) {
        return Ok(None);
    }
    let Some((place, best)) = found.into_iter().next() else { return Ok(None) };
    if let Some(stretch) = first.contenders.get_mut(..=place) {
        stretch.rotate_right(1);
    }
    first.accepted = true;
    Ok(Some(best))
}

/// Takes the first contender to its optimum, where the order has brought one to the front that was fitted roughly.
fn settle_first(data: &Data, noise: &NoiseModel, contenders: &mut [Contender]) -> Result<(), RespondError> {
    if let Some(first) = contenders.first_mut().filter(|c| !c.fit.settled) {
        let (model, z) = (first.fit.model.clone(), first.fit.z.clone());
        let settled = fit_from(data, noise, model, z, Some(first.fit.jacobian.clone()), Effort::FULL)?;
        let fall = first.fit.objective - settled.objective;
        first.evidence += fall;
        first.criterion -= fall;
        first.fit = settled;
    }
    Ok(())
}

/// Whether the last effect of a fit is as far from nothing as its evidence says, in its own covariance: one of its sizes, or
/// all together (of a ripple cosine and sine may each be unknown, and its amplitude is not). Its shapes count as known: at size 0 there is nothing that
/// has them, and where a log tells only the product of a size and a shape neither of the two would ever stand out. So do declared numbers that
/// without the effect went as far as they may: what lies farther out is not theirs.
fn stands_out(base: &Fit, fit: &Fit, threshold: f64) -> bool {
    let own = fit.model.of_effect(fit.model.chosen.len() - 1);
    let is_size = |i: &usize| fit.model.parameters.get(*i).is_some_and(Parameter::is_size);
    let stopped = base.stopped();
    let at_bound = |i: &usize| stopped.get(*i).copied().unwrap_or_default();
    let is_free = |i: &usize| if own.contains(i) { is_size(i) } else { !at_bound(i) };
    let free: Vec<usize> = (0..fit.z.len()).filter(is_free).collect();
    let information = fit.information().select_rows(&free).select_columns(&free);
    let Some(covariance) = factor(&information).map(|c| c.inverse()) else { return false };
    let sizes: Vec<usize> = (0..free.len()).filter(|&k| own.contains(&free[k])).collect();
    let z = DVector::from_iterator(sizes.len(), sizes.iter().map(|&k| fit.z[free[k]]));
    let block = covariance.select_rows(&sizes).select_columns(&sizes);
    (0..sizes.len()).any(|k| z[k].powi(2) > threshold * block[(k, k)].max(0.0))
        || factor(&block).is_some_and(|c| c.solve(&z).dot(&z) > threshold)
}

/// Posterior shares from the criterion, the model without any candidate included.
///
/// A candidate of a large library has to be as likely as its threshold says: what that asks beyond the criterion's own
/// charge counts against it.
fn weigh(contenders: &mut [Contender], base: f64, multiplicity: f64) {
    let base = base - multiplicity;
    let least = contenders.iter().map(|c| c.criterion).fold(base, f64::min);
    let weight = |criterion: f64| (-0.5 * (criterion - least)).exp();
    let sum = contenders.iter().fold(weight(base), |sum, c| sum + weight(c.criterion));
    contenders.iter_mut().for_each(|c| c.probability = weight(c.criterion) / sum);
}

fn relate(contenders: &mut [Contender], base: &Fit, scored: &[Score]) {
    let score_of = |candidate: &Candidate| scored.iter().find(|s| s.candidate == *candidate);
    let Some(best) = contenders.first().and_then(|c| score_of(&c.candidate)) else { return };
    for contender in contenders {
        contender.correlation = score_of(&contender.candidate).map_or(0.0, |s| correlation(base, best, s));
    }
}

/// What leaving out the first of two causes would add to the objective, with the second refitted alone.
pub(crate) fn loss_without_first(data: &Data, stage: &Stage, nominal: &Model) -> Result<f64, RespondError> {
    let Some(best) = stage.contenders.first() else { return Ok(f64::INFINITY) };
    let alone = nominal.with(best.candidate, &stage.noise);
    let own = best.fit.model.of_effect(best.fit.model.chosen.len() - 1);
    let mut z: Vec<f64> = best.fit.z.iter().take(nominal.parameters.len()).copied().collect();
    z.extend(own.iter().filter_map(|&i| best.fit.z.get(i)));
    let alone = fit(data, &stage.noise, alone, z)?;
    Ok(alone.objective - best.fit.objective)
}

/// The effect whose refinement an effect is: friction that grows with load refines dry friction.
fn refines(name: &str) -> Option<&'static str> {
    match name {
        "load-dependent-friction" | "coulomb-asymmetry" => Some("coulomb-level"),
        "viscous-asymmetry" => Some("viscous-friction"),
        _ => None,
    }
}

/// A refinement enters after its main effect, if that is a cause by itself (the principle of marginality): moves the
/// main effect to the front if it `stands` and leaves no declared number at the end of what calibration may move that the refinement brings back: what lies
/// beyond is the refinement's own.
/// Where the refinement was the whole truth, the main effect goes again as needless.
fn main_effect_first(
    contenders: &mut [Contender],
    stands: impl Fn(&Contender) -> Result<bool, RespondError>,
) -> Result<(), RespondError> {
    let main = contenders.first().and_then(|c| refines(c.candidate.kind.name));
    let place = contenders.iter().position(|c| Some(c.candidate.kind.name) == main);
    if let Some(stretch) = place.and_then(|p| contenders.get_mut(..=p))
        && let [refinement, .., main] = &*stretch
        && !main.fit.stopped().iter().zip(refinement.fit.stopped()).any(|(main, own)| *main && !own)
        && stands(main)?
    {
        stretch.rotate_right(1);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::simulate;
    use crate::rank::tests::{calibrated, plain};
    use crate::standing::nearest;

    #[test]
    fn a_stage_frees_a_fit_of_its_base_s_model_that_had_stuck_and_no_other() {
        let (data, noise, base) = calibrated(40.0);
        let fitted = |name| {
            let model = base.model.with(plain(name), &noise);
            let start = vec![0.0; model.parameters.len()];
            fit(&data, &noise, model, start).unwrap()
        };
        let stuck = || {
            let mut stuck = fitted("coulomb-level");
            *stuck.z.last_mut().unwrap() *= 0.5;
            stuck.simulation = simulate(&data, &stuck.model.at(&stuck.z), None).unwrap();
            stuck.objective = stuck.objective_with(&data, &noise);
            stuck
        };
        let stage = |base: Fit| {
            let (contenders, others) = (Vec::new(), Vec::new());
            Stage { base, contenders, others, noise: noise.clone(), threshold: 0.0, accepted: false }
        };
        assert!(stage(fitted("coulomb-level")).frees(&data, &stuck()));
        assert!(!stage(fitted("coulomb-level")).frees(&data, &fitted("coulomb-level")));
        assert!(!stage(stuck()).frees(&data, &fitted("coulomb-level")));
        assert!(!stage(fitted("viscous-friction")).frees(&data, &stuck()));
    }

    #[test]
    fn what_keeps_the_nearest_candidate_from_being_a_cause_is_told() {
        // Of forty too much calibration takes four, and the level's size is clear; of one it takes all, and the size may be nothing.
        let stage = |effort: f64, evidence: f64, accepted: bool| {
            let (data, noise, base) = calibrated(effort);
            let model = base.model.with(plain("coulomb-level"), &noise);
            let start = vec![0.0; model.parameters.len()];
            let fit = fit(&data, &noise, model, start).unwrap();
            let candidate = plain("coulomb-level");
            let best =
                Contender { candidate, fit, evidence, probability: 0.0, correlation: 0.0, criterion: 0.0 };
            Stage { base, contenders: vec![best], others: Vec::new(), noise, threshold: 10.0, accepted }
        };
        let reason = |stage: Stage| nearest(&stage).map(|r| (r.causes[0].effect.clone(), r.reason));
        let of = |reason: &str| Some(("coulomb-level".to_owned(), reason.to_owned()));
        assert_eq!(reason(stage(40.0, 11.0, false)), of("held-out-uncertain"));
        assert_eq!(reason(stage(1.0, 11.0, false)), of("size-uncertain"));
        assert_eq!(reason(stage(40.0, 11.0, true)), None);
        assert_eq!(reason(stage(40.0, 9.0, false)), None);
    }
}
