//! One stage of the forward selection: scores, refits and compares all candidates on top of a
//! model.
//!
//! A cause must lower chi-square by more than the family-wise threshold and by more than the BIC
//! penalty ([`super::threshold`]), have a significant size, and lower the error on held-out
//! samples. Chi-square is in units of the noise of the best model at hand, including its excess and
//! correlation. So structure that no candidate explains makes the test harder, instead of making
//! every candidate significant.

use super::contender::{Contender, assign_correlations, assign_probabilities};
use super::marginality::move_main_effect_first;
use super::plausibility::is_plausible;
use super::refinement::{is_far_from_noise, refine};
use super::score::{Score, scores};
use super::threshold::{bic_penalty, family_threshold};
use super::tuning;
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use crate::data::views::Views;
use crate::fit::held_out_gain::lowers_held_out_error;
use crate::fit::least_squares::{Effort, Fit, fit, fit_from, objective};
use crate::fit::model::{Candidate, Model};
use crate::fit::simulation::simulate;
use bench::simulate::RespondError;

/// Result of one stage.
pub(crate) struct Stage {
    /// The model without a new candidate, fitted with this stage's noise.
    pub(crate) base: Fit,
    /// Refitted candidates, best first.
    pub(crate) contenders: Vec<Contender>,
    /// Candidates that were eliminated on the first cycle, with their fall of chi-square there.
    pub(crate) others: Vec<(Candidate, f64)>,
    /// Noise that chi-square is in units of.
    pub(crate) noise: NoiseModel,
    /// Fall of chi-square that a cause must exceed.
    pub(crate) threshold: f64,
    /// Part of the threshold beyond the BIC penalty.
    pub(crate) multiplicity: f64,
    /// Part of the best contender's BIC that was subtracted because it is the incumbent.
    pub(crate) discount: f64,
    /// True if the best contender is a cause.
    pub(crate) has_cause: bool,
}

impl Stage {
    /// The best contender, if its evidence is clear and it is not a cause.
    pub(crate) fn rejected_contender(&self) -> Option<&Contender> {
        self.contenders.first().filter(|c| !self.has_cause && c.evidence > self.threshold)
    }

    /// Returns whether its base is the model of an earlier `fit` that had stopped at a local
    /// minimum, and has left this minimum.
    pub(crate) fn improves_on_stuck(&self, data: &Data, fit: &Fit) -> bool {
        self.base.model.effects == fit.model.effects
            && self.base.objective < fit.objective_with(data, &self.noise) - tuning::STUCK_MARGIN
    }

    /// Drops contenders from the best one on until one is a cause that `is_kept` accepts; without
    /// such a contender, nothing is a cause.
    pub(crate) fn first_kept(
        mut self,
        views: &Views,
        floors: &NoiseModel,
        is_kept: &impl Fn(&Self) -> Result<bool, RespondError>,
    ) -> Result<Self, RespondError> {
        if self.has_cause && is_kept(&self)? {
            return Ok(self);
        }
        for _ in 0..tuning::MAX_FALLBACKS {
            if self.contenders.len() < 2 {
                break;
            }
            self.contenders.remove(0);
            self.discount = 0.0;
            let Some(best) = self.contenders.first_mut() else { break };
            let data = &views.fitted;
            best.converge(data, &self.noise)?;
            // The noise contains what the dropped contender explains.
            let noise = floors.inflated(data, &data.residual(&best.fit.simulation.columns));
            let evidence = self.base.objective_with(data, &noise) - best.fit.objective_with(data, &noise);
            let is_clear = evidence > self.threshold;
            self.has_cause = is_clear && is_cause(views, &self.noise, &self.base, self.threshold, best)?;
            assign_probabilities(&mut self.contenders, self.base.objective, self.multiplicity);
            if self.has_cause && is_kept(&self)? {
                return Ok(self);
            }
        }
        self.has_cause = false;
        Ok(self)
    }

    /// Contenders that fit as well as the best one, except those that restate it with more
    /// parameters.
    ///
    /// Examples are a fall of friction at speeds far beyond those of the log, which restates a
    /// level, and a step before the first sample. Such contenders keep their share of the
    /// probability.
    pub(crate) fn equivalents(&self) -> impl Iterator<Item = &Contender> {
        let first = self.contenders.first();
        let best = first.map_or(0.0, |c| c.bic) + self.discount;
        let restates = move |c: &Contender| first.is_some_and(|first| c.restates(first));
        let others = self.contenders.iter().skip(1);
        others.filter(move |c| c.bic - best < tuning::EQUIVALENT_BIC && !restates(c))
    }
}

