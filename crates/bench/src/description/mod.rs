//! The data of a bench description: plant, sensors, uncertain parameters, log format and effects in
//! one TOML file.

#[macro_use]
mod bench;
mod common;
mod direction;
mod drive;
mod effect;
mod error;
mod extension;
mod friction_rig;
mod law_names;
mod mechanism;
mod nuisances;
mod plant;
mod slider_crank;
mod transmission;

pub(crate) use crate::schema::format_number;
pub use common::Common;
pub use drive::{Drive, DriveInput, Simulated};
pub use effect::{Effect, Plant};
pub use error::{DescriptionError, Flaw, Refusal};
pub use extension::*;
pub use friction_rig::*;
pub use law_names::{CompleteLawName, DampingName, DissipationName, FrictionName, StiffnessName};
pub use mechanism::*;
pub use nuisances::Nuisances;
pub use plant::{CommonSections, DriveChannels, Field, PlantDescription, Range};
pub use slider_crank::*;
pub use transmission::*;

use crate::schema::{HUGE, TINY, section};

plants! {
    /// The rudder-drive transmission bench.
    Transmission(TransmissionBench),
    /// A single driven axis with a measured effort: the friction rig, or a linear axis.
    FrictionRig(FrictionRig),
    /// A slider-crank with a clearance joint; it is run, but neither recorded nor diagnosed.
    SliderCrank(SliderCrankBench),
    /// A planar mechanism; it is run and recorded, but not diagnosed.
    Mechanism(MechanismBench),
}

section! {
    /// Force of the load cylinder.
    Load {
        /// Load; on the transmission bench positive along +Y.
        force_n: f64 [-1e7, 1e7],
        /// Length of the raised-cosine ramp at the start.
        ramp_s: f64 [TINY, HUGE],
    }
}
section! {
    /// Recording of a log.
    Logging {
        /// Samples per second; a record has at most 10 million samples.
        sample_rate_hz: f64 [1e-6, 1e9],
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
