//! The emulated boards that the kernels run on, and running an image on one of them.

use crate::compile;
use crate::run::{ChoreError, root, run, run_for, target_folder};
use crate::setup::{EMULATOR, TARGET, target};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// A board of the emulator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Board {
    /// The emulator's name for it; the memory map is `tests/target/images/boards/NAME.x`.
    pub(crate) name: &'static str,
    /// The core.
    pub(crate) core: &'static str,
    /// The compiler's target.
    pub(crate) target: &'static str,
}

/// Cores with an FPU of their own are not needed: everything is whole numbers.
const SOFT: &str = "thumbv8m.main-none-eabi";

/// The board that instructions are counted on: its clock is the estimator's.
pub(crate) const COUNTED: Board = Board { name: "netduinoplus2", core: "Cortex-M4", target: TARGET };

/// Every board, one for each core and two for the M4.
pub(crate) const BOARDS: [Board; 5] = [
    COUNTED,
    Board { name: "mps2-an386", core: "Cortex-M4", target: TARGET },
    Board { name: "mps2-an500", core: "Cortex-M7", target: TARGET },
    Board { name: "mps2-an505", core: "Cortex-M33", target: SOFT },
    Board { name: "mps3-an547", core: "Cortex-M55", target: SOFT },
];

/// Longest run of an image; the longest takes two seconds.
const LONGEST: Duration = Duration::from_secs(120);

impl Board {
    /// Builds one of the images in `tests/target/images` for this board.
    pub(crate) fn build(&self, image: &str) -> Result<PathBuf, ChoreError> {
        let way = target(self.target)?;
        let mut command = compile::build(&way, self.target, &root().join("tests/target/images"))?;
        // Another folder than the workspace's: the two have different profiles of the same names.
        let folder = target_folder().join("on-target");
        command.args(["--quiet", "--locked", "--release", "--bin", image]);
        command.env("CARGO_TARGET_DIR", &folder).env("PINTLE_BOARD", self.name);
        if self.target == SOFT {
            command.args(["--features", "dsp"]);
        }
        run(&mut command)?;
        Ok(folder.join(self.target).join("release").join(image))
    }

    /// Runs an image to its end and takes what it printed.
    pub(crate) fn run(&self, image: &Path) -> Result<String, ChoreError> {
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
            .stdin(Stdio::null())
            .stdout(Stdio::piped());
        run_for(&mut command, LONGEST)
    }
}
