//! The diagnosis as a whole, and the rules that make a verdict of the figures.
//!
//! 1. A first cause is accepted by [`crate::select`], and a second one on top of it; the first one goes if the second
//!    makes it needless.
//! 2. No cause: `none` where [`crate::leftover`] finds nothing and calibration stays within its bounds, else `unknown`.
//! 3. Causes that stand ([`crate::standing`]): `named`; `ambiguous` where another candidate fits equally. None that does: `unknown`.
//! 4. An axis that is `unknown` by all that is asked for a pair of causes against the noise floor ([`crate::select::pair`]). A pair counts where it leaves nothing and the
//!    upper end of its share reaches [`PAIR_SHARE`], and where no other pair does as well.

use crate::again::comes_late;
use crate::answer::{calibrated, estimates, noises, nuisances, ranking, series};
use crate::check::{Checked, check};
use crate::experiment::propose;
use crate::fit::{Fit, fit, simulate};
use crate::gain::gains;
use crate::identifiability::identifiability;
use crate::leftover;
use crate::model::{Candidate, Model};
use crate::noise::NoiseModel;
use crate::nuisance::{at_bounds, simulate_all};
use crate::places::places;
use crate::probability::shares;
use crate::rank::candidates;
use crate::result::{Ambiguous, Diagnosis, Signature, Verdict};
use crate::select::{Contender, MOST_CAUSES, Stage, Views, loss_without_first, pair, stage};
use crate::session::{Columns, Data, Split};
use crate::shape::{Misfit, misfit};
use crate::spread::deviations;
use crate::standing::{nearest, standing, stopped};
use bench::log::LogError;
use bench::respond::RespondError;
use bench::{Bench, MeasuredLog};
use nalgebra::DMatrix;

/// What it has to reach for two causes neither of which explains enough alone: two imitate what one cannot.
const PAIR_SHARE: f64 = 0.985;

/// What is told of the progress: the share done, and what comes next.
pub type Progress = dyn Fn(f64, &str) + Sync;

/// Choices of a diagnosis.
#[derive(Clone, Copy, Default)]
pub struct Options<'a> {
    /// Effects that are not considered.
    pub exclude: &'a [String],
    /// Called now and then.
    pub progress: Option<&'a Progress>,
}

