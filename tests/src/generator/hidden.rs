//! Content of a log: an effect of the vocabulary with the parameter names that `docs/effects.md`
//! documents.
//!
//! The generators give these numbers their documented meaning with separate physics. Therefore the
//! generator can also simulate a cause that a diagnosis names, and compare it with the hidden one.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One hidden effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HiddenEffect {
    /// Name in the vocabulary.
    pub effect: String,
    /// Channel of a sensor effect.
    pub channel: Option<String>,
    /// Parameters, SI.
    pub parameters: BTreeMap<String, f64>,
}

impl HiddenEffect {
    /// Returns an effect of the plant.
    pub fn new(effect: &str, parameters: &[(&str, f64)]) -> Self {
        let parameters = parameters.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect();
        Self { effect: effect.into(), channel: None, parameters }
    }

    /// Returns an effect of a sensor.
    pub fn for_sensor(effect: &str, channel: &str, parameter: &str, value: f64) -> Self {
        Self { channel: Some(channel.into()), ..Self::new(effect, &[(parameter, value)]) }
    }

    /// Returns a parameter; 0 if it is missing.
    pub fn get(&self, parameter: &str) -> f64 {
        self.parameters.get(parameter).copied().unwrap_or_default()
    }
}

/// Returns the sum of a parameter over all hidden effects of a name.
pub fn total(hidden: &[HiddenEffect], effect: &str, parameter: &str) -> f64 {
    hidden.iter().filter(|h| h.effect == effect).map(|h| h.get(parameter)).sum()
}
