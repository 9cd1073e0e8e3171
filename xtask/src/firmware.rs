//! Building the firmware's image for one of the boards.

use crate::run::{ChoreError, root, run, target_folder};
use crate::setup::{self, TARGET};
use std::path::PathBuf;

/// A board that an image can be built for. Its crystal, light and pins are in `firmware/src/boards/pins.rs`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Board {
    /// Its name, which the image is told.
    pub(crate) name: &'static str,
    /// The compiler's target.
    pub(crate) target: &'static str,
    /// The firmware's feature.
    pub(crate) feature: &'static str,
}

const fn stm32f405(name: &'static str) -> Board {
    Board { name, target: TARGET, feature: "stm32f405" }
}

/// Every board; the first is the default.
pub(crate) const BOARDS: [Board; 5] = [
    stm32f405("stm32f405"),
    stm32f405("feather-stm32f405"),
    stm32f405("olimex-stm32-h405"),
    stm32f405("netduino-plus-2"),
    Board { name: "mps2-an505", target: "thumbv8m.main-none-eabihf", feature: "mps2-an505" },
];

/// The image that serves every board with an STM32F405.
pub(crate) const DEFAULT: Board = BOARDS[0];
/// The board of a different core.
pub(crate) const OTHER_CORE: Board = BOARDS[4];

/// The board of a name, for the command line.
pub(crate) fn board(name: &str) -> Result<Board, String> {
    let names = || BOARDS.map(|board| board.name).join(", ");
    BOARDS.into_iter().find(|board| board.name == name).ok_or_else(|| format!("expected one of {}", names()))
}

impl Board {
    /// Builds the image and says where it is: `estimator`, or `estimator-NAME` for a named board of the default's kind.
    pub(crate) fn build(&self) -> Result<PathBuf, ChoreError> {
        let image = self.compile(&[], &[])?;
        if self.target == DEFAULT.target && self.name != DEFAULT.name {
            self.set_aside(&image, self.name)
        } else {
            Ok(image)
        }
    }

    /// Builds the image that commits faults on demand, for the emulator's tests.
    pub(crate) fn build_provoking(&self) -> Result<PathBuf, ChoreError> {
        let image = self.compile(&["provoke"], &[])?;
        self.set_aside(&image, "provoke")
    }

    /// Builds the image in a folder of its own with the sizes of its stack frames in it; the code is the same.
    pub(crate) fn build_with_stack_sizes(&self) -> Result<PathBuf, ChoreError> {
        let folder = target_folder().join("stack");
        let folder = folder.to_string_lossy();
        self.compile(
            &[],
            &[("RUSTC_BOOTSTRAP", "1"), ("RUSTFLAGS", "-Zemit-stack-sizes"), ("CARGO_TARGET_DIR", &folder)],
        )
    }

    fn compile(&self, more: &[&str], variables: &[(&str, &str)]) -> Result<PathBuf, ChoreError> {
        let way = setup::target(self.target)?;
        let mut command = crate::compile::build(&way, self.target, root())?;
        command.args(["--profile", "firmware", "--package", "firmware", "--bin", "estimator", "--features"]);
        command.arg([&[self.feature], more].concat().join(","));
        // Without it defmt leaves every line but errors out of the image.
        command.env("DEFMT_LOG", "info");
        command.env("PINTLE_BOARD", self.name).envs(variables.iter().copied());
        run(&mut command)?;
        let folder = variables.iter().find(|(name, _)| *name == "CARGO_TARGET_DIR");
        let folder = folder.map_or_else(target_folder, |(_, folder)| PathBuf::from(folder));
        let image = folder.join(self.target).join("firmware/estimator");
        crate::seal::seal(&image, self.target == OTHER_CORE.target)?;
        Ok(image)
    }

    /// Cargo's next build writes over an image: a copy stays.
    fn set_aside(&self, image: &std::path::Path, name: &str) -> Result<PathBuf, ChoreError> {
        let copy = image.with_file_name(format!("estimator-{name}"));
        std::fs::copy(image, &copy).map_err(|error| ChoreError::File {
            file: copy.clone(),
            found: error.to_string(),
            expected: "a file that can be written",
        })?;
        Ok(copy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_boards_are_those_that_the_firmware_knows() {
        let pins = std::fs::read_to_string(root().join("firmware/src/boards/pins.rs")).unwrap();
        let known: Vec<_> =
            pins.split("name: \"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
        assert_eq!(known, BOARDS.map(|board| board.name));
        assert!(board("stm32f4").is_err());
    }
}