/// Scores, refits and compares candidates on top of `model`.
///
/// With `floors`, the noise is inflated by the residual that no candidate explains; without, it
/// stays as given. A round is repeated while its result changes the noise, or provides a better
/// start for the base. The last effect of an `incumbent` stays the first contender unless another
/// candidate fits better by more than chance allows the best of them.
pub(crate) fn run_stage(
    views: &Views,
    floors: Option<&NoiseModel>,
    mut noise: NoiseModel,
    (model, start): (&Model, &[f64]),
    candidates: &[Candidate],
    incumbent: Option<(Model, Vec<f64>)>,
) -> Result<Stage, RespondError> {
    let data = &views.fitted;
    let addable: Vec<Candidate> = candidates.iter().filter(|c| !model.effects.contains(c)).cloned().collect();
    let mut start = start.to_vec();
    let mut round = 0;
    let mut is_resumed = false;
    // Model and parameters of the best candidate of the last round. With other noise other
    // candidates may be refined, and the best one must not be lost.
    let own = incumbent.as_ref().and_then(|(model, _)| model.effects.last().cloned());
    let mut best_so_far: Option<(Model, Vec<f64>)> = None;
    loop {
        round += 1;
        let is_last = round >= tuning::MAX_ROUNDS;
        if let (Some(first_cycle), false) = (&views.first_cycle, is_resumed) {
            start = fit(first_cycle, &noise, model.clone(), start)?.z;
        }
        let incumbents = incumbent.iter().cloned().chain(best_so_far.take());
        let current = Round::run(views, &noise, (model, &start), &addable, incumbents)?;
        let best = current.best();
        let has_candidate = best.model.effects.len() > model.effects.len();
        if has_candidate {
            best_so_far = Some((best.model.clone(), best.z.clone()));
        }
        if !is_last
            && has_candidate
            && let Some(better) = better_start(data, &noise, &current.base, best)?
        {
            start = better;
            is_resumed = true;
            continue;
        }
        let inflated = floors.map(|floors| floors.inflated(data, &data.residual(&best.simulation.columns)));
        let changed = inflated.filter(|next| next.max_weight_change(&noise) > tuning::NOISE_TOLERANCE);
        if let Some(changed) = changed.filter(|_| !is_last) {
            noise = changed;
            start = current.base.z;
            continue;
        }
        return current.conclude(views, noise, addable.len(), own);
    }
}

/// One comparison of all candidates with one noise.
struct Round {
    base: Fit,
    scored: Vec<Score>,
    /// Best first.
    contenders: Vec<Contender>,
    others: Vec<(Candidate, f64)>,
}

impl Round {
    /// Fits the base, scores the candidates and refines the likely ones.
    fn run(
        views: &Views,
        noise: &NoiseModel,
        (model, start): (&Model, &[f64]),
        candidates: &[Candidate],
        incumbents: impl Iterator<Item = (Model, Vec<f64>)>,
    ) -> Result<Self, RespondError> {
        let data = &views.fitted;
        let base = fit(data, noise, model.clone(), start.to_vec())?;
        let scored = scores(data, noise, &base, candidates)?;
        let (mut fits, others) = refine(views, noise, &base, &scored)?;
        for (model, z) in incumbents {
            keep_better(data, noise, &mut fits, (model, z))?;
        }
        fits.retain(|f| is_plausible(data, f));
        let contender = |fit: Fit| {
            let added = fit.model.parameters.len() - base.model.parameters.len();
            let candidate = fit.model.effects.last()?.clone();
            let bic = fit.objective + bic_penalty(added, data, noise);
            let evidence = base.objective - fit.objective;
            Some(Contender { candidate, fit, evidence, probability: 0.0, correlation: 0.0, bic })
        };
        let mut contenders: Vec<Contender> = fits.into_iter().filter_map(contender).collect();
        contenders.sort_by(|a, b| a.bic.total_cmp(&b.bic));
        Ok(Self { base, scored, contenders, others })
    }

    /// The best fit by BIC, which may be the base.
    fn best(&self) -> &Fit {
        self.contenders.first().filter(|c| c.bic < self.base.objective).map_or(&self.base, |c| &c.fit)
    }

    /// Decides whether the best of the round's contenders, out of a `family` of candidates, is a
    /// cause.
    fn conclude(
        self,
        views: &Views,
        noise: NoiseModel,
        family: usize,
        incumbent: Option<Candidate>,
    ) -> Result<Stage, RespondError> {
        let Self { base, scored, mut contenders, others } = self;
        let data = &views.fitted;
        let added =
            contenders.first().map_or(1, |c| c.fit.model.parameters.len() - base.model.parameters.len());
        let penalty = bic_penalty(added, data, &noise);
        let threshold = family_threshold(added, family).max(penalty);
        let is_cause = |c: &Contender| is_cause(views, &noise, &base, threshold, c);
        move_main_effect_first(&mut contenders, is_cause)?;
        let multiplicity = threshold - penalty;
        let discount = incumbent.map_or(0.0, |own| favour(&mut contenders, own, multiplicity));
        if let Some(first) = contenders.first_mut() {
            first.converge(data, &noise)?;
        }
        assign_probabilities(&mut contenders, base.objective, multiplicity);
        assign_correlations(&mut contenders, &base, &scored);
        let has_cause = contenders.first().map_or(Ok(false), is_cause)?;
        Ok(Stage { base, contenders, others, noise, threshold, multiplicity, discount, has_cause })
    }
}

