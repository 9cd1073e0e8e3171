//! Output for people and machines: a reader that goes away (`| head`) is no error.

/// As `println!`, but a closed standard output is nobody's fault.
macro_rules! say {
    ($($text:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stdout(), $($text)*);
    }};
}
