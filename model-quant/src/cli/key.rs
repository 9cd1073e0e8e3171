//! `model-quant key`: key pairs for signing packages.

use crate::cli::error::CliError;
use crate::cli::output::{print, print_json};
use crate::data::file_io::{WriteError, temporary};
use crate::exchange::key::{digits, parse, text};
use ed25519_dalek::SigningKey;
use serde_json::json;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Make a key pair for signing model packages
///
/// Writes the secret key to a file and prints the public key, which must be compiled into the
/// firmware. An existing file is not replaced; `--show` prints its public key.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  model-quant key --out bench.key\n  model-quant key --show bench.key\n  \
                        PINTLE_MODEL_KEY=$(model-quant key --show bench.key) cargo xtask firmware"
)]
pub(crate) struct Arguments {
    /// File for the secret key
    #[arg(long, value_name = "FILE", required_unless_present = "show")]
    out: Option<PathBuf>,
    /// Print the public key of a key file
    #[arg(long, value_name = "FILE", conflicts_with = "out")]
    show: Option<PathBuf>,
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let key = match (&arguments.show, &arguments.out) {
        (Some(path), _) => read(path)?,
        (None, Some(path)) => make(path)?,
        (None, None) => return Ok(()),
    };
    let public = digits(key.verifying_key().as_bytes());
    if arguments.json {
        return print_json(&json!({ "public_key": public }));
    }
    print(format_args!("{public}"))
}

/// Reads a key file.
pub(super) fn read(path: &Path) -> Result<SigningKey, CliError> {
    let content =
        std::fs::read_to_string(path).map_err(|source| CliError::Read { path: path.into(), source })?;
    parse(&content).map_err(|source| CliError::Key { path: path.into(), source })
}

/// Makes a key and a new file that only its owner can read from the moment of its creation.
fn make(path: &Path) -> Result<SigningKey, CliError> {
    let mut secret = [0; 32];
    getrandom::fill(&mut secret).map_err(CliError::Random)?;
    let key = SigningKey::from_bytes(&secret);
    let failed = |source| WriteError { path: path.to_path_buf(), source };
    let mut file = temporary(path).map_err(failed)?;
    file.write_all(text(&key).as_bytes()).map_err(failed)?;
    match file.persist_noclobber(path) {
        Ok(_) => Ok(key),
        Err(refused) if refused.error.kind() == ErrorKind::AlreadyExists => {
            let found = path.display().to_string();
            Err(CliError::Argument("--out", found, "a file that does not exist yet"))
        }
        Err(refused) => Err(failed(refused.error).into()),
    }
}
