//! Causes of which each helps beside all others, where no explanation is complete.
//!
//! A real bench differs from its description in more than one way, and some of them are in no
//! catalogue. Causes are then added one at a time, or two where only both are clear, and afterwards
//! each is compared with all other candidates in its place:
//!
//! * it is dropped if it is no cause there ([`super::stage`]), or if `is_kept` refuses it;
//! * it is replaced if another candidate fits better there.
//!
//! A held cause may be dropped, but no other candidate takes its place.
//!
//! This repeats until nothing changes. Noise is always inflated by the residual of the complete
//! set, so structure that no candidate explains makes every test harder.

use super::contender::Contender;
use super::stage::{Stage, run_stage};
use super::tuning;
use crate::data::noise::NoiseModel;
use crate::data::views::Views;
use crate::fit::model::{Candidate, Model};
use bench::simulate::RespondError;

/// Search for parts: the logs, their noise floors, the nominal model and the candidates.
pub(crate) struct PartSearch<'a> {
    pub(crate) views: &'a Views,
    pub(crate) floors: &'a NoiseModel,
    pub(crate) nominal: &'a Model,
    pub(crate) candidates: &'a [Candidate],
    /// Causes that no other candidate replaces.
    pub(crate) held: &'a [Candidate],
}

/// A model with effects and its scaled parameters.
pub(crate) type Set = (Model, Vec<f64>);

impl PartSearch<'_> {
    /// Searches from a set of causes. Returns one stage for each cause of the final set:
    /// its base has all other causes, and its first contender is the cause. The last of these
    /// contenders is the fit of the complete set.
    ///
    /// Returns no stage if no cause remains, or if the set does not settle.
    pub(crate) fn run(
        &self,
        start: Set,
        is_kept: &impl Fn(&Stage) -> Result<bool, RespondError>,
    ) -> Result<Vec<Stage>, RespondError> {
        let grown = self.grow(start, is_kept)?;
        self.settle(grown, is_kept)
    }

    /// The best pair of a contender of `first` and a cause beside it; none without such a cause.
    ///
    /// The best single cause may imitate two others, each of which alone explains little.
    pub(crate) fn best_pair(
        &self,
        first: &Stage,
        is_kept: &impl Fn(&Stage) -> Result<bool, RespondError>,
    ) -> Result<Option<Set>, RespondError> {
        self.best_second(likely_sets(first.contenders.iter()), self.candidates, is_kept)
    }

    /// The best cause on top of one of several sets, with that set; none without such a cause.
    fn best_second(
        &self,
        firsts: Vec<Set>,
        candidates: &[Candidate],
        is_kept: &impl Fn(&Stage) -> Result<bool, RespondError>,
    ) -> Result<Option<Set>, RespondError> {
        let mut best: Option<(f64, Set)> = None;
        for set in firsts {
            let compared = self.compare(&set, None, candidates)?;
            let stage = compared.first_kept(self.views, self.floors, is_kept)?;
            let Some(second) = stage.contenders.into_iter().next().filter(|_| stage.has_cause) else {
                continue;
            };
            let error = second.fit.objective_with(&self.views.fitted, self.floors);
            if best.as_ref().is_none_or(|(min, _)| error < *min) {
                best = Some((error, (second.fit.model, second.fit.z)));
            }
        }
        Ok(best.map(|(_, set)| set))
    }

    /// Adds the best candidate while it is a cause that is kept. If no single candidate is one at
    /// the start, adds the best two without shapes.
    ///
    /// The error of one of two missing causes hides the other, so that only both are clear. Two
    /// causes with shapes could imitate almost any unknown effect.
    fn grow(
        &self,
        mut set: Set,
        is_kept: &impl Fn(&Stage) -> Result<bool, RespondError>,
    ) -> Result<Set, RespondError> {
        let start = set.0.effects.len();
        let plain: Vec<Candidate> =
            self.candidates.iter().filter(|c| !self.nominal.has_shape(c)).cloned().collect();
        while set.0.effects.len() < tuning::MAX_PARTS {
            let compared = self.compare(&set, None, self.candidates)?;
            let firsts = likely_sets(compared.contenders.iter().filter(|c| plain.contains(&c.candidate)));
            let stage = compared.first_kept(self.views, self.floors, is_kept)?;
            let best = stage.contenders.into_iter().next().filter(|_| stage.has_cause);
            let next = match best {
                Some(best) => Some((best.fit.model, best.fit.z)),
                None if set.0.effects.len() == start => self.best_second(firsts, &plain, is_kept)?,
                None => None,
            };
            let Some(next) = next else { break };
            set = next;
        }
        Ok(set)
    }

    /// Compares each cause with all others in its place until nothing changes.
    fn settle(
        &self,
        mut set: Set,
        is_kept: &impl Fn(&Stage) -> Result<bool, RespondError>,
    ) -> Result<Vec<Stage>, RespondError> {
        let mut settled: Vec<Stage> = Vec::new();
        for _ in 0..tuning::MAX_PART_STAGES {
            let Some(own) = set.0.effects.first().cloned() else { break };
            let fitted = (&set.0, set.1.as_slice());
            let later = 1..set.0.effects.len();
            let others = self.nominal.with_effects_of(fitted, later.clone(), self.floors);
            let complete = self.nominal.with_effects_of(fitted, later.chain([0]), self.floors);
            let only = std::slice::from_ref(&own);
            let candidates = if self.held.contains(&own) { only } else { self.candidates };
            let compared = self.compare(&others, Some(complete), candidates)?;
            let stage = compared.first_kept(self.views, self.floors, is_kept)?;
            match stage.contenders.first() {
                Some(best) if stage.has_cause => {
                    if best.candidate != own {
                        settled.clear();
                    }
                    set = (best.fit.model.clone(), best.fit.z.clone());
                    settled.push(stage);
                    if settled.len() == set.0.effects.len() {
                        return Ok(settled);
                    }
                }
                _ => {
                    settled.clear();
                    set = (stage.base.model, stage.base.z);
                }
            }
        }
        Ok(Vec::new())
    }

    /// Compares candidates on top of a set.
    fn compare(
        &self,
        (model, z): &Set,
        incumbent: Option<Set>,
        candidates: &[Candidate],
    ) -> Result<Stage, RespondError> {
        let floors = self.floors;
        run_stage(self.views, Some(floors), floors.clone(), (model, z.as_slice()), candidates, incumbent)
    }
}

/// The sets of the most likely ones of some contenders.
fn likely_sets<'a>(contenders: impl Iterator<Item = &'a Contender>) -> Vec<Set> {
    contenders.take(tuning::MAX_PAIR_FIRSTS).map(|c| (c.fit.model.clone(), c.fit.z.clone())).collect()
}
