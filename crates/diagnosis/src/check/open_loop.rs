//! Note about an axis whose motion is simulated in open loop.

use super::finding::{Finding, Severity};
use bench::{Bench, MeasuredLog};

/// Says what is not judged in this direction.
pub(super) fn not_judged(bench: &Bench, log: &MeasuredLog) -> Finding {
    let channel = bench.drive_channels().map_or("", |drive| drive.position.name());
    let found = "units, signs and load were not compared with the simulation".into();
    Finding::new(Severity::Note, &log.source, channel, "open-loop", found).cause(
        "the motion is simulated without feedback, so small errors of the model add up, and a diagnosis \
         compares only the speed if one is measured: the motion as input (without [drive]) or a closed loop \
         is compared in full",
    )
}
