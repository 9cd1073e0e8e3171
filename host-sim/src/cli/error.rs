//! The error of a command, which determines the exit code.

use bench::description::DescriptionError;
use bench::integrate::IntegrationError;
use bench::log::LogError;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// The input is wrong: exit code 2. Names file, line or field, what was found and what was
    /// expected.
    #[error("{0}")]
    Input(String),
    /// The work failed: exit code 1.
    #[error("{0}")]
    Work(String),
}

impl CliError {
    /// The process's exit code.
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Input(_) => 2,
            Self::Work(_) => 1,
        }
    }

    /// Creates the error of an output that cannot be written.
    pub fn output(path: &std::path::Path, error: &std::io::Error) -> Self {
        Self::Work(format!("{}: cannot be written: {error}", path.display()))
    }
}

impl From<DescriptionError> for CliError {
    fn from(error: DescriptionError) -> Self {
        Self::Input(error.to_string())
    }
}

impl From<LogError> for CliError {
    fn from(error: LogError) -> Self {
        Self::Input(error.to_string())
    }
}

impl From<IntegrationError> for CliError {
    fn from(error: IntegrationError) -> Self {
        Self::Work(error.to_string())
    }
}
