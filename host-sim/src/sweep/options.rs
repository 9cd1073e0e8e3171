//! Options that every command with many runs takes.

use crate::cli::error::CliError;
use crate::cli::options::thread_count;
use crate::run::arguments::communication_step_s;
use crate::run::force::{DEFAULT_STEP_S, ForceSource};
use bench::description::TransmissionBench;
use clap::Args;

/// Options of many runs.
#[derive(Args, Clone, Debug)]
pub struct SweepOptions {
    /// Preset or bench description that the runs vary; the file of a sweep names its own.
    #[arg(long, value_name = "NAME|FILE")]
    pub bench: Option<String>,
    /// Source of the bearing force; default: the quantised networks, or the source in the sweep's
    /// file.
    #[arg(long, value_enum)]
    pub force: Option<ForceSource>,
    /// Communication step of the networks in microseconds: their force is held constant over it.
    #[arg(long, default_value_t = 1e6 * DEFAULT_STEP_S, value_name = "US", allow_negative_numbers = true)]
    pub step_us: f64,
    /// Threads; 0 uses one per core. The result does not depend on it.
    #[arg(long, default_value_t = 0, value_name = "N", value_parser = thread_count())]
    pub threads: usize,
}

impl SweepOptions {
    /// Returns the checked communication step in s.
    pub fn step_s(&self) -> Result<f64, CliError> {
        communication_step_s(self.step_us)
    }

    /// Opens the bench that the runs vary.
    pub fn base(&self) -> Result<TransmissionBench, CliError> {
        open_published(self.bench.as_deref().unwrap_or("bench-b"))
    }
}

/// Opens a bench for runs under the paper's conditions; refuses other courses of drive and load.
pub(crate) fn open_published(name: &str) -> Result<TransmissionBench, CliError> {
    let bench = TransmissionBench::open(name)?;
    if bench.drive_profile.is_some() || bench.load_profile.is_some() || bench.servo.is_some() {
        return Err(CliError::Input(format!(
            "{name}: found [drive_profile], [load_profile] or [servo]; expected the sine and the constant \
             load of the published sweeps"
        )));
    }
    Ok(bench)
}
