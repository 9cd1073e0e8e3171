//! Verdict in parts: causes that certainly help are named, and the remaining error is reported
//! beside them.
//!
//! A cause must explain no fixed share of the error. It must be a cause in its place beside all
//! others ([`crate::search::parts`]), and without it the held-out error must rise by
//! [`tuning::MIN_PART_RISE`] or more. None of its shapes may reach the end of its range, and the
//! interval of its size must not contain 0. The main effect of another cause is exempt from rise
//! and interval, because the two are correlated. Its size must not differ between parts of the log
//! ([`super::size_consistency`]) beyond the noise with all that remains: an imitation of an unknown
//! effect leaves an error that follows the imitation.
//!
//! Causes that were accepted before are only given up for a set that is accepted, too. Otherwise
//! the parts are what helps beside them and leaves their sizes clear.

use super::acceptance::is_acceptable;
use super::effect_name::EffectName;
use super::explanation::Explanation;
use super::probability::{Hypothesis, Shares};
use super::size_consistency::last_inconsistency;
use super::tuning;
use crate::data::logs::{Columns, Data};
use crate::data::noise::NoiseModel;
use crate::data::split::Use;
use crate::data::views::Views;
use crate::fit::held_out_gain::{all_residuals, is_lower};
use crate::fit::least_squares::Fit;
use crate::fit::model::{Candidate, Model};
use crate::fit::standard_deviations::standard_deviations;
use crate::fit::tuning::Z_95;
use crate::search::contender::Contender;
use crate::search::parts::{PartSearch, Set};
use crate::search::selection::Selection;
use crate::search::stage::Stage;
use crate::verdict::verdict_kind::Verdict;
use bench::simulate::RespondError;

/// Causes beside an error that remains.
pub(crate) struct Parts {
    pub(crate) explanation: Explanation,
    /// One stage for each cause, in their order.
    pub(crate) stages: Vec<Stage>,
    /// Position of the cause without which the error rises most.
    pub(crate) main: usize,
    pub(crate) verdict: Verdict,
}

impl Parts {
    /// Searches from the accepted causes or, without any, from the selected ones and from the best
    /// pair. Returns the parts that leave the smallest error, if this error is significantly
    /// smaller on held-out samples than that of the `accepted` explanation.
    ///
    /// If the parts replace an accepted cause and do not explain enough to be accepted themselves,
    /// they are searched for again beside the accepted causes.
    pub(crate) fn find(
        search: &PartSearch<'_>,
        selection: &Selection,
        (calibrated, accepted): (&Explanation, &Explanation),
    ) -> Result<Option<Self>, RespondError> {
        let views = search.views;
        let is_kept = |stage: &Stage| is_kept(views, stage);
        let found = if accepted.causes.is_empty() {
            let mut starts: Vec<Set> = Vec::new();
            starts.extend(selection.selected().map(|fit| (fit.model.clone(), fit.z.clone())));
            starts.extend(search.best_pair(&selection.first, &is_kept)?);
            Self::best(search, starts, (calibrated, accepted), &is_kept)?
        } else {
            Self::beside(search, (calibrated, accepted), &is_kept)?
        };
        let Some(parts) = found else { return Ok(None) };
        let (noise, before) = (&parts.explanation.noise, &accepted.residual);
        // A set that is not accepted replaces no accepted one, and says that an error remains.
        let is_answer = parts.verdict != Verdict::Partial
            || (accepted.causes.is_empty() && parts.explanation.remaining.is_some());
        Ok((is_answer && is_lower(&views.all, noise, before, &parts.explanation.residual)).then_some(parts))
    }

    /// Parts from the accepted causes on, which keep these causes if the parts are not accepted
    /// otherwise.
    fn beside(
        search: &PartSearch<'_>,
        (calibrated, accepted): (&Explanation, &Explanation),
        is_kept: &impl Fn(&Stage) -> Result<bool, RespondError>,
    ) -> Result<Option<Self>, RespondError> {
        let start = || vec![(accepted.model.clone(), accepted.z.clone())];
        let free = Self::best(search, start(), (calibrated, accepted), is_kept)?;
        if free.as_ref().is_none_or(|parts| parts.verdict != Verdict::Partial) {
            return Ok(free);
        }
        let held: Vec<Candidate> = accepted.causes.iter().map(|(cause, _)| cause.clone()).collect();
        let (model, z, deviations) = (&accepted.model, &accepted.z, &accepted.deviations);
        let sizes = model.effects.iter().enumerate();
        let clear = sizes.filter(|(i, _)| has_clear_size(model, z, deviations, *i));
        let clear: Vec<Candidate> = clear.map(|(_, cause)| cause.clone()).collect();
        let is_kept_beside = |stage: &Stage| Ok(is_kept(stage)? && are_clear(search.views, stage, &clear));
        let search = PartSearch { held: &held, ..*search };
        Self::best(&search, start(), (calibrated, accepted), &is_kept_beside)
    }

