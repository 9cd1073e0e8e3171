//! Multibody benchmarks with ideal joints, posed as mechanisms; one file each.

pub(super) mod four_bar;
pub(super) mod pendulum;
pub(super) mod squeezer;

use crate::integrate::IntegrationError;
use crate::plants::mechanism::{Mechanism, RunOptions, Snapshot};

/// Runs a mechanism and returns its state at the end of each duration.
fn states_at(
    mechanism: &Mechanism,
    times_s: &[f64],
    tolerance: f64,
) -> Result<Vec<Snapshot>, IntegrationError> {
    let run = |duration_s: &f64| {
        let options =
            RunOptions { duration_s: *duration_s, tolerance, largest_step_s: 0.01, is_closed: true };
        mechanism.run(&[], &options, None).map(|run| run.end)
    };
    times_s.iter().map(run).collect()
}
