//! `model-quant key`: a pair of keys for model packages.

use super::{CliError, print, print_json};
use ed25519_dalek::SigningKey;
use model_quant::key::{digits, parse, text};
use model_quant::write::write_whole;
use serde_json::json;
use std::path::PathBuf;

/// Make a key that model packages are signed with
///
/// Writes the secret half to a file and prints the public half, which the firmware has to be built with. A file that is there already is
/// not replaced: its public half is printed again with `--show`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  model-quant key --out bench.key\n  model-quant key --show bench.key\n  \
                        PINTLE_MODEL_KEY=$(model-quant key --show bench.key) cargo xtask firmware"
)]
pub(crate) struct Arguments {
    /// File that gets the secret half
    #[arg(long, value_name = "FILE", required_unless_present = "show")]
    out: Option<PathBuf>,
    /// Print the public half of the key in a file
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

/// Reads a key from a file.
pub(super) fn read(path: &std::path::Path) -> Result<SigningKey, CliError> {
    let content =
        std::fs::read_to_string(path).map_err(|source| CliError::Read { path: path.into(), source })?;
    parse(&content).map_err(|source| CliError::Key { path: path.into(), source })
}

fn make(path: &std::path::Path) -> Result<SigningKey, CliError> {
    if path.exists() {
        return Err(CliError::Argument("--out", path.display().to_string(), "a file that is not there yet"));
    }
    let mut secret = [0; 32];
    getrandom::fill(&mut secret).map_err(CliError::Random)?;
    let key = SigningKey::from_bytes(&secret);
    write_whole(path, text(&key).as_bytes())?;
    only_for_its_owner(path)?;
    Ok(key)
}

#[cfg(unix)]
fn only_for_its_owner(path: &std::path::Path) -> Result<(), CliError> {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o600))
        .map_err(|source| CliError::Read { path: path.into(), source })
}

#[cfg(not(unix))]
fn only_for_its_owner(_path: &std::path::Path) -> Result<(), CliError> {
    Ok(())
}
