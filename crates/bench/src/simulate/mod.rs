//! Simulation of a bench: runs with all states, records as its sensors would log them, and
//! responses to a measured log.

mod axis_inputs;
mod axis_log;
mod error_bars;
mod forward_log;
pub mod impact_table;
pub mod life;
mod mechanism;
mod mechanism_log;
pub mod peaks;
mod record;
pub(crate) mod respond;
mod rig_groups;
mod run;
pub mod settled;
pub mod stepped;
mod transmission_log;

pub use mechanism::RunWithBars;
pub use record::{log_from_samples, record};
pub use respond::{Inputs, LoggedPlant, RespondError, Response, Truth, apply_sensors, respond};
pub use rig_groups::{LOADS_N, RigGroup, rig_groups};
pub use run::{DEFAULT_TOLERANCE, Run, run_bench_with_law, run_with_held_force, run_with_law, snapshots};
pub use transmission_log::{CHANNELS, ChannelReading};

use crate::description::Bench;

impl Bench {
    /// The plant as one that records logs; none if it has no log.
    pub fn logged(&self) -> Option<&dyn LoggedPlant> {
        match self {
            Self::Transmission(plant) => Some(&**plant),
            Self::FrictionRig(plant) => Some(&**plant),
            Self::Mechanism(plant) if !plant.measured.is_empty() => Some(&**plant),
            Self::SliderCrank(_) | Self::Mechanism(_) => None,
        }
    }
}
