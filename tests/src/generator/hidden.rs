//! What a log hides: an effect of the vocabulary with parameters by the names that `docs/effects.md` documents.
//!
//! The generators read these names and numbers and give them their documented meaning with physics of their own. So a
//! cause that a diagnosis names can be simulated by the generator as well, to see whether it is the same thing.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One hidden effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HiddenEffect {
    /// Name in the vocabulary.
    pub effect: String,
    /// Sensor, for sensor effects.
    pub channel: Option<String>,
    /// Parameters, SI.
    pub parameters: BTreeMap<String, f64>,
}

impl HiddenEffect {
    /// An effect of the plant.
    pub fn new(effect: &str, parameters: &[(&str, f64)]) -> Self {
        let parameters = parameters.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect();
        Self { effect: effect.into(), channel: None, parameters }
    }

    /// An effect of a sensor.
    pub fn of_sensor(effect: &str, channel: &str, parameter: &str, value: f64) -> Self {
        Self { channel: Some(channel.into()), ..Self::new(effect, &[(parameter, value)]) }
    }

    /// A parameter; 0 where it is not given.
    pub fn get(&self, parameter: &str) -> f64 {
        self.parameters.get(parameter).copied().unwrap_or_default()
    }
}

/// The sum of a parameter over all hidden effects of a name.
pub fn total(hidden: &[HiddenEffect], effect: &str, parameter: &str) -> f64 {
    hidden.iter().filter(|h| h.effect == effect).map(|h| h.get(parameter)).sum()
}
