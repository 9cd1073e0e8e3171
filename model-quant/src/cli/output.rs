//! Standard output of the commands.

use super::error::CliError;
use std::io::Write;

/// Prints a value as JSON.
pub(super) fn print_json(value: &impl serde::Serialize) -> Result<(), CliError> {
    print(format_args!("{}", serde_json::to_string_pretty(value)?))
}

/// Prints a line; a closed pipe is not an error.
pub(super) fn print(line: std::fmt::Arguments<'_>) -> Result<(), CliError> {
    match writeln!(std::io::stdout(), "{line}") {
        Err(source) if source.kind() != std::io::ErrorKind::BrokenPipe => Err(CliError::Output(source)),
        _ => Ok(()),
    }
}
