//! The bench description: one TOML file says what a bench is, what its sensors do and what is uncertain about it.

macro_rules! section {
    ($(#[$meta:meta])* $name:ident { $($(#[$field_meta:meta])* $field:ident : $type:ty,)* }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $name { $($(#[$field_meta])* pub $field: $type,)* }
    };
}

mod change;
mod check;
mod extension;
mod friction_rig;
mod laws;
mod nuisances;
mod ranges;
mod transmission;

pub use extension::*;
pub use friction_rig::*;
pub use laws::integrates_friction;
pub use nuisances::Nuisances;
pub(crate) use ranges::shown;
pub use transmission::*;

use serde::{Deserialize, Serialize};

/// A bench of either kind that a log can be compared with.
#[derive(Clone, Debug, PartialEq)]
pub enum Bench {
    /// The rudder-drive transmission bench.
    Transmission(Box<TransmissionBench>),
    /// A single driven axis with a measured effort: the friction rig, or a linear axis.
    FrictionRig(Box<FrictionRig>),
}

/// Why a description was refused.
#[derive(Debug, thiserror::Error)]
pub enum DescriptionError {
    /// The file could not be read.
    #[error("{file}: cannot be read: {source}")]
    Unreadable {
        /// Path given.
        file: String,
        /// Cause.
        source: std::io::Error,
    },
    /// The text is no bench description.
    #[error("{file}: {message}")]
    Malformed {
        /// Path or preset.
        file: String,
        /// Line, column, what was found and expected.
        message: String,
    },
    /// A number is outside what the model can take.
    #[error("{file}: {field} is {found}; expected {expected}")]
    OutOfRange {
        /// Path or preset.
        file: String,
        /// Dotted name of the field.
        field: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        expected: String,
    },
}

section! {
    /// Force of the load cylinder.
    Load {
        /// Force along +Y in N.
        force_n: f64,
        /// Length of the raised-cosine ramp at the start, s.
        ramp_s: f64,
    }
}
section! {
    /// How a log of the bench is taken.
    Logging {
        /// Samples a second.
        sample_rate_hz: f64,
    }
}

/// Bearing materials with trained networks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BearingMaterial {
    /// Babbitt alloy.
    Babbitt,
    /// Engineering plastic alloy.
    Plastic,
}

fn one() -> f64 {
    1.0
}

fn is_one(value: &f64) -> bool {
    *value == 1.0
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}
