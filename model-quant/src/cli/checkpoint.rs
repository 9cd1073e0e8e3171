//! Bearings and checkpoints that a command is given.

use super::error::CliError;
use crate::network::checkpoint::{Checkpoint, read_checkpoint};
use crate::network::shipped::shipped_checkpoint;
use inference::BearingMaterial;
use std::path::Path;

/// Parses the name of a bearing material.
pub(super) fn parse_bearing(name: &str) -> Result<BearingMaterial, String> {
    let names = || BearingMaterial::ALL.map(|material| format!("`{}`", material.name())).join(" or ");
    BearingMaterial::from_name(name).ok_or_else(|| format!("found `{name}`, expected {}", names()))
}

/// The chosen bearing, or both.
pub(super) fn bearings(chosen: Option<BearingMaterial>) -> Vec<BearingMaterial> {
    chosen.map_or_else(|| BearingMaterial::ALL.to_vec(), |bearing| vec![bearing])
}

/// Loads a checkpoint and its training id from a file, or the shipped one of a bearing.
pub(super) fn checkpoint(
    file: Option<&Path>,
    bearing: BearingMaterial,
) -> Result<(Checkpoint, u64), CliError> {
    let (checkpoint, bytes) = match file {
        Some(path) => read_checkpoint(path)?,
        None => (Checkpoint::from_bytes(shipped_checkpoint(bearing))?, shipped_checkpoint(bearing).to_vec()),
    };
    Ok((checkpoint, Checkpoint::training_id(&bytes)))
}
