//! Acceptance of selected causes, and the reasons for rejecting one.
//!
//! * If no structure remains, causes must explain everything: the upper end of their share's
//!   interval must reach [`tuning::FULL_SHARE_UPPER`], else something was overlooked. The size of a
//!   cause must be consistent over the logs ([`super::size_consistency`]), else the cause is an
//!   imitation.
//! * If structure remains, causes must explain [`tuning::MAIN_SHARE`] of the repeatable residual on
//!   held-out samples (a second cause: of what the first one leaves), with an interval above 0 that
//!   reaches [`tuning::MAIN_SHARE_UPPER`]. A real bench always has structure beyond any catalogue,
//!   and a cause that explains little is more often an imitation than a part of the truth. Such
//!   structure makes even a true cause appear inconsistent. So only a size that differs between
//!   rising and falling speed is a reason for rejection: the true cause has a memory.
//! * In any case, a declared number of the bench must not lie on a bound of calibration, and the
//!   interval of a shape must not reach the end of its range, where an effect is equivalent to
//!   another one. If this rejects the last cause only, the causes before it are examined without
//!   it.

use super::effect_name::EffectName;
use super::explanation::Explanation;
use super::tuning;
use crate::data::logs::Data;
use crate::fit::held_out_gain::gains;
use crate::fit::parameter::Parameter;
use crate::fit::tuning::Z_95;
use crate::search::stage::Stage;
use schemars::JsonSchema;
use serde::Serialize;

/// Selected causes that are not accepted, or the nearest candidate if none was selected.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Rejection {
    /// Causes that are not accepted together.
    pub causes: Vec<EffectName>,
    /// Reason: `declared-number-at-bound`, `shape-at-bound`, `no-memory`, `size-differs`,
    /// `explains-too-little`, `size-uncertain` or `held-out-uncertain`.
    pub reason: String,
    /// The reason as a clause.
    pub words: String,
}

impl Rejection {
    fn new(causes: Vec<EffectName>, reason: &RejectionReason) -> Self {
        Self { causes, reason: reason.name().into(), words: reason.describe() }
    }
}

/// Reason why a candidate is not accepted as a cause.
enum RejectionReason {
    /// Declared numbers of the bench, by name, lie on a bound of calibration.
    DeclaredNumberAtBound(String),
    /// Shapes, by name, may lie at the end of their range.
    ShapeAtBound(String),
    /// The size differs between rising and falling speed.
    NoMemory,
    /// The size differs between parts of the logs.
    SizeDiffers,
    /// Too little of the held-out residual is explained.
    ExplainsTooLittle,
    /// The size may be 0, given the uncertainty of the other parameters.
    SizeUncertain,
    /// The error of held-out samples does not fall significantly.
    HeldOutUncertain,
}

impl RejectionReason {
    /// Name in JSON.
    fn name(&self) -> &'static str {
        match self {
            Self::DeclaredNumberAtBound(_) => "declared-number-at-bound",
            Self::ShapeAtBound(_) => "shape-at-bound",
            Self::NoMemory => "no-memory",
            Self::SizeDiffers => "size-differs",
            Self::ExplainsTooLittle => "explains-too-little",
            Self::SizeUncertain => "size-uncertain",
            Self::HeldOutUncertain => "held-out-uncertain",
        }
    }

    /// The reason as a clause.
    fn describe(&self) -> String {
        match self {
            Self::DeclaredNumberAtBound(names) => {
                format!("{names} would still deviate as far as the description allows")
            }
            Self::ShapeAtBound(names) => format!(
                "{names} may be at the end of its range, where the effect is equivalent to another one"
            ),
            Self::NoMemory => "its size would differ between rising and falling speed".into(),
            Self::SizeDiffers => {
                "its size would differ with direction, load, speed, position, time or phase".into()
            }
            Self::ExplainsTooLittle => "it explains too little of the held-out data".into(),
            Self::SizeUncertain => "its size may be 0, given the uncertainty of the other parameters".into(),
            Self::HeldOutUncertain => "the error of the held-out data does not fall significantly".into(),
        }
    }
}