/// Why a diagnosis failed.
#[derive(Debug, thiserror::Error)]
pub enum DiagnosisError {
    /// A log is unusable.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The nominal bench cannot be simulated.
    #[error(transparent)]
    Respond(#[from] RespondError),
    /// Nothing to diagnose.
    #[error("no log given; expected at least one")]
    NoLog,
}

/// Diagnoses logs of one bench, which may have been read as found. Without `held_out` a part of each log is held out: the second half of its cycles. Where
/// that names nothing, the log is asked again with stretches held out by turns; that answer counts if it names what the first
/// question could not have learnt: a change that came in the second half, or one so slow that the first half does not tell where it ends, or the end of a sensor's range which the
/// second half reaches more often. The log of a transmission bench, which is dear, only where something is wrong in the second half alone.
/// Where an axis is still unknown, pairs of causes are asked for against the noise floor alone: beside one of two causes the other one passes for noise, and
/// takes the evidence of both. A pair counts if it leaves nothing and may explain all of it.
pub fn diagnose(
    bench: &Bench,
    logs: &[MeasuredLog],
    held_out: &[MeasuredLog],
    options: &Options<'_>,
) -> Result<Diagnosis, DiagnosisError> {
    if logs.is_empty() {
        return Err(DiagnosisError::NoLog);
    }
    let say = |share: f64, words: &str| {
        if let Some(progress) = options.progress {
            progress(share, words);
        }
    };
    say(0.0, "checking the logs");
    let checked = check(bench, logs, held_out)?;
    let (mut judged, late) = answered(bench, &checked, options.exclude, (Split::Halves, Noise::Grows), &say)?;
    if matches!(judged.verdict, Verdict::Unknown | Verdict::None)
        && checked.held_out.is_empty()
        && (late || matches!(bench, Bench::FrictionRig(_)))
    {
        let (again, _) =
            answered(bench, &checked, options.exclude, (Split::Turns, Noise::Grows), &|_, words| {
                say(0.95, words)
            })?;
        if comes_late(&judged.series, &again.causes) {
            judged = again;
        }
    }
    if judged.verdict == Verdict::Unknown && matches!(bench, Bench::FrictionRig(_)) {
        let (again, _) =
            answered(bench, &checked, options.exclude, (Split::Halves, Noise::Stays), &|_, words| {
                say(0.97, words)
            })?;
        if is_whole(&again) {
            judged = again;
        }
    }
    say(1.0, "done");
    let mut checks = checked.findings;
    checks.extend(judged.checks);
    checks.sort_by_key(|f| f.severity);
    Ok(Diagnosis { checks, ..judged })
}

/// What a selection takes for noise.
#[derive(Clone, Copy, PartialEq)]
enum Noise {
    /// What no candidate explains, too.
    Grows,
    /// The floor alone.
    Stays,
}

/// Whether an answer names two causes that leave nothing and may explain all of it.
fn is_whole(answer: &Diagnosis) -> bool {
    matches!(answer.verdict, Verdict::Named | Verdict::Ambiguous)
        && answer.causes.len() > 1
        && answer.signature.is_none()
        && answer.explained_share_ci95.is_some_and(|[_, high]| high >= PAIR_SHARE)
}

/// The answer with one way of holding samples out, and whether the nominal bench is wrong in what was held out alone.
fn answered(
    bench: &Bench,
    checked: &Checked,
    exclude: &[String],
    (split, selection): (Split, Noise),
    say: &dyn Fn(f64, &str),
) -> Result<(Diagnosis, bool), DiagnosisError> {
    say(0.02, "reading the motion");
    let whole = Data::new(bench, &checked.logs, &checked.held_out, split)?;
    let described = simulate(&whole, bench, None)?;
    let floors = NoiseModel::floors(bench, &whole, &whole.residual(&described.columns));
    let fitted = whole.fitted();
    let views = Views { coarse: fitted.coarse(), fitted, whole };
    let nominal = Model::nominal(bench, &views.whole.channels).with_nuisances(&views.fitted);
    let all = candidates(bench, &views.whole, exclude);
    say(0.1, "calibrating, ranking the effects");
    let zero = vec![0.0; nominal.parameters.len()];
    let growing = (selection == Noise::Grows).then_some(&floors);
    let mut stages = vec![stage(&views, growing, floors.clone(), (&nominal, &zero), &all)?];
    while selection == Noise::Grows && stages.len() < MOST_CAUSES {
        let Some(last) = stages.last().filter(|s| s.accepted) else { break };
        let Some(best) = last.contenders.first() else { break };
        say(0.6, "looking for a second cause");
        let next = stage(&views, growing, floors.clone(), (&best.fit.model, &best.fit.z), &all)?;
        stages.push(next);
    }
    let second = match stages.first_mut() {
        Some(first) if selection == Noise::Stays => pair(&views, first, &all)?,
        _ => None,
    };
    stages.extend(second);
    say(0.9, "testing what is left");
    judge(bench, &views, &floors, &nominal, &stages)
}

/// The model that some accepted stages end with.
pub(crate) struct End {
    /// Chosen effects with their probability.
    pub(crate) causes: Vec<(Candidate, f64)>,
    pub(crate) model: Model,
    pub(crate) z: Vec<f64>,
    /// Standard deviations in scaled units.
    pub(crate) deviations: Vec<f64>,
    /// What the data say of the scaled parameters, without priors.
    pub(crate) fisher: DMatrix<f64>,
    /// Residual of all samples.
    pub(crate) residual: Columns,
    pub(crate) noise: NoiseModel,
    pub(crate) left: Option<Signature>,
    /// Nuisances of sessions that were not fitted.
    pub(crate) held_out: Option<Fit>,
    pub(crate) misfit: Misfit,
}

impl End {
    fn new(
        views: &Views,
        floors: &NoiseModel,
        (fit, used): (&Fit, &NoiseModel),
        causes: Vec<(Candidate, f64)>,
    ) -> Result<Self, RespondError> {
        let data = &views.whole;
        let (simulation, held_out) = simulate_all(data, used, &fit.model, &fit.z)?;
        let residual = data.residual(&simulation.columns);
        let noise = floors.inflated(data, &residual);
        let left = leftover::find(data, &noise, &residual);
        let misfit = misfit(&views.fitted, floors, used, fit);
        let (deviations, fisher) = (deviations(&views.fitted, used, fit), fit.fisher());
        let (model, z) = (fit.model.clone(), fit.z.clone());
        Ok(Self { causes, model, z, deviations, fisher, residual, noise, left, held_out, misfit })
    }
}

/// Ends after no stage, after the first accepted one, after the second.
fn ends(
    views: &Views,
    floors: &NoiseModel,
    nominal: &Model,
    stages: &[Stage],
) -> Result<Vec<End>, DiagnosisError> {
    let first = stages.first().ok_or(DiagnosisError::NoLog)?;
    let mut ends = vec![End::new(views, floors, (&first.base, &first.noise), Vec::new())?];
    let mut causes = Vec::new();
    for (k, stage) in stages.iter().enumerate().filter(|(_, s)| s.accepted) {
        let Some(best) = stage.contenders.first() else { break };
        // The next stage begins with the same model and may come out of where this fit had stuck.
        let freed = stages.get(k + 1).filter(|next| next.frees(&views.fitted, &best.fit));
        let (reached, used) = freed.map_or((&best.fit, &stage.noise), |next| (&next.base, &next.noise));
        causes.push((best.candidate, best.probability));
        let loss =
            if causes.len() > 1 { loss_without_first(&views.fitted, stage, nominal)? } else { f64::INFINITY };
        if loss <= stage.threshold {
            causes.remove(0);
            let model = nominal.with(best.candidate, &stage.noise);
            let z: Vec<f64> = best.fit.z.iter().take(nominal.parameters.len()).copied().collect();
            let own = best.fit.model.of_effect(1).into_iter().filter_map(|i| best.fit.z.get(i).copied());
            let alone = fit(&views.fitted, &stage.noise, model, z.into_iter().chain(own).collect())?;
            ends.push(End::new(views, floors, (&alone, &stage.noise), causes.clone())?);
        } else {
            if let ([(_, probability), _], true) = (causes.as_mut_slice(), loss.is_finite()) {
                // Alone it may have lost to its rival; beside it, what counts is what leaving it out would cost.
                *probability = 1.0 / (1.0 + (0.5 * (stage.threshold - loss)).exp());
            }
            ends.push(End::new(views, floors, (reached, used), causes.clone())?);
        }
    }
    Ok(ends)
}

fn judge(
    bench: &Bench,
    views: &Views,
    floors: &NoiseModel,
    nominal: &Model,
    stages: &[Stage],
) -> Result<(Diagnosis, bool), DiagnosisError> {
    let data = &views.whole;
    let ends = ends(views, floors, nominal, stages)?;
    let (standing, refused) = standing(data, &ends);
    let (before, shown) = (&ends[0], &ends[standing]);
    let (gain, (share, interval)) = gains(data, &shown.noise, &before.residual, &shown.residual);
    let deciding = standing.checked_sub(1).and_then(|i| stages.get(i));
    let equals: Vec<&Contender> = deciding.map_or_else(Vec::new, |s| s.equals().collect());
    let checks = at_bounds(data, floors, (&shown.model, &shown.z), shown.held_out.as_ref())?;
    let verdict = match (standing, shown.left.is_some()) {
        (0, false) if ends.len() == 1 && stopped(before).next().is_none() && checks.is_empty() => {
            Verdict::None
        }
        (0, _) => Verdict::Unknown,
        _ if equals.is_empty() => Verdict::Named,
        _ => Verdict::Ambiguous,
    };
    let first = stages.first().ok_or(DiagnosisError::NoLog)?;
    let refused = refused.or_else(|| if verdict == Verdict::Unknown { nearest(first) } else { None });
    let shares = shares(data, stages, (standing, verdict), shown, share);
    let known = 1.0 - shares.unknown;
    let experiment = match (deciding, shown.causes.last()) {
        (Some(stage), Some((cause, _))) if !equals.is_empty() => {
            propose(bench, data, stage, (*cause, &shown.model, &shown.z))
        }
        _ => None,
    };
    // Of a log without two cycles the turns would be the same.
    let halved = data.sessions.iter().any(|s| s.is_halved());
    let late = halved && leftover::is_late(data, &before.noise, &before.residual);
    let diagnosis = Diagnosis {
        checks,
        verdict,
        causes: estimates(shown, known),
        probability_none: shares.none,
        probability_unknown: shares.unknown,
        hypotheses: shares.hypotheses,
        ambiguous_with: equals
            .iter()
            .map(|c| Ambiguous {
                effect: c.candidate.kind.name.into(),
                channel: c.candidate.channel,
                probability: known * c.probability,
                correlation: c.correlation,
            })
            .collect(),
        refused,
        signature: shown.left.clone(),
        gain,
        explained_share: share,
        explained_share_ci95: interval,
        next_experiment: experiment.as_ref().map(|e| e.words.clone()),
        experiment,
        extended_bench: None,
        calibrated: calibrated(shown),
        nuisances: nuisances(data, shown),
        noise: noises(data, &shown.noise, &before.residual),
        identifiability: identifiability(data, shown),
        ranking: ranking(first, known),
        threshold: first.threshold,
        extended: Some(shown.model.at(&shown.z).common),
        places: places(data, &before.residual, &shown.residual),
        series: series(data, &before.residual, &shown.residual),
    };
    Ok((diagnosis, late))
}
