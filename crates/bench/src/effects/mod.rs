//! Effects: deviations from a bench's nominal model, by a stable name.
//!
//! An effect changes a description in place; at size 0 it changes nothing. It names the plants on
//! which it acts, with an [`Action`] for each kind of plant, and is refused on every other plant. A
//! new effect on existing fields is one new file and one line in [`CATALOGUE`]; `docs/effects.md`
//! is the catalogue as a table.

mod breakaway;
mod clearance_wear;
mod contact_stiffness;
mod coulomb_asymmetry;
mod coulomb_level;
mod drive_lag;
mod fork_backlash;
mod friction_step;
mod gravity_moment;
mod hydraulic_compliance;
mod inertia_mismatch;
mod journal_out_of_round;
mod kind;
mod lever_ratio;
mod load_dependent_friction;
mod load_gain;
mod load_ripple;
mod misalignment;
mod position_friction;
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
mod spring_effort;
mod squeeze_film;
mod stribeck_friction;
#[cfg(test)]
mod tests;
mod thermal_friction_drift;
mod viscous_asymmetry;
mod viscous_friction;

pub use kind::{Action, EffectKind, EffectParameter, Guess, Measure};

use crate::description::{Bench, Refusal, TransmissionBench, format_number};
pub use crate::description::{Effect, Plant};

/// Every effect of the project.
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
    position_friction::EFFECT,
    breakaway::EFFECT,
    presliding_hysteresis::EFFECT,
    thermal_friction_drift::EFFECT,
    friction_step::EFFECT,
    seal_friction::EFFECT,
    spring_effort::EFFECT,
    gravity_moment::EFFECT,
    position_ripple::EFFECT,
    hydraulic_compliance::EFFECT,
    drive_lag::EFFECT,
    load_gain::EFFECT,
    load_ripple::EFFECT,
    fork_backlash::EFFECT,
    squeeze_film::EFFECT,
    sensor_offset::EFFECT,
    sensor_gain::EFFECT,
    sensor_delay::EFFECT,
    sensor_drift::EFFECT,
    sensor_saturation::EFFECT,
];

/// Error of an effect in a description.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EffectError {
    /// The name is not in the catalogue.
    #[error("effects: `{0}` is not a known effect; expected one of {known}", known = names())]
    UnknownName(String),
    /// The effect does not act on this plant.
    #[error("effects: `{effect}` does not act on a {found}; expected {expected}")]
    Elsewhere {
        /// Effect.
        effect: String,
        /// The plant of the description.
        found: &'static str,
        /// Plants where it acts.
        expected: String,
    },
    /// The effect has no such parameter.
    #[error("effects: `{effect}` has no parameter `{parameter}`; expected {expected}")]
    UnknownParameter {
        /// Effect.
        effect: String,
        /// Name found.
        parameter: String,
        /// Names allowed.
        expected: String,
    },
    /// A sensor effect has no channel, or another effect has one.
    #[error("effects: `{effect}` {found}; expected {expected}")]
    Channel {
        /// Effect.
        effect: String,
        /// Content found.
        found: &'static str,
        /// Content allowed.
        expected: &'static str,
    },
    /// An effect on a part of a mechanism names none, another effect names one, or there is no
    /// such part.
    #[error("effects: `{effect}` {found}; expected {expected}")]
    Part {
        /// Effect.
        effect: String,
        /// Content found.
        found: String,
        /// Content allowed.
        expected: String,
    },
    /// A value is outside its range.
    #[error("effects: `{effect}`.{parameter} is {found}; expected {min} to {max}")]
    OutOfRange {
        /// Effect.
        effect: String,
        /// Parameter.
        parameter: String,
        /// Value.
        found: f64,
        /// Minimum.
        min: f64,
        /// Maximum.
        max: f64,
    },
}

impl EffectError {
    /// Key in the entry of `[[effects]]`, and the refusal.
    pub(crate) fn refusal(&self) -> (&str, Refusal) {
        let entry = |effect: &str| format!("effects: `{effect}`");
        match self {
            Self::UnknownName(name) => ("name", (entry(name), "not a known effect".into(), names())),
            Self::Elsewhere { effect, found, expected } => {
                let found = format!("an effect that does not act on a {found}");
                ("name", (entry(effect), found, format!("a plant among {expected}")))
            }
            Self::Channel { effect, found, expected } => {
                let found = format!("an effect that {found}");
                ("channel", (entry(effect), found, (*expected).into()))
            }
            Self::Part { effect, found, expected } => {
                let found = format!("an effect that {found}");
                ("of", (entry(effect), found, expected.clone()))
            }
            Self::UnknownParameter { effect, parameter, expected } => {
                let field = format!("{}.{parameter}", entry(effect));
                (parameter, (field, "an unknown parameter".into(), format!("one of {expected}")))
            }
            Self::OutOfRange { effect, parameter, found, min, max } => {
                let range = format!("{} to {}", format_number(*min), format_number(*max));
                (parameter, (format!("{}.{parameter}", entry(effect)), format_number(*found), range))
            }
        }
    }
}

fn names() -> String {
    CATALOGUE.iter().map(|k| k.name).collect::<Vec<_>>().join(", ")
}

