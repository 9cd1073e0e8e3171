//! Causes of a diagnosis with their parameters.

use super::effect_name::EffectName;
use super::explanation::Explanation;
use crate::data::logs::Data;
use crate::fit::held_out_gain::{Gain, gains};
use crate::fit::tuning::Z_95;
use crate::search::contender::Contender;
use bench::Channel;
use schemars::JsonSchema;
use serde::Serialize;

/// A fitted parameter.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ParameterEstimate {
    /// Name in the bench description.
    pub name: String,
    /// Estimate.
    pub value: f64,
    /// Unit.
    pub unit: String,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

/// A cause that the diagnosis names.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Cause {
    /// Effect in kebab-case.
    pub effect: String,
    /// Sensor, for sensor effects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
    /// Body or joint, for effects on a part of a mechanism.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// Posterior probability that it is a cause, alone or with another one.
    pub probability: f64,
    /// Its parameters.
    pub parameters: Vec<ParameterEstimate>,
    /// Error without it and with it, by channel; everything else is fitted again.
    pub gain: Vec<Gain>,
    /// Effects that fit as well in its place, if it is one of several parts of an error.
    pub alternatives: Vec<EffectName>,
}

/// An effect that fits as well as a named one.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct EquivalentEffect {
    /// Effect in kebab-case.
    pub effect: String,
    /// Sensor, for sensor effects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
    /// Body or joint, for effects on a part of a mechanism.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// Posterior probability.
    pub probability: f64,
    /// Correlation of its projected signature with that of the named effect.
    pub correlation: f64,
}

impl EquivalentEffect {
    /// The effect of a contender; `known` is the probability that the cause is not unknown.
    pub(crate) fn new(contender: &Contender, known: f64) -> Self {
        Self {
            effect: contender.candidate.kind.name.into(),
            channel: contender.candidate.channel,
            of: contender.candidate.part(),
            probability: known * contender.probability,
            correlation: contender.correlation,
        }
    }
}

/// The causes of an explanation; `known` is the probability that the cause is not unknown.
pub(crate) fn causes(data: &Data, explanation: &Explanation, known: f64) -> Vec<Cause> {
    let (noise, extended) = (&explanation.noise, &explanation.residual);
    let cause = |which: usize| {
        let (candidate, probability) = &explanation.causes[which];
        let parameters = explanation.model.effect_parameters(which).into_iter().map(|i| {
            let (p, half) = (&explanation.model.parameters[i], Z_95 * explanation.deviations[i]);
            ParameterEstimate {
                name: p.name().into(),
                value: p.value(explanation.z[i]),
                unit: p.unit.clone(),
                ci95: [p.value(explanation.z[i] - half), p.value(explanation.z[i] + half)],
            }
        });
        Cause {
            effect: candidate.kind.name.into(),
            channel: candidate.channel,
            of: candidate.part(),
            probability: known * probability,
            parameters: parameters.collect(),
            gain: explanation.without.get(which).map_or_else(Vec::new, |w| gains(data, noise, w, extended).0),
            alternatives: explanation.alternatives.get(which).cloned().unwrap_or_default(),
        }
    };
    (0..explanation.causes.len()).map(cause).collect()
}