    /// The parts from the start that leads to the smallest error.
    fn best(
        search: &PartSearch<'_>,
        starts: Vec<Set>,
        (calibrated, accepted): (&Explanation, &Explanation),
        is_kept: &impl Fn(&Stage) -> Result<bool, RespondError>,
    ) -> Result<Option<Self>, RespondError> {
        let (views, floors) = (search.views, search.floors);
        let mut best: Option<(f64, Vec<Stage>)> = None;
        for start in starts {
            let stages = search.run(start, is_kept)?;
            let Some(fit) = complete_fit(&stages) else { continue };
            let error = fit.objective_with(&views.fitted, floors);
            if best.as_ref().is_none_or(|(min, _)| error < *min) {
                best = Some((error, stages));
            }
        }
        match best {
            Some((_, stages)) => Self::new(views, floors, stages, (calibrated, accepted)),
            None => Ok(None),
        }
    }

    fn new(
        views: &Views,
        floors: &NoiseModel,
        stages: Vec<Stage>,
        (calibrated, accepted): (&Explanation, &Explanation),
    ) -> Result<Option<Self>, RespondError> {
        let causes =
            stages.iter().filter_map(|s| s.contenders.first()).map(|c| (c.candidate.clone(), c.probability));
        let causes: Vec<(Candidate, f64)> = causes.collect();
        let without: Result<Vec<Columns>, RespondError> =
            stages.iter().map(|s| all_residuals(&views.all, &s.noise, &s.base)).collect();
        let without = without?;
        let error = |residual: &Columns| held_out_power(&views.all, floors, residual);
        let errors: Vec<f64> = without.iter().map(error).collect();
        let Some(main) = (0..errors.len()).max_by(|&a, &b| errors[a].total_cmp(&errors[b])) else {
            return Ok(None);
        };
        let Some(fitted) = stages.last().zip(complete_fit(&stages)).map(|(s, fit)| (fit, &s.noise)) else {
            return Ok(None);
        };
        let mut explanation = Explanation::new(views, floors, fitted, causes, without)?;
        let names = |stage: &Stage| rivals(stage).map(|c| EffectName::from(&c.candidate)).collect();
        explanation.alternatives = stages.iter().map(names).collect();
        let is_in_set = |(own, _): &(Candidate, f64)| explanation.causes.iter().any(|(c, _)| c == own);
        let contains_accepted = !accepted.causes.is_empty() && accepted.causes.iter().all(is_in_set);
        let is_complete = contains_accepted || is_acceptable(&views.all, calibrated, &explanation);
        let mut parts = Self { explanation, stages, main, verdict: Verdict::Partial };
        if is_complete {
            let is_alone = parts.equivalents().next().is_none();
            parts.verdict = if is_alone { Verdict::Named } else { Verdict::Ambiguous };
        }
        Ok(Some(parts))
    }

    /// Contenders that fit as well as the main cause in its place.
    pub(crate) fn equivalents(&self) -> impl Iterator<Item = &Contender> {
        self.stages.get(self.main).into_iter().flat_map(rivals)
    }

    /// Probabilities of the set with each contender in the place of the main cause, and without
    /// any; `unknown` is the probability of an unknown cause.
    pub(crate) fn shares(&self, unknown: f64) -> Shares {
        let known = 1.0 - unknown;
        let Some(stage) = self.stages.get(self.main) else {
            return Shares { none: known, unknown, hypotheses: Vec::new() };
        };
        let others = self.explanation.causes.iter().enumerate().filter(|(i, _)| *i != self.main);
        let others: Vec<EffectName> = others.map(|(_, (c, _))| EffectName::from(c)).collect();
        let with = |c: &Contender| Hypothesis {
            causes: std::iter::once(EffectName::from(&c.candidate)).chain(others.iter().cloned()).collect(),
            probability: known * c.probability,
        };
        let mut hypotheses: Vec<Hypothesis> = stage.contenders.iter().map(with).collect();
        let rest = (known - hypotheses.iter().map(|h| h.probability).sum::<f64>()).max(0.0);
        let none = if others.is_empty() { rest } else { 0.0 };
        if !others.is_empty() {
            hypotheses.push(Hypothesis { causes: others, probability: rest });
        }
        hypotheses.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        Shares { none, unknown, hypotheses }
    }
}