/// Returns the catalogue's entry of a name.
pub fn kind(name: &str) -> Option<&'static EffectKind> {
    CATALOGUE.iter().find(|k| k.name == name)
}

impl EffectKind {
    /// Names of the effects that this one names or that name it, in alphabetical order.
    pub fn confounded(&self) -> Vec<&'static str> {
        let naming = CATALOGUE.iter().filter(|other| other.confounded_with.contains(&self.name));
        let mut names: Vec<_> =
            naming.map(|other| other.name).chain(self.confounded_with.iter().copied()).collect();
        names.sort_unstable();
        names.dedup();
        names
    }
}

impl Effect {
    /// Checks name, channel, parameters and ranges against a bench.
    pub fn check(&self, bench: &Bench) -> Result<&'static EffectKind, EffectError> {
        match self.errors(bench).into_iter().next() {
            Some(error) => Err(error),
            None => kind(&self.name).ok_or_else(|| EffectError::UnknownName(self.name.clone())),
        }
    }

    /// Returns everything that is wrong with name, channel, parameters and ranges.
    pub(crate) fn errors(&self, bench: &Bench) -> Vec<EffectError> {
        let Some(kind) = kind(&self.name) else { return vec![EffectError::UnknownName(self.name.clone())] };
        let known = kind.parameters(bench);
        if known.is_empty() {
            return vec![EffectError::Elsewhere {
                effect: self.name.clone(),
                found: bench.effect_plant().map_or_else(|| bench.plant_name(), Plant::description),
                expected: kind.plants().map(Plant::description).collect::<Vec<_>>().join(" or "),
            }];
        }
        let mut errors = Vec::new();
        if kind.is_per_channel() != self.channel.is_some() {
            errors.push(EffectError::Channel {
                effect: self.name.clone(),
                found: if kind.is_per_channel() { "names no channel" } else { "names a channel" },
                expected: if kind.is_per_channel() { "`channel = \"...\"`" } else { "none" },
            });
        }
        if let (Bench::Mechanism(mechanism), Some(channel)) = (bench, self.channel)
            && !mechanism.measured.iter().any(|entry| entry.channel == channel)
        {
            errors.push(EffectError::Channel {
                effect: self.name.clone(),
                found: "names a channel that is not measured",
                expected: "a channel of `[[measured]]`",
            });
        }
        errors.extend(self.part_error(kind, bench));
        for (name, &value) in &self.parameters {
            match known.iter().find(|p| p.name == name) {
                None => errors.push(EffectError::UnknownParameter {
                    effect: self.name.clone(),
                    parameter: name.clone(),
                    expected: known.iter().map(|p| p.name).collect::<Vec<_>>().join(", "),
                }),
                Some(parameter) if !(parameter.min..=parameter.max).contains(&value) => {
                    errors.push(EffectError::OutOfRange {
                        effect: self.name.clone(),
                        parameter: name.clone(),
                        found: value,
                        min: parameter.min,
                        max: parameter.max,
                    });
                }
                Some(_) => {}
            }
        }
        errors
    }

    /// Error of the part that the effect names, or does not name.
    fn part_error(&self, kind: &EffectKind, bench: &Bench) -> Option<EffectError> {
        let (found, expected) = match (kind.parts(bench), &self.of) {
            (None, None) => return None,
            (None, Some(_)) => ("names a part".into(), "no `of`".into()),
            (Some(parts), Some(of)) if parts.contains(of) => return None,
            (Some(parts), of) => {
                let found = of.as_ref().map_or("names no part".into(), |of| format!("acts on no `{of}`"));
                let expected = match parts.is_empty() {
                    true => "a mechanism with a part on which it acts".into(),
                    false => format!("`of`, one of {}", parts.join(", ")),
                };
                (found, expected)
            }
        };
        Some(EffectError::Part { effect: self.name.clone(), found, expected })
    }

    /// Applies the effect in place. The caller has checked it; on a plant where it does not act it
    /// changes nothing.
    pub fn apply(&self, bench: &mut Bench) {
        let kind = kind(&self.name).zip(bench.effect_plant());
        let Some(action) = kind.and_then(|(kind, plant)| kind.action(plant)) else { return };
        let value = |parameter: &EffectParameter| {
            self.parameters.get(parameter.name).copied().unwrap_or(parameter.default)
        };
        let named = |name: &str| action.parameters.iter().find(|p| p.name == name).map_or(0.0, value);
        if action.parameters.iter().any(|p| p.is_size && value(p) != 0.0) {
            action.apply.to(bench, self, &named);
        }
    }
}

impl Bench {
    /// Returns the description with all its effects applied: the bench that is simulated.
    pub fn resolved(&self) -> Self {
        let mut bench = self.clone();
        let effects = std::mem::take(bench.effects_mut());
        for effect in &effects {
            effect.apply(&mut bench);
        }
        // Without thermal friction the temperature has no influence: such benches compare as equal.
        if !bench.has_thermal_friction() {
            bench.set_temperature_start_k(0.0);
        }
        bench
    }
}

impl TransmissionBench {
    /// Returns the description with all its effects applied: the bench that is simulated.
    pub fn resolved(&self) -> Self {
        match Bench::from(self.clone()).resolved() {
            Bench::Transmission(bench) => *bench,
            _ => self.clone(),
        }
    }
}
