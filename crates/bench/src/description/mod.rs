//! The data of a bench description: plant, sensors, uncertain parameters, log format and effects in
//! one TOML file.

macro_rules! section {
    ($(#[$meta:meta])* $name:ident { $($(#[$field_meta:meta])* $field:ident : $type:ty,)* }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $name { $($(#[$field_meta])* pub $field: $type,)* }
    };
}

mod bench;
mod common;
mod effect;
mod error;
mod extension;
mod friction_rig;
mod law_names;
mod nuisances;
mod plant;
mod slider_crank;
mod transmission;

pub use bench::Bench;
pub use common::Common;
pub use effect::{Effect, Plant};
pub use error::DescriptionError;
pub use extension::*;
pub use friction_rig::*;
pub use law_names::{CompleteLawName, DampingName, DissipationName, FrictionName, StiffnessName};
pub use nuisances::Nuisances;
pub use plant::{CommonSections, DriveChannels, Field, PlantDescription, Range, Refusal};
pub use slider_crank::*;
pub use transmission::*;

use serde::{Deserialize, Serialize};

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
    /// Recording of a log.
    Logging {
        /// Samples per second.
        sample_rate_hz: f64,
    }
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

/// Formats a number for a message: plainly, or with a power of ten if that is shorter.
pub(crate) fn format_number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e7).contains(&value.abs()) || !value.is_finite() {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}
