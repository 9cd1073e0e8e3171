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

use super::acceptance::is_acceptable;
use super::causes::EquivalentEffect;
use super::effect_name::EffectName;
use super::explanation::Explanation;
use super::materiality::{largest_change, note};
use super::probability::{Hypothesis, Shares};
use super::tuning;
use crate::check::{Finding, Severity};
use crate::data::logs::{Columns, Data};
use crate::data::noise::NoiseModel;
use crate::data::views::Views;
use crate::digits::four_digits;
use crate::fit::held_out_gain::{all_residuals, is_lower};
use crate::fit::least_squares::{Fit, fit};
use crate::fit::linear::dot;
use crate::fit::model::{Candidate, Model};
use crate::fit::tuning::{BOUND_TOLERANCE, MAX_DEVIATIONS};
use crate::search::contender::Contender;
use crate::search::stage::Stage;
use crate::search::threshold::bic_penalty;
use crate::search::tuning::EQUIVALENT_BIC;
use bench::simulate::RespondError;
use statrs::distribution::{ContinuousCDF, Normal};

/// Declared numbers of an explanation that are probably out of tolerance.
#[derive(Default)]
pub(crate) struct Numbers {
    /// Name and posterior probability of each that matters.
    material: Vec<(String, f64)>,
    /// Findings about these, in their order.
    findings: Vec<Finding>,
    /// Notes about the others.
    pub(crate) notes: Vec<Finding>,
}

impl Numbers {
    /// Examines the numbers that the description declares uncertain; none if structure remains,
    /// which they may imitate.
    pub(crate) fn new(
        views: &Views,
        floors: &NoiseModel,
        explanation: &Explanation,
    ) -> Result<Self, RespondError> {
        let mut out = Self::default();
        if explanation.remaining.is_some() {
            return Ok(out);
        }
        let Explanation { model, z, deviations, noise, .. } = explanation;
        for (index, p) in model.parameters.iter().enumerate().filter(|(_, p)| model.declares(p)) {
            let off = z[index].abs();
            let margin = (off - tuning::MAX_TOLERATED) / deviations[index].max(f64::MIN_POSITIVE);
            let probability = Normal::standard().cdf(margin);
            if probability < tuning::MIN_BEYOND {
                continue;
            }
            let (value, described) = (four_digits(p.value(z[index])), four_digits(p.centre));
            let at_least = if off >= MAX_DEVIATIONS - BOUND_TOLERANCE { "at least " } else { "" };
            let found = format!(
                "{} is {value} in place of {described}, {at_least}{off:.1} of its declared standard \
                 deviations",
                p.name()
            );
            let (without, start) = model.without_number(index, z.clone());
            let without = fit(&views.fitted, noise, without, start)?;
            let without = all_residuals(&views.all, noise, &without)?;
            let change = largest_change(&views.all, floors, &without, &explanation.residual);
            if let Some(note) = note(&format!("{found}, which"), change) {
                out.notes.push(note);
                continue;
            }
            out.material.push((p.name().to_owned(), probability));
            out.findings.push(
                Finding::new(Severity::Doubtful, "description", p.name(), "out-of-tolerance", found)
                    .cause("the description is wrong, or the bench has changed")
                    .evidence("value", p.value(z[index]))
                    .evidence("described", p.centre)
                    .evidence("declared_deviation", p.scale),
            );
        }
        Ok(out)
    }

    /// Returns whether no number that matters is out of tolerance.
    pub(crate) fn are_within(&self) -> bool {
        self.material.is_empty()
    }

    /// Findings about all numbers, except those that an effect explains.
    pub(crate) fn findings(&self, explained: &[String]) -> Vec<Finding> {
        let is_open = |f: &&Finding| !explained.contains(&f.channel);
        self.findings.iter().filter(is_open).chain(&self.notes).cloned().collect()
    }
}

/// Causes that are changes of declared numbers.
pub(crate) struct OutOfTolerance {
    /// The bench with these numbers as described and everything else calibrated.
    pub(crate) described: Explanation,
    /// The bench with the effects that change them.
    pub(crate) explanation: Explanation,
    /// Names of the numbers.
    pub(crate) numbers: Vec<String>,
    /// Probability that none of them is out of tolerance.
    none: f64,
    own: Contender,
}

impl OutOfTolerance {
    /// Explains numbers of a calibrated bench by the effects that change them. Returns none if no
    /// effect changes any of them, or if the rules of acceptance reject these effects.
    pub(crate) fn find(
        views: &Views,
        floors: &NoiseModel,
        candidates: &[Candidate],
        (numbers, calibrated, first): (&Numbers, &Explanation, &Stage),
    ) -> Result<Option<Self>, RespondError> {
        let (data, noise) = (&views.fitted, &first.noise);
        let (mut model, mut z) = (calibrated.model.clone(), calibrated.z.clone());
        let (mut causes, mut names) = (Vec::new(), Vec::new());
        for (name, probability) in &numbers.material {
            let changed = with_change_of(&model, &z, name, candidates, floors);
            let Some((extended, values, candidate)) = changed else { continue };
            (model, z) = (extended, values);
            causes.push((candidate, *probability));
            names.push(name.clone());
        }
        let Some((candidate, _)) = causes.last().cloned() else { return Ok(None) };
        let without = |dropped: Option<usize>| -> Result<Fit, RespondError> {
            let retained = (0..causes.len()).filter(|i| dropped.is_some_and(|d| d != *i));
            let (model, z) = model.without_effects().with_effects_of((&model, &z), retained, floors);
            fit(data, noise, model, z)
        };
        let described = Explanation::new(views, floors, (&without(None)?, noise), Vec::new(), Vec::new())?;
        let columns: Result<Vec<Columns>, RespondError> = match causes.len() {
            1 => Ok(vec![described.residual.clone()]),
            count => (0..count).map(|i| all_residuals(&views.all, noise, &without(Some(i))?)).collect(),
        };
        let fit = fit(data, noise, model, z)?;
        let bic = fit.objective + bic_penalty(causes.len(), data, noise);
        let none = causes.iter().map(|(_, p)| 1.0 - p).product();
        let explanation = Explanation::new(views, floors, (&fit, noise), causes, columns?)?;
        let is_accepted = explanation.remaining.is_none()
            && is_acceptable(&views.all, &described, &explanation)
            && is_lower(&views.all, noise, &described.residual, &explanation.residual);
        let evidence = first.base.objective - fit.objective;
        let own = Contender { candidate, fit, evidence, probability: 1.0, correlation: 1.0, bic };
        Ok(is_accepted.then_some(Self { described, explanation, numbers: names, none, own }))
    }

