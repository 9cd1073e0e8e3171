//! Building the firmware's image for a board of the table.

use crate::run::{ChoreError, root, run, target_folder};
use crate::setup;
use controller::boards::{self, BOARDS, Board};
use controller::store::key::DEVELOPMENT_KEY;
use std::path::{Path, PathBuf};

/// The image that serves every board with an STM32F405.
pub(crate) const DEFAULT: Firmware = Firmware(&BOARDS[0]);
/// The image for a board with another core.
pub(crate) const OTHER_CORE: Firmware = match boards::find("mps2-an505") {
    Some(board) => Firmware(board),
    None => DEFAULT,
};

/// The image for a board that no emulator models: it is linked and checked, and never run.
pub(crate) const NOT_EMULATED: Firmware = match boards::find("nucleo-h743zi2") {
    Some(board) => Firmware(board),
    None => DEFAULT,
};

/// The firmware for one board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Firmware(pub(crate) &'static Board);

/// Parses the argument of `--board`.
pub(crate) fn parse_board(name: &str) -> Result<Firmware, boards::UnknownBoard> {
    boards::find(name).map(Firmware).ok_or(boards::UnknownBoard)
}

/// Variable with the keys that the firmware trusts.
const KEYS: &str = "PINTLE_MODEL_KEY";
/// Variable of the key of the link.
const LINK_KEY: &str = "PINTLE_LINK_KEY";

/// Builds the image of a board, or the one that provokes faults on demand, and returns its path.
/// For delivery it needs keys of its owner.
pub(crate) fn image(board: Firmware, is_provoking: bool, is_delivered: bool) -> Result<PathBuf, ChoreError> {
    if is_delivered {
        require_own_keys()?;
    }
    if is_provoking { board.build_provoking() } else { board.build() }
}

/// Refuses a build for delivery whose firmware would trust the published development key.
pub(crate) fn require_own_keys() -> Result<(), ChoreError> {
    own_keys(std::env::var(KEYS).ok().as_deref()).map_err(ChoreError::ByHand)
}

/// Refuses a build for others that would contain the secret key of a link.
pub(crate) fn refuse_link_key() -> Result<(), ChoreError> {
    match std::env::var_os(LINK_KEY) {
        Some(_) => Err(ChoreError::ByHand(format!(
            "{LINK_KEY}: it is set; expected an archive without a secret key"
        ))),
        None => Ok(()),
    }
}

fn own_keys(listed: Option<&str>) -> Result<(), String> {
    let development: String = DEVELOPMENT_KEY.iter().map(|byte| format!("{byte:02x}")).collect();
    let found = match listed {
        None => "it is not set, and the firmware would trust the published development key",
        Some(keys) if keys.to_lowercase().contains(&development) => "it has the published development key",
        Some(_) => return Ok(()),
    };
    Err(format!(
        "{KEYS}: {found}; expected the public keys of the firmware's owner \
         (`model-quant key --out my.key`)"
    ))
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

    /// Builds the tests that run on a board.
    pub(crate) fn build_tests(&self) -> Result<PathBuf, ChoreError> {
        let image = self.compile_binary("on_target", &["on-target"], &[])?;
        copy(&image, &format!("on-target-{}", self.0.name))
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

    /// Compiles the estimator and seals its code.
    fn compile(&self, features: &[&str], variables: &[(&str, &str)]) -> Result<PathBuf, ChoreError> {
        let image = self.compile_binary("estimator", features, variables)?;
        crate::seal::seal(&image, self.0.microcontroller.is_emulated_only())?;
        Ok(image)
    }

    fn compile_binary(
        &self,
        binary: &str,
        features: &[&str],
        variables: &[(&str, &str)],
    ) -> Result<PathBuf, ChoreError> {
        let microcontroller = self.0.microcontroller;
        let toolchain = setup::target(microcontroller.target)?;
        let mut command = crate::compile::build(&toolchain, microcontroller.target, root())?;
        command.args(["--profile", "firmware", "--package", "firmware", "--bin", binary, "--features"]);
        command.arg([&[microcontroller.feature], features].concat().join(","));
        // Without it defmt omits every line but errors.
        command.env("DEFMT_LOG", "info");
        command.env("PINTLE_BOARD", self.0.name).envs(variables.iter().copied());
        run(&mut command)?;
        let folder = variables.iter().find(|(name, _)| *name == "CARGO_TARGET_DIR");
        let folder = folder.map_or_else(target_folder, |(_, folder)| PathBuf::from(folder));
        let image = folder.join(microcontroller.target).join("firmware").join(binary);
        crate::memory_map::check(&image, &microcontroller.memory_map)?;
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
    fn a_firmware_for_delivery_needs_the_keys_of_its_owner() {
        let own = "d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a";
        let development = "127CEEAC7C1A6778BC27AD771F8A0B51F16C7F5BF66C29D09A021B12A2C43B18";
        assert_eq!(own_keys(Some(own)), Ok(()));
        assert!(own_keys(None).unwrap_err().contains("not set"));
        let both = format!("{own},{development}");
        assert!(own_keys(Some(&both)).unwrap_err().contains("published development key"));
    }

    #[test]
    fn the_second_image_is_for_another_core() {
        assert_ne!(DEFAULT.0.microcontroller.target, OTHER_CORE.0.microcontroller.target);
        assert_ne!(DEFAULT.0.microcontroller, NOT_EMULATED.0.microcontroller);
        assert!(!NOT_EMULATED.0.microcontroller.is_emulated_only());
    }
}
