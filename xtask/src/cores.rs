//! Emulated cores for the kernels, and the way to run an image on one of them. The boards of the
//! firmware are in `controller::boards`.

use crate::compile;
use crate::run::{ChoreError, root, run, run_with_timeout, target_folder};
use crate::setup::{EMULATOR, TARGET, target};
use controller::emulator::MACHINE;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// A processor core on a board of the emulator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EmulatedCore {
    /// Name of the board in the emulator; the memory map is `tests/target/images/boards/NAME.x`.
    pub(crate) board: &'static str,
    /// Name of the core.
    pub(crate) name: &'static str,
    /// Compilation target.
    pub(crate) target: &'static str,
}

/// Target of the newer cores. It has no FPU, because the kernels use integers only.
const WITHOUT_FPU: &str = "thumbv8m.main-none-eabi";

/// Core on which instructions are counted: that of the default controller.
pub(crate) const COUNTED: EmulatedCore = EmulatedCore { board: MACHINE, name: "Cortex-M4", target: TARGET };

/// Every core; the Cortex-M4 is there on two boards.
pub(crate) const CORES: [EmulatedCore; 5] = [
    COUNTED,
    EmulatedCore { board: "mps2-an386", name: "Cortex-M4", target: TARGET },
    EmulatedCore { board: "mps2-an500", name: "Cortex-M7", target: TARGET },
    EmulatedCore { board: "mps2-an505", name: "Cortex-M33", target: WITHOUT_FPU },
    EmulatedCore { board: "mps3-an547", name: "Cortex-M55", target: WITHOUT_FPU },
];

/// Timeout of an image. The slowest image takes two seconds.
const RUN_TIMEOUT: Duration = Duration::from_secs(900);

impl EmulatedCore {
    /// Returns true if images for this core are built for an FPU.
    pub(crate) fn has_fpu(&self) -> bool {
        self.target == TARGET
    }

    /// Builds one of the images in `tests/target/images` for this core.
    pub(crate) fn build(&self, image: &str) -> Result<PathBuf, ChoreError> {
        let toolchain = target(self.target)?;
        let mut command = compile::build(&toolchain, self.target, &root().join("tests/target/images"))?;
        // Not the workspace's folder: both have profiles of the same names with different settings.
        let folder = target_folder().join("on-target");
        command.args(["--quiet", "--locked", "--release", "--bin", image]);
        command.env("CARGO_TARGET_DIR", &folder).env("PINTLE_BOARD", self.board);
        if self.target == WITHOUT_FPU {
            command.args(["--features", "dsp"]);
        }
        if self.has_fpu() {
            command.args(["--features", "filter"]);
        }
        run(&mut command)?;
        Ok(folder.join(self.target).join("release").join(image))
    }

    /// Runs an image until it ends and returns its output.
    pub(crate) fn run(&self, image: &Path) -> Result<String, ChoreError> {
        self.run_with(image, &[])
    }

    /// Runs an image with more arguments of the emulator.
    pub(crate) fn run_with(&self, image: &Path, arguments: &[&str]) -> Result<String, ChoreError> {
        let mut command = Command::new(EMULATOR);
        command
            .args(["-M", self.board, "-display", "none", "-serial", "null", "-monitor", "none"])
            .args([
                "-semihosting-config",
                "enable=on,target=native",
                "-icount",
                "shift=6,sleep=off",
                "-kernel",
            ])
            .arg(image)
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::piped());
        run_with_timeout(&mut command, RUN_TIMEOUT)
    }
}
