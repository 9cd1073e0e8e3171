//! Effects: what may be missing from a bench's nominal model, by a stable name.
//!
//! An effect changes a description in place; at all parameters 0 it changes nothing. A new effect is one new file
//! and one line in [`CATALOGUE`].

mod contact_parameters;
mod drive;
mod friction;
mod sensors;

use crate::channel::Channel;
use crate::description::Bench;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// An effect with its parameters, as it stands under `[[effects]]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    /// Name in the catalogue.
    pub name: String,
    /// The sensor concerned, for sensor effects.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
    /// Parameters by name; a missing one is 0.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, f64>,
}

/// A parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectParameter {
    /// Name with unit.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// A size that is visible but small: the step of finite differences and the first guess of a fit.
    pub scale: f64,
    /// Smallest value that makes sense.
    pub least: f64,
    /// Largest value that makes sense.
    pub most: f64,
}

/// Applies an effect to a description; the function gives its parameters by name.
type Apply = fn(&mut Bench, Option<Channel>, &dyn Fn(&str) -> f64);

/// An entry of the catalogue.
#[derive(Clone, Copy)]
pub struct EffectKind {
    /// Stable name in kebab-case.
    pub name: &'static str,
    /// What it is, for people.
    pub summary: &'static str,
    /// Whether it concerns one sensor.
    pub per_channel: bool,
    /// Parameters for a bench, none if the effect does not exist there. For a sensor effect the scale is in
    /// multiples of the sensor's own floor unless the unit says otherwise.
    pub parameters: fn(&Bench) -> &'static [EffectParameter],
    /// Applies the effect to a description.
    apply: Apply,
}

/// Every effect the project knows.
pub const CATALOGUE: &[EffectKind] = &[
    contact_parameters::CLEARANCE_WEAR,
    contact_parameters::CONTACT_STIFFNESS,
    contact_parameters::RESTITUTION,
    contact_parameters::INERTIA_MISMATCH,
    contact_parameters::LEVER_RATIO,
    friction::COULOMB_LEVEL,
    friction::VISCOUS,
    friction::COULOMB_ASYMMETRY,
    friction::LOAD_DEPENDENT,
    drive::HYDRAULIC_COMPLIANCE,
    drive::DRIVE_LAG,
    sensors::OFFSET,
    sensors::GAIN,
    sensors::DELAY,
    sensors::DRIFT,
];

/// Why an effect was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EffectError {
    /// No such name.
    #[error("effects: `{0}` is not a known effect; expected one of {known}", known = names())]
    UnknownName(String),
    /// The effect has no such parameter.
    #[error("effects: `{effect}` has no parameter `{parameter}`; expected {expected}")]
    UnknownParameter {
        /// Effect.
        effect: String,
        /// What was found.
        parameter: String,
        /// What may stand there.
        expected: String,
    },
    /// A sensor effect names no channel, or another one does.
    #[error("effects: `{effect}` {found}; expected {expected}")]
    Channel {
        /// Effect.
        effect: String,
        /// What was found.
        found: &'static str,
        /// What may stand there.
        expected: &'static str,
    },
    /// A value outside its range.
    #[error("effects: `{effect}`.{parameter} is {found}; expected {least} to {most}")]
    OutOfRange {
        /// Effect.
        effect: String,
        /// Parameter.
        parameter: String,
        /// Value.
        found: f64,
        /// Smallest.
        least: f64,
        /// Largest.
        most: f64,
    },
}

fn names() -> String {
    CATALOGUE.iter().map(|k| k.name).collect::<Vec<_>>().join(", ")
}

/// The catalogue's entry of a name.
pub fn kind(name: &str) -> Option<&'static EffectKind> {
    CATALOGUE.iter().find(|k| k.name == name)
}

impl Effect {
    /// Checks name, channel, parameters and ranges against a bench.
    pub fn check(&self, bench: &Bench) -> Result<&'static EffectKind, EffectError> {
        let kind = kind(&self.name).ok_or_else(|| EffectError::UnknownName(self.name.clone()))?;
        let known = (kind.parameters)(bench);
        if known.is_empty() {
            return Err(EffectError::Channel {
                effect: self.name.clone(),
                found: "does not exist on this plant",
                expected: "an effect of this plant",
            });
        }
        if kind.per_channel != self.channel.is_some() {
            return Err(EffectError::Channel {
                effect: self.name.clone(),
                found: if kind.per_channel { "names no channel" } else { "names a channel" },
                expected: if kind.per_channel { "`channel = \"...\"`" } else { "none" },
            });
        }
        for (name, &value) in &self.parameters {
            let Some(parameter) = known.iter().find(|p| p.name == name) else {
                return Err(EffectError::UnknownParameter {
                    effect: self.name.clone(),
                    parameter: name.clone(),
                    expected: known.iter().map(|p| p.name).collect::<Vec<_>>().join(", "),
                });
            };
            if !(parameter.least..=parameter.most).contains(&value) {
                return Err(EffectError::OutOfRange {
                    effect: self.name.clone(),
                    parameter: name.clone(),
                    found: value,
                    least: parameter.least,
                    most: parameter.most,
                });
            }
        }
        Ok(kind)
    }

    /// Applies the effect in place. The caller has checked it.
    pub fn apply(&self, bench: &mut Bench) {
        if let Some(kind) = kind(&self.name) {
            (kind.apply)(bench, self.channel, &|name| self.parameters.get(name).copied().unwrap_or_default());
        }
    }
}