/// Returns whether a contender has clear evidence, a significant size, and a lower error on
/// held-out samples.
fn is_cause(
    views: &Views,
    noise: &NoiseModel,
    base: &Fit,
    threshold: f64,
    contender: &Contender,
) -> Result<bool, RespondError> {
    let is_clear = contender.evidence > threshold && contender.has_significant_size(base, threshold);
    Ok(is_clear && lowers_held_out_error(&views.all, noise, base, &contender.fit)?)
}

/// Adds the fit of a model from `z`, unless a fit of its last effect is already as good as `z`.
fn keep_better(
    data: &Data,
    noise: &NoiseModel,
    fits: &mut Vec<Fit>,
    (model, z): (Model, Vec<f64>),
) -> Result<(), RespondError> {
    if let Some(place) = fits.iter().position(|f| f.model.effects.last() == model.effects.last()) {
        let simulation = simulate(data, &model.at(&z), None)?;
        let start = objective(data, noise, &model, (&z, &simulation));
        if fits.get(place).is_some_and(|f| f.objective <= start) {
            return Ok(());
        }
        fits.remove(place);
    }
    fits.push(fit_from(data, noise, model, z, None, Effort::LIMITED)?);
    Ok(())
}

/// Charges the choice among a family of candidates to the challengers of an incumbent, and moves
/// the incumbent to the front if it then fits as well as the best one.
///
/// `multiplicity` is the part of the threshold beyond the BIC penalty. It is subtracted from the
/// BIC of an incumbent that is moved, and returned; 0 without such an incumbent.
fn favour(contenders: &mut [Contender], incumbent: Candidate, multiplicity: f64) -> f64 {
    let best = contenders.first().map_or(0.0, |c| c.bic);
    let is_favoured =
        |c: &Contender| c.candidate == incumbent && c.bic - multiplicity - best < tuning::EQUIVALENT_BIC;
    let place = contenders.iter().position(is_favoured);
    let Some(better) = place.and_then(|place| contenders.get_mut(..=place)) else { return 0.0 };
    better.rotate_right(1);
    if let Some(own) = better.first_mut() {
        own.bic -= multiplicity;
    }
    multiplicity
}

/// A better start for the base from the end of the best candidate; none if the base gains nothing
/// there.
///
/// A base at a local minimum would give every candidate too much evidence. A base that stays far
/// from the noise lacks an effect, and imitating it a little better changes nothing.
fn better_start(
    data: &Data,
    noise: &NoiseModel,
    base: &Fit,
    best: &Fit,
) -> Result<Option<Vec<f64>>, RespondError> {
    let z = best.z.iter().take(base.z.len()).copied().collect();
    let jacobian = best.jacobian.iter().take(base.z.len()).cloned().collect();
    let retried = fit_from(data, noise, base.model.clone(), z, Some(jacobian), Effort::ROUGH)?;
    let is_better = retried.objective < base.objective - tuning::STUCK_MARGIN && !is_far_from_noise(&retried);
    Ok(is_better.then_some(retried.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{calibrated, plain};

    #[test]
    fn the_evidence_of_a_cause_exceeds_the_bic_penalty_and_the_family_threshold() {
        let (data, noise, base) = calibrated(40.0);
        let (model, z) = (base.model.clone(), base.z.clone());
        let views = Views::new(data);
        let candidates = [plain("coulomb-level"), plain("viscous-friction")];
        let stage = run_stage(&views, None, noise, (&model, &z), &candidates, None).unwrap();
        let best = &stage.contenders[0];
        let penalty = bic_penalty(1, &views.fitted, &stage.noise);
        assert!((best.bic - best.fit.objective - penalty).abs() < 1e-6 && penalty > 5.0, "{penalty}");
        assert_eq!(stage.threshold, penalty.max(family_threshold(1, 2)));
        assert!(stage.has_cause && best.candidate == candidates[0]);
    }

    #[test]
    fn a_stage_replaces_only_a_fit_of_the_same_model_that_stopped_at_a_local_minimum() {
        let (data, noise, base) = calibrated(40.0);
        let fitted = |name| {
            let model = base.model.with_effect(plain(name), &noise);
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
            let (noise, threshold, multiplicity, discount) = (noise.clone(), 0.0, 0.0, 0.0);
            Stage { base, contenders, others, noise, threshold, multiplicity, discount, has_cause: false }
        };
        assert!(stage(fitted("coulomb-level")).improves_on_stuck(&data, &stuck()));
        assert!(!stage(fitted("coulomb-level")).improves_on_stuck(&data, &fitted("coulomb-level")));
        assert!(!stage(stuck()).improves_on_stuck(&data, &fitted("coulomb-level")));
        assert!(!stage(fitted("viscous-friction")).improves_on_stuck(&data, &stuck()));
    }
}
