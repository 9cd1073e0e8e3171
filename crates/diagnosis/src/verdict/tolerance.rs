//! Declared numbers out of their tolerance.
//!
//! Calibration absorbs a declared number that deviates, so that no structure remains and no effect
//! is needed. A number beyond [`tuning::MAX_TOLERATED`] declared deviations is a fault
//! nevertheless. If an effect of the catalogue changes the same number, it is the cause: it takes
//! the whole deviation, the number itself keeps its described value, and the prior of the
//! declaration no longer limits it. A number that no effect changes is a finding.
//!
//! With other declared numbers near their descriptions, another effect may fit as well. It is then
//! reported beside the cause.

use super::causes::EffectName;
use super::explanation::Explanation;
use super::materiality::is_immaterial;
use super::probability::{Hypothesis, Shares};
use super::tuning;
use crate::check::{Finding, Severity};
use crate::data::noise::NoiseModel;
use crate::data::views::Views;
use crate::digits::four_digits;
use crate::fit::held_out_gain::all_residuals;
use crate::fit::least_squares::fit;
use crate::fit::model::{Candidate, Model};
use crate::search::contender::Contender;
use crate::search::stage::Stage;
use crate::search::threshold::bic_penalty;
use crate::search::tuning::EQUIVALENT_BIC;
use bench::simulate::RespondError;
use statrs::distribution::{ContinuousCDF, Normal};

/// A declared number that probably lies beyond its tolerance.
struct Number {
    /// Position among the model's parameters.
    index: usize,
    /// Posterior probability that it lies beyond the tolerance.
    probability: f64,
}

/// Causes that are changes of declared numbers.
pub(crate) struct OutOfTolerance {
    /// The bench with these numbers as described and everything else calibrated.
    pub(crate) described: Explanation,
    /// The bench with the effects that change them.
    pub(crate) explanation: Explanation,
    /// Probability that all of the numbers are out of tolerance.
    pub(crate) probability: f64,
    /// Names of the numbers.
    numbers: Vec<String>,
    bic: f64,
}

impl OutOfTolerance {
    /// Explains the numbers of a calibrated bench that are out of tolerance by the effects that
    /// change them; none without such a number, or if one of the effects is immaterial.
    pub(crate) fn find(
        views: &Views,
        floors: &NoiseModel,
        candidates: &[Candidate],
        (calibrated, noise): (&Explanation, &NoiseModel),
    ) -> Result<Option<Self>, RespondError> {
        let data = &views.fitted;
        let (mut model, mut z) = (calibrated.model.clone(), calibrated.z.clone());
        let (mut causes, mut names) = (Vec::new(), Vec::new());
        for number in numbers(calibrated) {
            let name = calibrated.model.parameters[number.index].name();
            let Some((extended, values, candidate)) = with_change_of(&model, &z, name, candidates, floors)
            else {
                continue;
            };
            (model, z) = (extended, values);
            causes.push((candidate, number.probability));
            names.push(name.to_owned());
        }
        if causes.is_empty() {
            return Ok(None);
        }
        let without = |dropped: Option<usize>| -> Result<_, RespondError> {
            let kept = (0..causes.len()).filter(|i| dropped.is_some_and(|d| d != *i));
            let (model, z) = model.without_effects().with_effects_of((&model, &z), kept, floors);
            fit(data, noise, model, z)
        };
        let described = without(None)?;
        let columns: Result<Vec<_>, RespondError> =
            (0..causes.len()).map(|i| all_residuals(&views.all, noise, &without(Some(i))?)).collect();
        let described = Explanation::new(views, floors, (&described, noise), Vec::new(), Vec::new())?;
        let fitted = fit(data, noise, model, z)?;
        let bic = fitted.objective + bic_penalty(causes.len(), data, noise);
        let probability = causes.iter().map(|(_, p)| p).product();
        let explanation = Explanation::new(views, floors, (&fitted, noise), causes, columns?)?;
        let is_material =
            (0..explanation.causes.len()).all(|i| !is_immaterial(&views.all, floors, &explanation, i));
        Ok(is_material.then_some(Self { described, explanation, probability, numbers: names, bic }))
    }