/// Returns the number of accepted causes, and the selected ones that are rejected.
///
/// `explanations` are those without a cause, with the first selected cause and with both.
pub(crate) fn accept(data: &Data, explanations: &[Explanation]) -> (usize, Option<Rejection>) {
    let last = explanations.len().saturating_sub(1);
    let against_last = explanations.get(last).and_then(bound_reason);
    let (accepted, reason) = match (1..=last).rev().find(|&k| bound_reason(&explanations[k]).is_none()) {
        None => (0, against_last),
        Some(2) if is_second_unnecessary(data, explanations) => (1, Some(RejectionReason::ExplainsTooLittle)),
        Some(k) => match share_reason(data, &explanations[0], &explanations[k]) {
            None => (k, against_last),
            against_share => (0, against_last.or(against_share)),
        },
    };
    let names =
        |e: &Explanation| -> Vec<EffectName> { e.causes.iter().map(|(c, _)| EffectName::from(c)).collect() };
    let rejection = reason.map(|reason| {
        let accepted = names(&explanations[accepted]);
        let rejected = names(&explanations[last]).into_iter().filter(|c| !accepted.contains(c)).collect();
        Rejection::new(rejected, &reason)
    });
    (accepted, rejection)
}

/// Returns whether an explanation alone would be accepted.
pub(crate) fn is_acceptable(data: &Data, calibrated: &Explanation, explanation: &Explanation) -> bool {
    bound_reason(explanation).is_none() && share_reason(data, calibrated, explanation).is_none()
}

/// The best candidate of a first stage without a cause, if its evidence is clear, and the reason
/// why it is not a cause.
pub(crate) fn nearest_candidate(first: &Stage) -> Option<Rejection> {
    let nearest = first.rejected_contender()?;
    let reason = if nearest.has_significant_size(&first.base, first.threshold) {
        RejectionReason::HeldOutUncertain
    } else {
        RejectionReason::SizeUncertain
    };
    Some(Rejection::new(vec![EffectName::from(&nearest.candidate)], &reason))
}

/// Returns whether structure remains, the first of two causes is acceptable alone, and the second
/// explains little of what it leaves.
fn is_second_unnecessary(data: &Data, explanations: &[Explanation]) -> bool {
    let [calibrated, first, second] = explanations else { return false };
    second.remaining.is_some()
        && bound_reason(first).is_none()
        && share_reason(data, calibrated, first).is_none()
        && !explains_most(data, first, second)
}

/// Reason for rejection that applies whether or not structure remains: a parameter at a bound.
fn bound_reason(explanation: &Explanation) -> Option<RejectionReason> {
    if explanation.causes.is_empty() {
        return None;
    }
    let numbers = listed(bench_parameters_at_bound(explanation)).map(RejectionReason::DeclaredNumberAtBound);
    numbers.or_else(|| listed(shapes_at_bound(explanation)).map(RejectionReason::ShapeAtBound))
}

/// Reason for rejection from what an explanation explains: everything is required if no structure
/// remains, else most of it.
fn share_reason(data: &Data, calibrated: &Explanation, explanation: &Explanation) -> Option<RejectionReason> {
    let found = explanation.inconsistency;
    let (inconsistent, is_enough) = match explanation.remaining {
        None => (
            found.is_significant.then_some(RejectionReason::SizeDiffers),
            may_explain_all(data, calibrated, explanation),
        ),
        Some(_) => (
            found.is_hysteretic.then_some(RejectionReason::NoMemory),
            explains_most(data, calibrated, explanation),
        ),
    };
    inconsistent.or((!is_enough).then_some(RejectionReason::ExplainsTooLittle))
}

/// Declared numbers on a bound of calibration, those of single logs included.
pub(crate) fn declared_at_bound(explanation: &Explanation) -> impl Iterator<Item = &Parameter> {
    let numbers = explanation.model.parameters.iter().zip(&explanation.z);
    numbers.filter(|(p, z)| p.is_declared() && p.bound_at(**z).is_some()).map(|(p, _)| p)
}

