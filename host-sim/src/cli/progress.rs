//! Progress bars.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Length of a bar in percent.
pub(crate) const PERCENT: u64 = 100;

/// Creates a bar that appears once the work takes longer than a second; hidden with JSON output.
pub(crate) fn bar(hidden: bool, steps: u64) -> ProgressBar {
    if hidden {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(steps);
    if let Ok(style) = ProgressStyle::with_template("{msg:28} {bar:40} {elapsed} eta {eta}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_secs(1));
    bar
}