    /// Probabilities of these causes, of each of the `equivalents` in their place, and of declared
    /// numbers within their tolerance; `unknown` is the probability of an unknown cause.
    pub(crate) fn shares(&self, unknown: f64, equivalents: &[&Contender]) -> Shares {
        let known = 1.0 - unknown;
        let beyond = known * self.probability;
        let other = |c: &&Contender| Hypothesis {
            causes: vec![EffectName::from(&c.candidate)],
            probability: beyond * c.probability,
        };
        let mut hypotheses: Vec<Hypothesis> = equivalents.iter().map(other).collect();
        let own = beyond - hypotheses.iter().map(|h| h.probability).sum::<f64>();
        let causes = self.explanation.causes.iter().map(|(c, _)| EffectName::from(c)).collect();
        hypotheses.push(Hypothesis { causes, probability: own });
        hypotheses.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        Shares { none: known - beyond, unknown, hypotheses }
    }

    /// Contenders of a stage without a cause that fit as well as these causes, and leave the
    /// numbers within their tolerance.
    pub(crate) fn equivalents<'a>(&'a self, first: &'a Stage) -> impl Iterator<Item = &'a Contender> {
        let is_other = |c: &Contender| self.explanation.causes.iter().all(|(own, _)| *own != c.candidate);
        let is_within = |c: &Contender| {
            let own = c.fit.model.parameters.iter().zip(&c.fit.z);
            let mut own = own.filter(|(p, _)| p.is_nominal() && self.numbers.iter().any(|n| n == p.name()));
            own.all(|(_, z)| z.abs() < tuning::MAX_TOLERATED)
        };
        let fits = move |c: &Contender| c.bic - self.bic < EQUIVALENT_BIC;
        first.contenders.iter().filter(move |c| is_other(c) && is_within(c) && fits(c))
    }
}

/// Declared numbers of the bench that probably lie beyond their tolerance.
fn numbers(explanation: &Explanation) -> Vec<Number> {
    let Explanation { model, z, deviations, .. } = explanation;
    let number = |index: usize| {
        let margin = (z[index].abs() - tuning::MAX_TOLERATED) / deviations[index].max(f64::MIN_POSITIVE);
        let probability = Normal::standard().cdf(margin);
        let is_beyond = probability >= tuning::MIN_BEYOND && model.declares(&model.parameters[index]);
        is_beyond.then_some(Number { index, probability })
    };
    (0..model.parameters.len()).filter_map(number).collect()
}

/// The model with the effect that changes a declared number, and without the number's own
/// deviation; none if no effect changes this number alone.
fn with_change_of(
    model: &Model,
    z: &[f64],
    name: &str,
    candidates: &[Candidate],
    floors: &NoiseModel,
) -> Option<(Model, Vec<f64>, Candidate)> {
    let number = model.parameters.iter().position(|p| p.is_nominal() && p.name() == name)?;
    candidates.iter().filter(|c| !model.effects.contains(c)).find_map(|&candidate| {
        let extended = model.with_effect(candidate, floors);
        let [own] = extended.effect_parameters(model.effects.len())[..] else { return None };
        let mut start = z.to_vec();
        start.resize(extended.parameters.len(), 0.0);
        extended.alias(&start, own).filter(|(declared, _)| *declared == number)?;
        let values = extended.unaliased(&start);
        let (without, values) = extended.without_number(number, values);
        Some((without, values, candidate))
    })
}

/// Findings about declared numbers of the bench that are out of tolerance and are no cause.
pub(crate) fn findings_out_of_tolerance(explanation: &Explanation) -> Vec<Finding> {
    let finding = |number: Number| {
        let p = &explanation.model.parameters[number.index];
        let (value, off) = (p.value(explanation.z[number.index]), explanation.z[number.index].abs());
        let found = format!(
            "{} is {} in place of {}, {off:.1} of its declared standard deviations",
            p.name(),
            four_digits(value),
            four_digits(p.centre)
        );
        Finding::new(Severity::Doubtful, "description", p.name(), "out-of-tolerance", found)
            .cause("the description is wrong, or the bench has changed")
            .evidence("value", value)
            .evidence("described", p.centre)
            .evidence("declared_deviation", p.scale)
    };
    numbers(explanation).into_iter().map(finding).collect()
}