/// Contenders that fit as well as the first one of a stage, except generalisations of it that fit
/// no better.
fn rivals(stage: &Stage) -> impl Iterator<Item = &Contender> {
    let best = stage.contenders.first();
    let is_needless = move |c: &Contender| {
        best.is_some_and(|b| c.candidate.kind.generalises == Some(b.candidate.kind.name) && c.bic >= b.bic)
    };
    stage.equivalents().filter(move |c| !is_needless(c))
}

/// The fit of the complete set of causes.
fn complete_fit(stages: &[Stage]) -> Option<&Fit> {
    stages.last()?.contenders.first().map(|c| &c.fit)
}

/// Returns whether the best contender of a stage may be named beside the causes of its base.
fn is_kept(views: &Views, stage: &Stage) -> Result<bool, RespondError> {
    let Some(best) = stage.contenders.first() else { return Ok(false) };
    let data = &views.all;
    let error = |fit: &Fit| -> Result<f64, RespondError> {
        Ok(held_out_power(data, &stage.noise, &all_residuals(data, &stage.noise, fit)?).sqrt())
    };
    let is_material =
        is_main_effect(&best.fit) || error(&stage.base)? >= (1.0 + tuning::MIN_PART_RISE) * error(&best.fit)?;
    let differs = || last_inconsistency(&views.fitted, &stage.noise, &best.fit).is_significant;
    Ok(is_material && has_certain_parameters(views, &stage.noise, &best.fit) && !differs())
}

/// Returns whether the last effect of a fit has a size whose interval does not contain 0, or is the
/// main effect of another one, and no shape whose interval reaches the end of its range.
fn has_certain_parameters(views: &Views, noise: &NoiseModel, fit: &Fit) -> bool {
    let Some((_, others)) = fit.model.effects.split_last() else { return false };
    let deviations = standard_deviations(&views.fitted, noise, fit);
    let reach = |i: usize| Z_95 * deviations[i];
    let is_inside = |i: usize| {
        let p = &fit.model.parameters[i];
        let (min, max) = p.bounds();
        !(p.is_shape() && p.is_factor) || (fit.z[i] - reach(i) > min && fit.z[i] + reach(i) < max)
    };
    (is_main_effect(fit) || has_clear_size(&fit.model, &fit.z, &deviations, others.len()))
        && fit.model.effect_parameters(others.len()).into_iter().all(is_inside)
}

/// Returns whether the interval of a size of an effect does not contain 0.
fn has_clear_size(model: &Model, z: &[f64], deviations: &[f64], effect: usize) -> bool {
    let mut own = model.effect_parameters(effect).into_iter();
    own.any(|i| model.parameters[i].is_size() && z[i].abs() > Z_95 * deviations[i])
}

/// Returns whether the sizes of given causes are clear beside the best contender of a stage.
fn are_clear(views: &Views, stage: &Stage, causes: &[Candidate]) -> bool {
    let Some(fit) = stage.contenders.first().map(|c| &c.fit) else { return false };
    let deviations = standard_deviations(&views.fitted, &stage.noise, fit);
    let mut effects = fit.model.effects.iter().enumerate().filter(|(_, effect)| causes.contains(effect));
    effects.all(|(i, _)| has_clear_size(&fit.model, &fit.z, &deviations, i))
}

/// Returns whether the last effect of a fit is the main effect of another one.
fn is_main_effect(fit: &Fit) -> bool {
    let Some((last, others)) = fit.model.effects.split_last() else { return false };
    others.iter().any(|other| other.kind.refines == Some(last.kind.name))
}

/// Mean square of held-out samples in units of the noise floors.
fn held_out_power(data: &Data, noise: &NoiseModel, residual: &Columns) -> f64 {
    let (mut sum, mut count) = (0.0, 0usize);
    for (block, values) in data.blocks.iter().zip(residual) {
        let floor = noise.channel(block.channel).floor;
        for (value, _) in values.iter().zip(data.uses(block)).filter(|(_, u)| **u == Use::HeldOut) {
            sum += (value / floor).powi(2);
            count += 1;
        }
    }
    sum / count.max(1) as f64
}