    /// Probabilities of these causes, of each rival in their place, and of numbers within their
    /// tolerance; `unknown` is the probability of an unknown cause.
    ///
    /// Rivals are contenders of the stage without a cause that fit as well and leave the numbers
    /// within their tolerance.
    pub(crate) fn compare(
        &mut self,
        data: &Data,
        first: &Stage,
        unknown: f64,
    ) -> Result<(Vec<EquivalentEffect>, Shares), RespondError> {
        let rivals: Vec<&Contender> = first.contenders.iter().filter(|c| self.is_rival(c)).collect();
        let odds = |c: &Contender| (0.5 * (self.own.bic - c.bic)).exp();
        let own_share = 1.0 / (1.0 + rivals.iter().map(|c| odds(c)).sum::<f64>());
        let known = 1.0 - unknown;
        let beyond = known * (1.0 - self.none);
        let report = |c: &&Contender| {
            Ok(EquivalentEffect {
                effect: c.candidate.kind.name.into(),
                channel: c.candidate.channel,
                of: c.candidate.part(),
                probability: beyond * own_share * odds(c),
                correlation: self.correlation(data, &c.fit)?,
            })
        };
        let equivalents: Vec<EquivalentEffect> =
            rivals.iter().map(report).collect::<Result<_, RespondError>>()?;
        let name = |e: &EquivalentEffect| EffectName {
            effect: e.effect.clone(),
            channel: e.channel,
            of: e.of.clone(),
        };
        let mut hypotheses: Vec<Hypothesis> = equivalents
            .iter()
            .map(|e| Hypothesis { causes: vec![name(e)], probability: e.probability })
            .collect();
        let causes = self.explanation.causes.iter().map(|(c, _)| EffectName::from(c)).collect();
        hypotheses.push(Hypothesis { causes, probability: beyond * own_share });
        hypotheses.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        for (_, probability) in &mut self.explanation.causes {
            *probability *= own_share;
        }
        Ok((equivalents, Shares { none: known * self.none, unknown, hypotheses }))
    }

    fn is_rival(&self, c: &Contender) -> bool {
        let numbers = c.fit.model.parameters.iter().zip(&c.fit.z);
        let mut own = numbers.filter(|(p, _)| p.is_nominal() && self.numbers.iter().any(|n| n == p.name()));
        let is_within = own.all(|(_, z)| z.abs() < tuning::MAX_TOLERATED);
        let is_other = self.explanation.causes.iter().all(|(own, _)| *own != c.candidate);
        is_within && is_other && c.bic - self.own.bic < EQUIVALENT_BIC && !c.restates(&self.own)
    }

    /// Correlation of the changes of the residual from the described bench, in units of the noise,
    /// by a rival's fit and by these causes.
    fn correlation(&self, data: &Data, rival: &Fit) -> Result<f64, RespondError> {
        let noise = &self.explanation.noise;
        let signature = |columns: &Columns| {
            let mut out = Vec::new();
            for ((block, before), after) in data.blocks.iter().zip(&self.described.residual).zip(columns) {
                let weight = noise.weight(block.channel);
                out.extend(before.iter().zip(after).map(|(b, a)| weight * (b - a)));
            }
            out
        };
        let own = signature(&self.explanation.residual);
        let other = signature(&all_residuals(data, noise, rival)?);
        Ok(dot(&own, &other) / (dot(&own, &own) * dot(&other, &other)).sqrt())
    }
}

/// The model with the effect that changes a declared number, and without the number's own
/// deviation; none if no effect changes this number alone, or none as far.
fn with_change_of(
    model: &Model,
    z: &[f64],
    name: &str,
    candidates: &[Candidate],
    floors: &NoiseModel,
) -> Option<(Model, Vec<f64>, Candidate)> {
    let number = model.parameters.iter().position(|p| p.is_nominal() && p.name() == name)?;
    candidates.iter().filter(|c| !model.effects.contains(c)).find_map(|candidate| {
        let extended = model.with_effect(candidate.clone(), floors);
        let [own] = extended.effect_parameters(model.effects.len())[..] else { return None };
        let mut start = z.to_vec();
        start.resize(extended.parameters.len(), 0.0);
        extended.alias(&start, own).filter(|(declared, _)| *declared == number)?;
        let values = extended.unaliased(&start);
        if values[number] != 0.0 {
            return None;
        }
        let (without, values) = extended.without_number(number, values);
        Some((without, values, candidate.clone()))
    })
}
