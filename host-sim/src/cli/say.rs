//! Output to standard output. A reader that ends early (`| head`) is not an error.

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
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stdout(), $($text)*);
    }};
}
