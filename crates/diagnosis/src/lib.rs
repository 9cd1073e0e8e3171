#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod check;
mod data;
mod digits;
mod evaluation;
mod experiment;
mod fit;
#[cfg(test)]
mod fixtures;
mod inspection;
mod pass;
mod progress;
mod result;
mod search;
mod statistics;
mod verdict;

pub use check::{Finding, Severity};
pub use digits::four_digits;
pub use evaluation::{ChannelComparison, Evaluation, LogComparison, evaluate};
pub use experiment::proposal::{Experiment, Recording, Separation};
pub use fit::held_out_gain::Gain;
pub use inspection::channels::ChannelQuality;
pub use inspection::motions::MotionAdvice;
pub use inspection::parameters::DeclaredParameter;
pub use inspection::{Inspection, LogSummary, inspect};
pub use result::{Diagnosis, DiagnosisError};
pub use verdict::acceptance::Rejection;
pub use verdict::causes::{Cause, EquivalentEffect, ParameterEstimate};
pub use verdict::effect_name::EffectName;
pub use verdict::estimates::{CalibratedParameter, LogNuisance};
pub use verdict::identifiability::Identifiability;
pub use verdict::noise_summary::Noise;
pub use verdict::probability::Hypothesis;
pub use verdict::ranking::RankedCandidate;
pub use verdict::remaining_structure::RemainingStructure;
pub use verdict::residual_bins::{BinnedResidual, ResidualBin};
pub use verdict::series::Series;
pub use verdict::verdict_kind::Verdict;

use bench::{Bench, MeasuredLog};
use check::{Checked, check};
use data::split::Split;
use pass::Pass;
use progress::Step;
use search::selection::NoisePolicy;
use verdict::second_pass::names_late_cause;
use verdict::tuning::PAIR_SHARE_UPPER;

/// Receiver of progress reports: the share done (0 to 1) and the next step.
pub type Progress = dyn Fn(f64, &str) + Sync;

/// Options of a diagnosis.
#[derive(Clone, Copy, Default)]
pub struct Options<'a> {
    /// Effects that are not considered.
    pub exclude: &'a [String],
    /// Called before each step.
    pub progress: Option<&'a Progress>,
}

/// Diagnoses logs of one bench.
///
/// Logs are checked first, so they may contain wrong units, signs or outliers. Without `held_out`
/// logs, the second half of the cycles of each log is held out. Up to three passes follow:
///
/// 1. Causes are selected with the second half held out and the noise inflated by the residual.
/// 2. If that names no cause and there are no `held_out` logs, samples are held out in interleaved
///    blocks instead.
///    Transmission-bench logs are expensive to simulate, so they are split again only if the error
///    is confined to the second half. The second pass counts if it names a cause that the first one
///    could not learn: a change in the second half, an effect too slow to settle in the first half,
///    or a sensor limit that is reached mostly in the second half.
/// 3. If the verdict for a driven axis is still `unknown`, pairs of causes are selected against the
///    noise floor alone, because with inflated noise each of two causes hides the other. A pair
///    counts if no structure remains and it may explain the complete residual.
///
/// If structure remains after the first pass on a driven axis, up to six causes are searched for
/// that each help beside all others. The verdict is `partial` if they are not sufficient for
/// `named`.
pub fn diagnose(
    bench: &Bench,
    logs: &[MeasuredLog],
    held_out: &[MeasuredLog],
    options: &Options<'_>,
) -> Result<Diagnosis, DiagnosisError> {
    if logs.is_empty() {
        return Err(DiagnosisError::NoLog);
    }
    let report = |step: Step| {
        if let Some(progress) = options.progress {
            progress(step.share, step.name);
        }
    };
    report(progress::CHECK);
    let checked = check(bench, logs, held_out)?;
    let diagnosis = diagnose_checked(bench, &checked, options.exclude, &report)?;
    report(progress::DONE);
    let mut checks = checked.findings;
    checks.extend(diagnosis.checks);
    checks.sort_by_key(|f| f.severity);
    Ok(Diagnosis { checks, ..diagnosis })
}

/// Runs the passes that checked logs need, and returns the diagnosis of the one that counts.
fn diagnose_checked(
    bench: &Bench,
    checked: &Checked,
    exclude: &[String],
    report: &dyn Fn(Step),
) -> Result<Diagnosis, DiagnosisError> {
    let is_axis = bench.is_axis();
    let pass = Pass { bench, exclude, split: Split::Halves, noise_policy: NoisePolicy::InflateByResidual };
    let first = pass.run(checked, report)?;
    let mut diagnosis = first.diagnosis.clone();
    if matches!(diagnosis.verdict, Verdict::Unknown | Verdict::None)
        && checked.held_out.is_empty()
        && (first.is_wrong_late || is_axis)
    {
        let interleaved = Pass { split: Split::Interleaved, ..pass };
        let report = |step: Step| report(Step { share: progress::INTERLEAVED_SHARE, ..step });
        let second = interleaved.run(checked, &report)?.diagnosis;
        if names_late_cause(&diagnosis.series, &second.causes) {
            return Ok(second);
        }
    }
    if !is_axis || diagnosis.verdict == Verdict::None {
        return Ok(diagnosis);
    }
    if diagnosis.verdict == Verdict::Unknown {
        let floor_only = Pass { noise_policy: NoisePolicy::FloorOnly, ..pass };
        let report = |step: Step| report(Step { share: progress::PAIR_SHARE, ..step });
        let pair = floor_only.run(checked, &report)?.diagnosis;
        if is_complete_pair(&pair) {
            return Ok(pair);
        }
    }
    if diagnosis.signature.is_some() {
        report(progress::PARTS);
        if let Some(parts) = pass.parts(&first)? {
            diagnosis = parts;
        }
    }
    Ok(diagnosis)
}

/// Returns whether a diagnosis names two causes that leave no structure and may explain the
/// complete residual.
fn is_complete_pair(diagnosis: &Diagnosis) -> bool {
    matches!(diagnosis.verdict, Verdict::Named | Verdict::Ambiguous)
        && diagnosis.causes.len() > 1
        && diagnosis.signature.is_none()
        && diagnosis.explained_share_ci95.is_some_and(|[_, high]| high >= PAIR_SHARE_UPPER)
}
