//! Progress of long work on standard error: a bar in a terminal, else a line now and then.

use super::console;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Length of a bar in percent.
pub(crate) const PERCENT: u64 = 100;
/// Time between two lines of the same step of the work.
const LINE_PERIOD: Duration = Duration::from_secs(10);
/// Time between two looks at the work for a new line.
const LOOK_PERIOD: Duration = Duration::from_millis(10);

/// Creates a progress of `steps`. In a terminal it is a bar that appears after a second. Into a
/// pipe, and with `--verbose`, lines are printed; with `--quiet` nothing.
pub(crate) fn bar(steps: u64) -> ProgressBar {
    if console::is_quiet() {
        return ProgressBar::hidden();
    }
    if console::is_verbose() || !std::io::stderr().is_terminal() {
        let bar = ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::hidden());
        print_lines(&bar);
        return bar;
    }
    let bar = ProgressBar::new(steps);
    if let Ok(style) = ProgressStyle::with_template("{msg:28} {bar:40} {elapsed} eta {eta}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_secs(1));
    bar
}

/// Prints lines about a progress from a thread that ends with it.
fn print_lines(bar: &ProgressBar) {
    let watched = bar.downgrade();
    std::thread::spawn(move || {
        let mut lines = Lines::default();
        while let Some(bar) = watched.upgrade().filter(|bar| !bar.is_finished()) {
            let seen = Seen { message: bar.message(), position: bar.position(), length: bar.length() };
            if let Some(line) = lines.next(seen, bar.elapsed(), console::is_verbose()) {
                anstream::eprintln!("{line}");
            }
            drop(bar);
            std::thread::sleep(LOOK_PERIOD);
        }
    });
}

/// State of a progress at one time.
struct Seen {
    message: String,
    position: u64,
    length: Option<u64>,
}

/// Decides when a line is due.
#[derive(Default)]
struct Lines {
    message: String,
    last: Duration,
}

impl Lines {
    /// Returns the line that is due after `elapsed`, if any. With `is_verbose` every new message
    /// gets one.
    fn next(&mut self, seen: Seen, elapsed: Duration, is_verbose: bool) -> Option<String> {
        let is_new = is_verbose && seen.message != self.message;
        if !is_new && elapsed < self.last + LINE_PERIOD {
            return None;
        }
        self.last = elapsed;
        self.message.clone_from(&seen.message);
        let of = seen.length.map_or_else(String::new, |length| match length {
            PERCENT => format!(", {} %", seen.position),
            1 => String::new(),
            _ => format!(", {} of {length}", seen.position),
        });
        Some(format!("{:.0} s: {}{of}", elapsed.as_secs_f64(), seen.message))
    }
}

/// Prints the time since `start` if each step of the work is printed.
pub(crate) fn print_duration(start: Instant) {
    if console::is_verbose() {
        anstream::eprintln!("done in {:.1} s", start.elapsed().as_secs_f64());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(message: &str, position: u64) -> Seen {
        Seen { message: message.into(), position, length: Some(16) }
    }

    #[test]
    fn a_pipe_gets_a_line_every_ten_seconds() {
        let mut lines = Lines::default();
        let at = |s: f64| Duration::from_secs_f64(s);
        assert_eq!(lines.next(seen("runs", 0), at(0.1), false), None);
        assert_eq!(lines.next(seen("runs", 2), at(9.9), false), None);
        assert_eq!(lines.next(seen("runs", 3), at(10.0), false).unwrap(), "10 s: runs, 3 of 16");
        assert_eq!(lines.next(seen("claims", 3), at(19.0), false), None);
        assert_eq!(lines.next(seen("claims", 4), at(20.0), false).unwrap(), "20 s: claims, 4 of 16");
    }

    #[test]
    fn every_step_gets_a_line_if_verbose() {
        let mut lines = Lines::default();
        let at = |s: f64| Duration::from_secs_f64(s);
        assert_eq!(lines.next(seen("runs", 0), at(0.1), true).unwrap(), "0 s: runs, 0 of 16");
        assert_eq!(lines.next(seen("runs", 1), at(0.2), true), None);
        assert_eq!(lines.next(seen("claims", 1), at(0.3), true).unwrap(), "0 s: claims, 1 of 16");
    }
}
