//! Effects: what may be missing from a bench's nominal model, by a stable name.
//!
//! An effect changes a description in place; at size 0 it changes nothing. A new effect is one new file and one line
//! in [`CATALOGUE`]; `docs/effects.md` is the catalogue as a table.

mod breakaway;
mod clearance_wear;
mod contact_stiffness;
mod coulomb_asymmetry;
mod coulomb_level;
mod drive_lag;
mod fork_backlash;
mod friction_step;
mod hydraulic_compliance;
mod inertia_mismatch;
mod journal_out_of_round;
mod kind;
mod lever_ratio;
mod load_dependent_friction;
mod load_ripple;
mod misalignment;
mod position_ripple;
mod presliding_hysteresis;
mod restitution;
mod seal_friction;
mod sensor_delay;
mod sensor_drift;
mod sensor_gain;
mod sensor_offset;
mod sensor_saturation;
mod shaft_flexibility;
mod squeeze_film;
mod stribeck_friction;
#[cfg(test)]
mod tests;
mod thermal_friction_drift;
mod viscous_asymmetry;
mod viscous_friction;

pub use kind::{EffectKind, EffectParameter, Guess, Plant};

use crate::channel::Channel;
use crate::description::Bench;
use crate::sensor::Sensor;
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
    /// Parameters by name; a missing one has its default, which is 0 for a size.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, f64>,
}

/// Every effect the project knows.
pub const CATALOGUE: &[EffectKind] = &[
    clearance_wear::EFFECT,
    contact_stiffness::EFFECT,
    restitution::EFFECT,
    journal_out_of_round::EFFECT,
    misalignment::EFFECT,
    inertia_mismatch::EFFECT,
    shaft_flexibility::EFFECT,
    lever_ratio::EFFECT,
    stribeck_friction::EFFECT,
    coulomb_level::EFFECT,
    viscous_friction::EFFECT,
    viscous_asymmetry::EFFECT,
    coulomb_asymmetry::EFFECT,
    load_dependent_friction::EFFECT,
    breakaway::EFFECT,
    presliding_hysteresis::EFFECT,
    thermal_friction_drift::EFFECT,
    friction_step::EFFECT,
    seal_friction::EFFECT,
    position_ripple::EFFECT,
    hydraulic_compliance::EFFECT,
    drive_lag::EFFECT,
    load_ripple::EFFECT,
    fork_backlash::EFFECT,
    squeeze_film::EFFECT,
    sensor_offset::EFFECT,
    sensor_gain::EFFECT,
    sensor_delay::EFFECT,
    sensor_drift::EFFECT,
    sensor_saturation::EFFECT,
];

/// Why an effect was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EffectError {
    /// No such name.
    #[error("effects: `{0}` is not a known effect; expected one of {known}", known = names())]
    UnknownName(String),
    /// The effect means nothing on this plant.
    #[error("effects: `{effect}` does not act on a {found}; expected {expected}")]
    Elsewhere {
        /// Effect.
        effect: String,
        /// The plant of the description.
        found: Plant,
        /// Plants where it acts.
        expected: String,
    },
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
        let known = kind.parameters(bench);
        if known.is_empty() {
            return Err(EffectError::Elsewhere {
                effect: self.name.clone(),
                found: Plant::of(bench),
                expected: kind.plants.iter().map(|p| p.words()).collect::<Vec<_>>().join(" or "),
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

    /// Applies the effect in place. The caller has checked it; on a plant where it does not act nothing happens.
    pub fn apply(&self, bench: &mut Bench) {
        let Some(kind) = kind(&self.name) else { return };
        let known = kind.parameters(bench);
        let default = |name: &str| known.iter().find(|p| p.name == name).map_or(0.0, |p| p.default);
        let value = |name: &str| self.parameters.get(name).copied().unwrap_or_else(|| default(name));
        if known.iter().any(|p| p.is_size && value(p.name) != 0.0) {
            (kind.apply)(bench, self.channel, &value);
        }
    }
}

/// The sensor of a channel, to be changed.
fn sensor(bench: &mut Bench, channel: Option<Channel>) -> Option<&mut Sensor> {
    let sensors = match bench {
        Bench::Transmission(bench) => &mut bench.sensors,
        Bench::FrictionRig(rig) => &mut rig.sensors,
    };
    Some(sensors.entry(channel?).or_default())
}
