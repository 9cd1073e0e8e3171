//! Live values of a running controller, twice a second.

use super::describe;
use super::info::{optional_report, track};
use crate::cli::error::CliError;
use crate::controller::{Controller, RemoteController};
use crate::impact_text::line;
use link::{Answer, Command, NumberedEstimate, ReportKind, SlowReport};
use serde_json::json;
use std::time::Duration;

/// Prints the newest estimate, the largest force and the impacts since the last one, the counters,
/// the tracked values and the newest raw sample twice a second for some seconds.
pub(crate) fn follow(controller: &mut RemoteController, seconds: u32, as_json: bool) -> Result<(), CliError> {
    for _ in 0..seconds.saturating_mul(2) {
        std::thread::sleep(Duration::from_millis(500));
        let estimate = optional_report(controller.order(Command::GetReport(ReportKind::Estimate)))?;
        let Some(SlowReport::Estimate(estimate)) = estimate else {
            return Err(CliError::Work(
                "no run is active: configure the controller first (host-sim link --configure)".into(),
            ));
        };
        let estimate = NumberedEstimate::from(estimate).estimate;
        let Answer::Counters(counters) = controller.order(Command::GetCounters)? else {
            return Err(CliError::Work("expected the counters".into()));
        };
        let track = track(controller)?;
        let sample = match optional_report(controller.order(Command::GetReport(ReportKind::Sample)))? {
            Some(SlowReport::Sample(sample)) => Some(sample),
            _ => None,
        };
        let impacts = controller.take_impacts();
        let blocks = controller.take_blocks();
        if as_json {
            let line = json!({
                "sample": sample, "estimate": estimate, "flags": describe::flags(&estimate),
                "counters": counters, "track": track, "impacts": impacts,
                "blocks": blocks.map(|(max_force_n, flags)| json!({
                    "max_force_n": max_force_n, "flags": describe::names(flags),
                })),
            });
            print_line!("{line}");
        } else {
            if let Some(sample) = sample {
                print_line!("{}", describe::sample(&sample));
            }
            print_line!("{}", describe::live(&estimate, &counters, track.as_ref()));
            if let Some((max_force_n, flags)) = blocks {
                print_line!(
                    "  since the last line: at most {max_force_n:.1} N  {}",
                    describe::names(flags).join(" ")
                );
            }
            for impact in &impacts {
                print_line!("  {}", line(impact));
            }
        }
    }
    Ok(())
}
