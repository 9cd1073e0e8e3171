//! One pass of a diagnosis: the logs are split into fitted and held-out samples, causes are
//! selected, and the verdict is decided.
//!
//! 1. The selection finds a first cause, and a second one on top of it. The first one is dropped if
//!    the second makes it unnecessary.
//! 2. If the selection finds no cause, a declared number that is out of tolerance is one
//!    ([`crate::verdict::tolerance`]). Without such a number the verdict is `none` if no structure
//!    remains in the residual and calibration stays within its bounds, else `unknown`.
//! 3. If [`crate::verdict::acceptance`] accepts the selected causes, the verdict is `named`, or
//!    `ambiguous` if another candidate fits equally well. If it accepts none, the verdict is
//!    `unknown`. An accepted cause that changes no channel beyond a small share of its noise is a
//!    note instead ([`crate::verdict::materiality`]).
//!
//! [`Pass::parts`] then searches for causes beside an error that remains.

use crate::check::{Checked, Finding};
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use crate::data::split::Split;
use crate::data::views::Views;
use crate::experiment::proposal::Experiment;
use crate::experiment::proposal::propose;
use crate::fit::held_out_gain::gains;
use crate::fit::model::{Candidate, Model};
use crate::fit::simulation::simulate;
use crate::progress::{self, Step};
use crate::result::{Diagnosis, DiagnosisError};
use crate::search::contender::Contender;
use crate::search::parts::PartSearch;
use crate::search::score::candidates;
use crate::search::selection::{NoisePolicy, Selection, select_causes};
use crate::search::stage::Stage;
use crate::verdict::acceptance::{Rejection, accept, declared_at_bound, nearest_candidate};
use crate::verdict::causes::{EquivalentEffect, causes};
use crate::verdict::effect_name::EffectName;
use crate::verdict::estimates::{calibrated_parameters, log_nuisances};
use crate::verdict::explanation::{Explanation, explanations};
use crate::verdict::identifiability::identifiability;
use crate::verdict::materiality::without_immaterial;
use crate::verdict::noise_summary::noise_summary;
use crate::verdict::nuisance_bounds::findings_at_bounds;
use crate::verdict::parts::Parts;
use crate::verdict::probability::{Shares, posterior_shares, share_probability, unknown_probability};
use crate::verdict::ranking::ranking;
use crate::verdict::remaining_structure::is_confined_to_held_out;
use crate::verdict::residual_bins::binned_residuals;
use crate::verdict::series::series;
use crate::verdict::tolerance::{Numbers, OutOfTolerance};
use crate::verdict::tuning::MIN_UNKNOWN_PROBABILITY;
use crate::verdict::verdict_kind::Verdict;
use bench::Bench;

/// Settings of one pass.
#[derive(Clone, Copy)]
pub(crate) struct Pass<'a> {
    pub(crate) bench: &'a Bench,
    /// Effects that are not considered.
    pub(crate) exclude: &'a [String],
    pub(crate) split: Split,
    pub(crate) noise_policy: NoisePolicy,
}

/// Result of one pass.
pub(crate) struct PassResult {
    pub(crate) diagnosis: Diagnosis,
    /// True if the nominal bench is wrong in held-out samples alone, so that another split may show
    /// more.
    pub(crate) is_wrong_late: bool,
    search: Search,
    /// The calibrated bench without a cause, with the first selected one, and with both.
    explanations: Vec<Explanation>,
    /// Number of accepted causes.
    accepted: usize,
}

/// Logs, models and selected causes of a pass.
struct Search {
    views: Views,
    floors: NoiseModel,
    nominal: Model,
    candidates: Vec<Candidate>,
    selection: Selection,
}

/// Verdict of a diagnosis, its explanation, and probabilities.
struct Answer<'a> {
    verdict: Verdict,
    explanation: &'a Explanation,
    equivalents: Vec<EquivalentEffect>,
    rejection: Option<Rejection>,
    shares: Shares,
    experiment: Option<Experiment>,
    /// Findings about the description.
    findings: Vec<Finding>,
}

