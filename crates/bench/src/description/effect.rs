//! Entry of `[[effects]]` and the plants on which effects act: data only. The actions are in
//! [`crate::effects`].

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
    /// Body or joint of a mechanism, for effects on one of its parts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// Parameters by name. A missing parameter has its default, which is 0 for a size.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, f64>,
}

/// Plant on which effects act.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plant {
    /// Transmission bench without tilt.
    Planar,
    /// Transmission bench with a `[two_plane]` section.
    TwoPlane,
    /// Driven axis of kind `rotary`: the friction rig.
    Rotary,
    /// Driven axis of kind `linear`.
    Linear,
    /// Mechanism with a log.
    Mechanism,
}

impl Plant {
    /// Plants on which effects act, in the order of the documentation.
    pub const ALL: &[Self] = &[Self::Planar, Self::TwoPlane, Self::Rotary, Self::Linear, Self::Mechanism];

    /// The transmission bench in either form.
    pub(crate) const TRANSMISSION: &[Self] = &[Self::Planar, Self::TwoPlane];
    /// A driven axis of either kind.
    pub(crate) const AXES: &[Self] = &[Self::Rotary, Self::Linear];
    /// A mechanism alone.
    pub(crate) const MECHANISM: &[Self] = &[Self::Mechanism];

    /// Name of the plant for messages.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Planar => "planar transmission bench",
            Self::TwoPlane => "transmission bench with [two_plane]",
            Self::Rotary => "friction rig",
            Self::Linear => "linear axis",
            Self::Mechanism => "mechanism with `[[measured]]`",
        }
    }
}
