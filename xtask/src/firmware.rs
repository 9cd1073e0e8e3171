//! Building the firmware's image for a board of the table.

use crate::run::{ChoreError, root, run, target_folder};
use crate::setup;
use controller::boards::{self, BOARDS, Board};
use std::path::{Path, PathBuf};

/// The image that serves every board with an STM32F405.
pub(crate) const DEFAULT: Firmware = Firmware(&BOARDS[0]);
/// The image for a board with another core.
pub(crate) const OTHER_CORE: Firmware = match boards::find("mps2-an505") {
    Some(board) => Firmware(board),
    None => DEFAULT,
};

/// The firmware for one board.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Firmware(pub(crate) &'static Board);

/// Parses the argument of `--board`.
pub(crate) fn parse_board(name: &str) -> Result<Firmware, boards::UnknownBoard> {
    boards::find(name).map(Firmware).ok_or(boards::UnknownBoard)
}

/// Builds the image of a board, or the one that provokes faults on demand, and returns its path.
pub(crate) fn image(board: Firmware, is_provoking: bool) -> Result<PathBuf, ChoreError> {
    if is_provoking { board.build_provoking() } else { board.build() }
}

impl Firmware {
    /// Builds the image and returns its path.
    pub(crate) fn build(&self) -> Result<PathBuf, ChoreError> {
        let image = self.compile(&[], &[])?;
        copy(&image, &self.0.image_name().to_string())
    }

    /// Builds the image that provokes faults on demand, for the emulator's tests.
    pub(crate) fn build_provoking(&self) -> Result<PathBuf, ChoreError> {
        let image = self.compile(&["provoke"], &[])?;
        copy(&image, "estimator-provoke")
    }

    /// Builds the image with the sizes of its stack frames, in a separate folder. The code is the
    /// same.
    pub(crate) fn build_with_stack_sizes(&self) -> Result<PathBuf, ChoreError> {
        let folder = target_folder().join("stack");
        let folder = folder.to_string_lossy();
        self.compile(
            &[],
            &[("RUSTC_BOOTSTRAP", "1"), ("RUSTFLAGS", "-Zemit-stack-sizes"), ("CARGO_TARGET_DIR", &folder)],
        )
    }

    fn compile(&self, features: &[&str], variables: &[(&str, &str)]) -> Result<PathBuf, ChoreError> {
        let microcontroller = self.0.microcontroller;
        let toolchain = setup::target(microcontroller.target)?;
        let mut command = crate::compile::build(&toolchain, microcontroller.target, root())?;
        command.args(["--profile", "firmware", "--package", "firmware", "--bin", "estimator", "--features"]);
        command.arg([&[microcontroller.feature], features].concat().join(","));
        // Without it defmt omits every line but errors.
        command.env("DEFMT_LOG", "info");
        command.env("PINTLE_BOARD", self.0.name).envs(variables.iter().copied());
        run(&mut command)?;
        let folder = variables.iter().find(|(name, _)| *name == "CARGO_TARGET_DIR");
        let folder = folder.map_or_else(target_folder, |(_, folder)| PathBuf::from(folder));
        let image = folder.join(microcontroller.target).join("firmware/estimator");
        crate::memory_map::check(&image, &microcontroller.memory_map)?;
        crate::seal::seal(&image, microcontroller.is_emulated_only())?;
        Ok(image)
    }
}

/// Copies an image beside itself under another name: cargo's next build overwrites the original.
fn copy(image: &Path, name: &str) -> Result<PathBuf, ChoreError> {
    let copy = image.with_file_name(name);
    if copy != image {
        std::fs::copy(image, &copy).map_err(|error| ChoreError::File {
            file: copy.clone(),
            found: error.to_string(),
            expected: "a file that can be written",
        })?;
    }
    Ok(copy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_image_is_for_another_core() {
        assert_ne!(DEFAULT.0.microcontroller.target, OTHER_CORE.0.microcontroller.target);
    }
}
