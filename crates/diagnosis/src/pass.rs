//! One pass of a diagnosis: the logs are split into fitted and held-out samples, causes are
//! selected, and the verdict is decided.
//!
//! 1. The selection finds a first cause, and a second one on top of it. The first one is dropped if
//!    the second makes it unnecessary.
//! 2. If the selection finds no cause, the verdict is `none` if no structure remains in the
//!    residual and calibration stays within its bounds, else `unknown`.
//! 3. If [`crate::verdict::acceptance`] accepts the selected causes, the verdict is `named`, or
//!    `ambiguous` if another candidate fits equally well. If it accepts none, the verdict is
//!    `unknown`.

use crate::check::Checked;
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use crate::data::split::Split;
use crate::data::views::Views;
use crate::experiment::proposal::propose;
use crate::fit::held_out_gain::gains;
use crate::fit::model::Model;
use crate::fit::simulation::simulate;
use crate::progress::{self, Step};
use crate::result::{Diagnosis, DiagnosisError, Verdict};
use crate::search::contender::Contender;
use crate::search::score::candidates;
use crate::search::selection::{NoisePolicy, Selection, select_causes};
use crate::verdict::acceptance::{accept, declared_at_bound, nearest_candidate};
use crate::verdict::causes::{EquivalentEffect, causes};
use crate::verdict::estimates::{calibrated_parameters, log_nuisances};
use crate::verdict::explanation::explanations;
use crate::verdict::identifiability::identifiability;
use crate::verdict::noise_summary::noise_summary;
use crate::verdict::nuisance_bounds::findings_at_bounds;
use crate::verdict::probability::posterior_shares;
use crate::verdict::ranking::ranking;
use crate::verdict::remaining_structure::is_confined_to_held_out;
use crate::verdict::residual_bins::binned_residuals;
use crate::verdict::series::series;
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
        let nominal = Model::nominal(bench, &views.all.channels).with_nuisances(&views.fitted);
        let all = candidates(bench, &views.all, self.exclude);
        report(progress::FIRST_CAUSE);
        let selection = select_causes(&views, self.noise_policy, &floors, &nominal, &all, || {
            report(progress::SECOND_CAUSE);
        })?;
        report(progress::VERDICT);
        self.decide(&views, &floors, &nominal, &selection)
    }

    /// Accepts or rejects the selected causes, and reports everything about the bench with the
    /// accepted ones.
    fn decide(
        &self,
        views: &Views,
        floors: &NoiseModel,
        nominal: &Model,
        selection: &Selection,
    ) -> Result<PassResult, DiagnosisError> {
        let data = &views.all;
        let explanations = explanations(views, floors, nominal, selection)?;
        let (accepted, rejection) = accept(data, &explanations);
        let (calibrated, extended) = (&explanations[0], &explanations[accepted]);
        let (gain, (share, interval)) =
            gains(data, &extended.noise, &calibrated.residual, &extended.residual);
        let last_stage = accepted.checked_sub(1).and_then(|i| selection.stages().nth(i));
        let equivalents: Vec<&Contender> =
            last_stage.map_or_else(Vec::new, |stage| stage.equivalents().collect());
        let parameters = (&extended.model, extended.z.as_slice());
        let checks = findings_at_bounds(data, floors, parameters, extended.held_out.as_ref())?;
        let is_clean =
            explanations.len() == 1 && declared_at_bound(calibrated).next().is_none() && checks.is_empty();
        let verdict = match (accepted, extended.remaining.is_some()) {
            (0, false) if is_clean => Verdict::None,
            (0, _) => Verdict::Unknown,
            _ if equivalents.is_empty() => Verdict::Named,
            _ => Verdict::Ambiguous,
        };
        let is_unknown = verdict == Verdict::Unknown;
        let rejection =
            rejection.or_else(|| if is_unknown { nearest_candidate(&selection.first) } else { None });
        let shares = posterior_shares(data, selection, (accepted, is_unknown), extended, share);
        let known = 1.0 - shares.unknown;
        let experiment = match (last_stage, extended.causes.last()) {
            (Some(stage), Some((cause, _))) if !equivalents.is_empty() => {
                propose(self.bench, data, stage, (*cause, &extended.model, &extended.z))
            }
            _ => None,
        };
        // A log without two cycles is split the same way by either rule.
        let has_two_cycles = data.logs.iter().any(|log| log.has_two_cycles());
        let is_wrong_late =
            has_two_cycles && is_confined_to_held_out(data, &calibrated.noise, &calibrated.residual);
        let diagnosis = Diagnosis {
            checks,
            verdict,
            causes: causes(extended, known),
            probability_none: shares.none,
            probability_unknown: shares.unknown,
            hypotheses: shares.hypotheses,
            ambiguous_with: equivalents.iter().map(|c| EquivalentEffect::new(c, known)).collect(),
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
            ranking: ranking(&selection.first, known),
            threshold: selection.first.threshold,
            extended: Some(extended.model.at(&extended.z).common),
            places: binned_residuals(data, &calibrated.residual, &extended.residual),
            series: series(data, &calibrated.residual, &extended.residual),
        };
        Ok(PassResult { diagnosis, is_wrong_late })
    }
}
