//! Output to standard output, or to a program that calls a command. A reader that ends early
//! (`| head`) is not an error.

use std::fmt::{Arguments, Write as _};
use std::io::Write as _;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Output of a command for the program that called it; none if it goes to standard output.
static KEPT: Mutex<Option<String>> = Mutex::new(None);

fn kept() -> MutexGuard<'static, Option<String>> {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes a line.
pub(crate) fn line(text: Arguments<'_>) {
    let _ = match &mut *kept() {
        Some(kept) => writeln!(kept, "{text}").map_err(drop),
        None => writeln!(std::io::stdout(), "{text}").map_err(drop),
    };
}

/// Runs `work` and returns what it wrote instead of writing it to standard output.
pub(crate) fn keeping<T>(work: impl FnOnce() -> T) -> (T, String) {
    *kept() = Some(String::new());
    let result = work();
    (result, kept().take().unwrap_or_default())
}

/// Prints a line of a summary for people; nothing with `--quiet`.
macro_rules! print_line {
    ($($text:tt)*) => {{
        if !$crate::cli::console::is_quiet() {
            print_result!($($text)*);
        }
    }};
}

/// Prints a result that was asked for, also with `--quiet`: JSON, a generated file.
macro_rules! print_result {
    ($($text:tt)*) => {
        $crate::say::line(format_args!($($text)*))
    };
}
