//! Options of every command for the terminal: amount of text and colours.

use clap::Args;
use std::sync::atomic::{AtomicU8, Ordering};

/// Amount of text of this process; set once, before the command starts.
static LEVEL: AtomicU8 = AtomicU8::new(NORMAL);
const QUIET: u8 = 0;
const NORMAL: u8 = 1;
const VERBOSE: u8 = 2;

/// Amount of text and colours.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct ConsoleOptions {
    /// Print errors and results in JSON only: no summary, no progress.
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Print each step of the work and its time to standard error.
    #[arg(short, long, global = true)]
    verbose: bool,
    #[command(flatten)]
    color: colorchoice_clap::Color,
}

impl ConsoleOptions {
    /// Makes the options those of the process. The variable `NO_COLOR` counts unless `--color` is
    /// given.
    pub(crate) fn apply(self) {
        self.color.write_global();
        let level = match (self.quiet, self.verbose) {
            (true, _) => QUIET,
            (false, true) => VERBOSE,
            (false, false) => NORMAL,
        };
        LEVEL.store(level, Ordering::Relaxed);
    }
}

/// Returns true if only errors and results in JSON are printed.
pub(crate) fn is_quiet() -> bool {
    LEVEL.load(Ordering::Relaxed) == QUIET
}

/// Returns true if each step of the work is printed.
pub(crate) fn is_verbose() -> bool {
    LEVEL.load(Ordering::Relaxed) == VERBOSE
}
