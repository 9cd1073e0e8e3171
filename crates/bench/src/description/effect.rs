//! Entry of `[[effects]]`: data only. Its action is in [`crate::effects`].

use crate::signals::Channel;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Effect with its parameters, as an entry of `[[effects]]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    /// Name in the catalogue.
    pub name: String,
    /// Channel of the sensor, for sensor effects.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
    /// Parameters by name. A missing parameter has its default, which is 0 for a size.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, f64>,
}
