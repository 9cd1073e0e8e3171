//! Bearings and checkpoints that a command is given.

use super::error::CliError;
use crate::network::checkpoint::{Checkpoint, read_checkpoint};
use crate::network::shipped::{bearing_names, shipped_checkpoint};
use clap::builder::{PossibleValue, TypedValueParser};
use inference::BearingMaterial;
use std::ffi::OsStr;
use std::path::Path;

/// Parser of a bearing material's name; the help lists the names.
#[derive(Clone, Copy, Debug)]
pub(super) struct BearingParser;

impl TypedValueParser for BearingParser {
    type Value = BearingMaterial;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &OsStr,
    ) -> Result<BearingMaterial, clap::Error> {
        let parse = |name: &str| {
            let found = BearingMaterial::from_name(name);
            found.ok_or_else(|| format!("found `{name}`, expected {}", bearing_names()))
        };
        parse.parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(BearingMaterial::ALL.into_iter().map(|material| material.name().into())))
    }
}

/// The chosen bearing, or all.
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