/// Names of declared numbers of the bench on a bound. A nuisance parameter of one log does not
/// speak against a cause in all logs.
fn bench_parameters_at_bound(explanation: &Explanation) -> impl Iterator<Item = &str> {
    declared_at_bound(explanation).filter(|p| p.is_nominal()).map(Parameter::name)
}

/// Names of shapes of unknown order of magnitude whose 95 % interval reaches an end of their range.
///
/// An effect at the end of its range is equivalent to another one: static friction that is never
/// lost is a level.
fn shapes_at_bound(explanation: &Explanation) -> impl Iterator<Item = &str> {
    let reaches_bound = |((p, z), deviation): &((&Parameter, &f64), &f64)| {
        let ((min, max), reach) = (p.bounds(), Z_95 * **deviation);
        p.is_shape() && p.is_factor && (**z - reach <= min || **z + reach >= max)
    };
    let estimates = explanation.model.parameters.iter().zip(&explanation.z).zip(&explanation.deviations);
    estimates.filter(reaches_bound).map(|((p, _), _)| p.name())
}

/// Names joined to a list; `None` without names.
fn listed<'a>(names: impl Iterator<Item = &'a str>) -> Option<String> {
    let names: Vec<&str> = names.collect();
    (!names.is_empty()).then(|| names.join(" and "))
}

/// Returns whether `after` explains most of what `before` leaves on held-out samples,
/// significantly.
fn explains_most(data: &Data, before: &Explanation, after: &Explanation) -> bool {
    let (_, (share, interval)) = gains(data, &after.noise, &before.residual, &after.residual);
    share.is_some_and(|s| s >= tuning::MAIN_SHARE)
        && interval.is_some_and(|[low, high]| low > 0.0 && high >= tuning::MAIN_SHARE_UPPER)
}

/// Returns whether `after` may explain all that `before` leaves on held-out samples; true if too
/// little is left for a share.
fn may_explain_all(data: &Data, before: &Explanation, after: &Explanation) -> bool {
    let (_, (_, interval)) = gains(data, &after.noise, &before.residual, &after.residual);
    interval.is_none_or(|[_, high]| high >= tuning::FULL_SHARE_UPPER)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::least_squares::fit;
    use crate::fixtures::{calibrated, plain};
    use crate::search::contender::Contender;

    #[test]
    fn the_nearest_candidate_is_rejected_for_its_size_or_its_held_out_error() {
        // Calibration absorbs 4 N m of an effort that is too large. Of 40 N m the size is clear; of
        // 1 N m it may be 0.
        let stage = |effort: f64, evidence: f64, has_cause: bool| {
            let (data, noise, base) = calibrated(effort);
            let model = base.model.with_effect(plain("coulomb-level"), &noise);
            let start = vec![0.0; model.parameters.len()];
            let fit = fit(&data, &noise, model, start).unwrap();
            let candidate = plain("coulomb-level");
            let best = Contender { candidate, fit, evidence, probability: 0.0, correlation: 0.0, bic: 0.0 };
            let (contenders, others) = (vec![best], Vec::new());
            let (threshold, multiplicity, discount) = (10.0, 0.0, 0.0);
            Stage { base, contenders, others, noise, threshold, multiplicity, discount, has_cause }
        };
        let reason = |stage: Stage| nearest_candidate(&stage).map(|r| (r.causes[0].effect.clone(), r.reason));
        let expected = |reason: &str| Some(("coulomb-level".to_owned(), reason.to_owned()));
        assert_eq!(reason(stage(40.0, 11.0, false)), expected("held-out-uncertain"));
        assert_eq!(reason(stage(1.0, 11.0, false)), expected("size-uncertain"));
        assert_eq!(reason(stage(40.0, 11.0, true)), None);
        assert_eq!(reason(stage(40.0, 9.0, false)), None);
    }
}
