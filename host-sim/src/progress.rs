//! Progress of long work on the terminal.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Steps of a bar that counts percent.
pub const PERCENT: u64 = 100;

/// A bar of so many steps that shows itself once the work takes longer than a second; never beside JSON.
pub fn bar(hidden: bool, steps: u64) -> ProgressBar {
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
