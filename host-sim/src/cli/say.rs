//! Output to standard output. A reader that ends early (`| head`) is not an error.

/// Equivalent of `println!` that ignores a closed standard output.
macro_rules! print_line {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stdout(), $($text)*);
    }};
}