impl Pass<'_> {
    /// Diagnoses checked logs; calls `report` before each step.
    pub(crate) fn run(&self, checked: &Checked, report: &dyn Fn(Step)) -> Result<PassResult, DiagnosisError> {
        let bench = self.bench;
        report(progress::PREPARE);
        let data = Data::new(bench, &checked.logs, &checked.held_out, self.split)?;
        let described = simulate(&data, bench, None)?;
        let floors = NoiseModel::from_nominal_residual(bench, &data, &data.residual(&described.columns));
        let views = Views::new(data);
        let nominal = Model::nominal(bench, &views.all).with_nuisances(&views.fitted);
        let candidates = candidates(bench, &views.all, self.exclude);
        report(progress::FIRST_CAUSE);
        let selection = select_causes(&views, self.noise_policy, &floors, &nominal, &candidates, || {
            report(progress::SECOND_CAUSE);
        })?;
        report(progress::VERDICT);
        self.decide(Search { views, floors, nominal, candidates, selection })
    }

    /// Accepts or rejects the selected causes.
    fn decide(&self, search: Search) -> Result<PassResult, DiagnosisError> {
        let Search { views, floors, nominal, selection, .. } = &search;
        let data = &views.all;
        let explanations = explanations(views, floors, nominal, selection)?;
        let (accepted, rejection) = accept(data, &explanations);
        let (accepted, notes) = without_immaterial(data, floors, &explanations, accepted);
        let numbers = Numbers::new(views, floors, &explanations[accepted])?;
        let is_selected = explanations.len() > 1 && notes.is_empty();
        let has_no_cause = accepted == 0 && !is_selected && rejection.is_none();
        if has_no_cause
            && let Some(mut diagnosis) = self.number_out_of_tolerance(&search, &numbers, &explanations[0])?
        {
            diagnosis.checks.extend(notes);
            return Ok(PassResult { diagnosis, is_wrong_late: false, search, explanations, accepted });
        }
        let (calibrated, extended) = (&explanations[0], &explanations[accepted]);
        let last_stage = accepted.checked_sub(1).and_then(|i| selection.stages().nth(i));
        let equivalents: Vec<&Contender> =
            last_stage.map_or_else(Vec::new, |stage| stage.equivalents().collect());
        let parameters = (&extended.model, extended.z.as_slice());
        let is_within_bounds = declared_at_bound(calibrated).next().is_none()
            && findings_at_bounds(data, floors, parameters, extended.held_out.as_ref())?.is_empty();
        let is_clean = has_no_cause && is_within_bounds && numbers.are_within();
        let verdict = match (accepted, extended.remaining.is_some()) {
            (0, false) if is_clean => Verdict::None,
            (0, _) => Verdict::Unknown,
            _ if equivalents.is_empty() => Verdict::Named,
            _ => Verdict::Ambiguous,
        };
        let is_unknown = verdict == Verdict::Unknown;
        let rejection =
            rejection.or_else(|| if is_unknown { nearest_candidate(&selection.first) } else { None });
        let (_, (share, _)) = gains(data, &extended.noise, &calibrated.residual, &extended.residual);
        let mut shares = posterior_shares(data, selection, (accepted, is_unknown), extended, share);
        if verdict == Verdict::None && !notes.is_empty() {
            shares = Shares { none: 1.0 - shares.unknown, unknown: shares.unknown, hypotheses: Vec::new() };
        }
        let experiment = last_stage
            .zip(extended.causes.last())
            .and_then(|(stage, (cause, _))| self.experiment(data, stage, (cause, extended)));
        let known = 1.0 - shares.unknown;
        let equivalents = equivalents.iter().map(|c| EquivalentEffect::new(c, known)).collect();
        let findings = numbers.findings(&[]).into_iter().chain(notes).collect();
        let explanation = extended;
        let answer = Answer { verdict, explanation, equivalents, rejection, shares, experiment, findings };
        let diagnosis = self.report(&search, calibrated, answer)?;
        // A log without two cycles is split the same way by either rule.
        let has_two_cycles = data.logs.iter().any(|log| log.has_two_cycles());
        let is_wrong_late =
            has_two_cycles && is_confined_to_held_out(data, &calibrated.noise, &calibrated.residual);
        Ok(PassResult { diagnosis, is_wrong_late, search, explanations, accepted })
    }

    /// The answer if no cause is accepted and effects explain declared numbers that are out of
    /// tolerance; none otherwise.
    fn number_out_of_tolerance(
        &self,
        search: &Search,
        numbers: &Numbers,
        calibrated: &Explanation,
    ) -> Result<Option<Diagnosis>, DiagnosisError> {
        let Search { views, floors, candidates, selection, .. } = search;
        let (data, first) = (&views.all, &selection.first);
        let found = OutOfTolerance::find(views, floors, candidates, (numbers, calibrated, first))?;
        let Some(mut found) = found else { return Ok(None) };
        let unknown = unknown_probability(data, &found.explanation, 1.0);
        let (equivalents, shares) = found.compare(data, first, unknown)?;
        let answer = Answer {
            verdict: if equivalents.is_empty() { Verdict::Named } else { Verdict::Ambiguous },
            explanation: &found.explanation,
            equivalents,
            rejection: None,
            shares,
            experiment: None,
            findings: numbers.findings(&found.numbers),
        };
        Ok(Some(self.report(search, &found.described, answer)?))
    }

    /// Searches for causes beside the error that remains after a pass; none if no set of causes
    /// leaves a smaller error.
    pub(crate) fn parts(&self, result: &PassResult) -> Result<Option<Diagnosis>, DiagnosisError> {
        let search = &result.search;
        let Search { views, floors, nominal, candidates, selection } = search;
        let (calibrated, accepted) = (&result.explanations[0], &result.explanations[result.accepted]);
        let part_search = PartSearch { views, floors, nominal, candidates, held: &[] };
        let Some(parts) = Parts::find(&part_search, selection, (calibrated, accepted))? else {
            return Ok(None);
        };
        let (data, explanation) = (&views.all, &parts.explanation);
        let (_, (share, _)) = gains(data, &explanation.noise, &calibrated.residual, &explanation.residual);
        let share = share.unwrap_or_default();
        let unknown = match parts.verdict {
            Verdict::Partial => share_probability(share).max(MIN_UNKNOWN_PROBABILITY),
            _ => unknown_probability(data, explanation, share),
        };
        let is_named =
            |name: &EffectName| explanation.causes.iter().any(|(c, _)| EffectName::from(c) == *name);
        let main = parts.stages.get(parts.main).zip(explanation.causes.get(parts.main));
        let main = main.filter(|_| parts.verdict == Verdict::Ambiguous);
        let answer = Answer {
            verdict: parts.verdict,
            explanation,
            equivalents: parts.equivalents().map(|c| EquivalentEffect::new(c, 1.0 - unknown)).collect(),
            rejection: result.diagnosis.rejection.clone().filter(|r| !r.causes.iter().any(is_named)),
            shares: parts.shares(unknown),
            experiment: main
                .and_then(|(stage, (cause, _))| self.experiment(data, stage, (cause, explanation))),
            findings: result.diagnosis.checks.iter().filter(|f| f.kind == "immaterial").cloned().collect(),
        };
        let mut diagnosis = self.report(search, calibrated, answer)?;
        if let Some(front) = diagnosis.causes.get_mut(..=parts.main) {
            front.rotate_right(1);
        }
        Ok(Some(diagnosis))
    }

    /// Proposes an experiment if other candidates fit as well as a cause, the best one of its
    /// stage.
    fn experiment(
        &self,
        data: &Data,
        stage: &Stage,
        (cause, explanation): (&Candidate, &Explanation),
    ) -> Option<Experiment> {
        stage.equivalents().next()?;
        propose(self.bench, data, stage, (cause, &explanation.model, &explanation.z))
    }

    /// Everything that is reported about the bench with the causes of an answer.
    fn report(
        &self,
        search: &Search,
        calibrated: &Explanation,
        answer: Answer<'_>,
    ) -> Result<Diagnosis, DiagnosisError> {
        let Answer { verdict, explanation: extended, equivalents, rejection, shares, experiment, findings } =
            answer;
        let (data, first) = (&search.views.all, &search.selection.first);
        let parameters = (&extended.model, extended.z.as_slice());
        let mut checks = findings_at_bounds(data, &search.floors, parameters, extended.held_out.as_ref())?;
        checks.extend(findings);
        let (gain, (share, interval)) =
            gains(data, &extended.noise, &calibrated.residual, &extended.residual);
        let known = 1.0 - shares.unknown;
        Ok(Diagnosis {
            checks,
            verdict,
            causes: causes(data, extended, known),
            probability_none: shares.none,
            probability_unknown: shares.unknown,
            hypotheses: shares.hypotheses,
            ambiguous_with: equivalents,
            rejection,
            signature: extended.remaining.clone(),
            gain,
            explained_share: share,
            explained_share_ci95: interval,
            next_experiment: experiment.as_ref().map(|e| e.words.clone()),
            experiment,
            extended_bench: None,
            calibrated: calibrated_parameters(extended),
            nuisances: log_nuisances(data, extended),
            noise: noise_summary(data, &extended.noise, &calibrated.residual),
            identifiability: identifiability(data, extended),
            ranking: ranking(first, known),
            threshold: first.threshold,
            extended: Some(extended.model.extended(&extended.z)),
            places: binned_residuals(data, &calibrated.residual, &extended.residual),
            series: series(data, &calibrated.residual, &extended.residual),
        })
    }
}
