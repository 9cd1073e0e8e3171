//! Building the firmware's image.

use crate::run::{ChoreError, root, run, target_folder};
use crate::setup::{TARGET, Way};
use std::path::PathBuf;

/// Builds the image and says where it is.
pub(crate) fn build(way: &Way) -> Result<PathBuf, ChoreError> {
    let mut command = crate::compile::build(way, TARGET, root())?;
    command.args([
        "--profile",
        "firmware",
        "--package",
        "firmware",
        "--bin",
        "estimator",
        "--features",
        "stm32f405",
    ]);
    run(&mut command)?;
    Ok(target_folder().join(TARGET).join("firmware/estimator"))
}
