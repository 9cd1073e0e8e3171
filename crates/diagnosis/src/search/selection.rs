//! Forward selection of causes: a first stage, and a second one on top of its best contender; or
//! the best pair of causes.

use super::stage::{Stage, run_stage};
use super::threshold::bic_penalty;
use super::tuning;
use crate::data::noise::NoiseModel;
use crate::data::views::Views;
use crate::fit::least_squares::Fit;
use crate::fit::model::{Candidate, Model};
use bench::Channel;
use bench::simulate::RespondError;

/// Noise by which a selection divides the residual.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoisePolicy {
    /// The floor, inflated by the residual of the best model at hand.
    InflateByResidual,
    /// The floor alone.
    FloorOnly,
}

/// Stages of a forward selection.
pub(crate) struct Selection {
    /// Search for a first cause.
    pub(crate) first: Stage,
    /// Search for a second cause on top of the first one; none if there is no first one.
    pub(crate) second: Option<Stage>,
}

impl Selection {
    /// Stages in their order.
    pub(crate) fn stages(&self) -> impl Iterator<Item = &Stage> {
        std::iter::once(&self.first).chain(&self.second)
    }

    /// The fit of the selected causes; none without causes.
    pub(crate) fn selected(&self) -> Option<&Fit> {
        let last = self.stages().filter(|stage| stage.has_cause).last()?;
        last.contenders.first().map(|c| &c.fit)
    }
}

/// Selects up to two causes from `candidates` on top of the nominal model.
///
/// `on_second_cause` is called before the search for a second cause on top of the first one.
pub(crate) fn select_causes(
    views: &Views,
    policy: NoisePolicy,
    floors: &NoiseModel,
    nominal: &Model,
    candidates: &[Candidate],
    on_second_cause: impl FnOnce(),
) -> Result<Selection, RespondError> {
    let start = vec![0.0; nominal.parameters.len()];
    let inflated = (policy == NoisePolicy::InflateByResidual).then_some(floors);
    let mut first = run_stage(views, inflated, floors.clone(), (nominal, &start), candidates, None)?;
    let second = match (policy, first.contenders.first()) {
        (NoisePolicy::FloorOnly, _) => select_pair(views, &mut first, candidates)?,
        (NoisePolicy::InflateByResidual, Some(best)) if first.has_cause => {
            on_second_cause();
            let base = (&best.fit.model, best.fit.z.as_slice());
            Some(run_stage(views, inflated, floors.clone(), base, candidates, None)?)
        }
        _ => None,
    };
    Ok(Selection { first, second })
}

/// Selects the pair of causes that explains most, with the noise of the first stage; none if
/// another pair explains as much.
///
/// A second cause is searched for beside each of the likely first ones, because the best single one
/// may imitate two. The first cause of the pair moves to the front of the first stage.
fn select_pair(
    views: &Views,
    first: &mut Stage,
    candidates: &[Candidate],
) -> Result<Option<Stage>, RespondError> {
    // The penalty counts every parameter of both causes, so that their order does not matter.
    let noise = first.noise.clone();
    let bic = |stage: &Stage| {
        stage.contenders.first().map_or(f64::INFINITY, |c| {
            c.fit.objective + bic_penalty(c.fit.model.parameters.len(), &views.fitted, &noise)
        })
    };
    let likely = first.contenders.iter().take(tuning::MAX_PAIR_FIRSTS).enumerate();
    let mut found: Vec<(usize, Stage)> = Vec::new();
    for (index, contender) in likely.filter(|(_, c)| c.evidence > first.threshold) {
        let base = (&contender.fit.model, contender.fit.z.as_slice());
        let stage = run_stage(views, None, first.noise.clone(), base, candidates, None)?;
        if stage.has_cause {
            found.push((index, stage));
        }
    }
    found.sort_by(|(_, a), (_, b)| bic(a).total_cmp(&bic(b)));
    let is_rival = |best: &Stage, other: &Stage| {
        bic(other) < bic(best) + tuning::EQUIVALENT_BIC && cause_set(other) != cause_set(best)
    };
    if found.first().is_some_and(|(_, best)| found.iter().any(|(_, other)| is_rival(best, other))) {
        return Ok(None);
    }
    let Some((index, best)) = found.into_iter().next() else { return Ok(None) };
    if let Some(better) = first.contenders.get_mut(..=index) {
        better.rotate_right(1);
    }
    first.has_cause = true;
    Ok(Some(best))
}

/// Effects of the best contender of a stage, sorted by name.
fn cause_set(stage: &Stage) -> Vec<(&'static str, Option<Channel>, Option<&str>)> {
    let chosen = stage.contenders.first().map(|c| &c.fit.model.effects);
    let mut causes: Vec<_> =
        chosen.into_iter().flatten().map(|c| (c.kind.name, c.channel, c.of.as_deref())).collect();
    causes.sort_unstable();
    causes
}
