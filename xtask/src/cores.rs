//! Emulated boards that the kernels run on, and the way to run an image on one of them.

use crate::compile;
use crate::run::{ChoreError, root, run, run_with_timeout, target_folder};
use crate::setup::{EMULATOR, TARGET, target};
use controller::emulator::MACHINE;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// A board of the emulator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Board {
    /// Name of the board in the emulator; the memory map is `tests/target/images/boards/NAME.x`.
    pub(crate) name: &'static str,
    /// Processor core.
    pub(crate) core: &'static str,
    /// Compilation target.
    pub(crate) target: &'static str,
}

/// Target of the newer cores. It has no FPU, because the kernels use integers only.
const WITHOUT_FPU: &str = "thumbv8m.main-none-eabi";

/// Board on which instructions are counted: it has the core of the default controller.
pub(crate) const COUNTED: Board = Board { name: MACHINE, core: "Cortex-M4", target: TARGET };

/// Every board: one for each core, and two for the Cortex-M4.
pub(crate) const BOARDS: [Board; 5] = [
    COUNTED,
    Board { name: "mps2-an386", core: "Cortex-M4", target: TARGET },
    Board { name: "mps2-an500", core: "Cortex-M7", target: TARGET },
    Board { name: "mps2-an505", core: "Cortex-M33", target: WITHOUT_FPU },
    Board { name: "mps3-an547", core: "Cortex-M55", target: WITHOUT_FPU },
];

/// Timeout of an image. The slowest image takes two seconds.
const RUN_TIMEOUT: Duration = Duration::from_secs(900);

impl Board {
    /// Returns true if images for this board are built for an FPU.
    pub(crate) fn has_fpu(&self) -> bool {
        self.target == TARGET
    }

    /// Builds one of the images in `tests/target/images` for this board.
    pub(crate) fn build(&self, image: &str) -> Result<PathBuf, ChoreError> {
        let toolchain = target(self.target)?;
        let mut command = compile::build(&toolchain, self.target, &root().join("tests/target/images"))?;
        // Not the workspace's folder: both have profiles of the same names with different settings.
        let folder = target_folder().join("on-target");
        command.args(["--quiet", "--locked", "--release", "--bin", image]);
        command.env("CARGO_TARGET_DIR", &folder).env("PINTLE_BOARD", self.name);
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
            .args(["-M", self.name, "-display", "none", "-serial", "null", "-monitor", "none"])
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
