//! `model-quant key`: key pairs for signing packages, and keys of links.

use crate::cli::error::CliError;
use crate::cli::output::{print, print_json};
use crate::data::file_io::{WriteError, temporary};
use crate::exchange::key::{digits, link_text, secret, text};
use ed25519_dalek::SigningKey;
use serde_json::json;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Make a key pair for signing model packages, or a key of a link
///
/// Writes the secret key to a file and prints the public key, which must be compiled into the
/// firmware. An existing file is not replaced; `--show` prints its public key.
///
/// With `--link` it is a key that the host shares with one controller; make a separate one for
/// each: the firmware is built with it, and commands of `host-sim` have it (`--link-key`). `--show`
/// then prints the key itself.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  model-quant key --out bench.key\n  model-quant key --show bench.key\n  \
                        PINTLE_MODEL_KEY=$(model-quant key --show bench.key) cargo xtask firmware\n  \
                        model-quant key --link --out link.key\n  \
                        PINTLE_LINK_KEY=$(model-quant key --link --show link.key) cargo xtask firmware"
)]
pub(crate) struct Arguments {
    /// File for the secret key
    #[arg(long, value_name = "FILE", required_unless_present = "show")]
    out: Option<PathBuf>,
    /// Print the public key of a key file; with --link the key itself
    #[arg(long, value_name = "FILE", conflicts_with = "out")]
    show: Option<PathBuf>,
    /// A key that host and controller share
    #[arg(long)]
    link: bool,
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    match (&arguments.show, &arguments.out) {
        (Some(path), _) if arguments.link => show("link_key", &digits(&read_secret(path)?), arguments.json),
        (Some(path), _) => show_public(&read(path)?, arguments.json),
        (None, Some(path)) if arguments.link => {
            make(path, link_text)?;
            show("link_key_file", &path.display().to_string(), arguments.json)
        }
        (None, Some(path)) => {
            let secret = make(path, |secret| text(&SigningKey::from_bytes(secret)))?;
            show_public(&SigningKey::from_bytes(&secret), arguments.json)
        }
        (None, None) => Ok(()),
    }
}

fn show_public(key: &SigningKey, as_json: bool) -> Result<(), CliError> {
    show("public_key", &digits(key.verifying_key().as_bytes()), as_json)
}

fn show(name: &str, value: &str, as_json: bool) -> Result<(), CliError> {
    if as_json { print_json(&json!({ name: value })) } else { print(format_args!("{value}")) }
}

/// Reads a key file.
pub(super) fn read(path: &Path) -> Result<SigningKey, CliError> {
    read_secret(path).map(|secret| SigningKey::from_bytes(&secret))
}

fn read_secret(path: &Path) -> Result<[u8; 32], CliError> {
    let content =
        std::fs::read_to_string(path).map_err(|source| CliError::Read { path: path.into(), source })?;
    secret(&content).map_err(|source| CliError::Key { path: path.into(), source })
}

/// Makes a key and a new file that only its owner can read from the moment of its creation.
fn make(path: &Path, format: impl FnOnce(&[u8; 32]) -> String) -> Result<[u8; 32], CliError> {
    let mut secret = [0; 32];
    getrandom::fill(&mut secret).map_err(CliError::Random)?;
    let failed = |source| WriteError { path: path.to_path_buf(), source };
    let mut file = temporary(path).map_err(failed)?;
    file.write_all(format(&secret).as_bytes()).map_err(failed)?;
    match file.persist_noclobber(path) {
        Ok(_) => Ok(secret),
        Err(refused) if refused.error.kind() == ErrorKind::AlreadyExists => {
            let found = path.display().to_string();
            Err(CliError::Argument("--out", found, "a file that does not exist yet"))
        }
        Err(refused) => Err(failed(refused.error).into()),
    }
}
