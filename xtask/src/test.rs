//! Every test there is.

use crate::run::{ChoreError, cargo, run, succeeds};
use crate::{firmware, setup};

/// Sets up, builds the images, checks the format where rustfmt is there, and compares kernels and instruction counts on the
/// emulated cores, and runs the tests with the emulated ones.
pub(crate) fn test() -> Result<(), ChoreError> {
    setup::setup()?;
    firmware::OTHER_CORE.build()?;
    firmware::DEFAULT.build_provoking()?;
    firmware::DEFAULT.build()?;
    if succeeds(cargo().args(["fmt", "--version"])) {
        run(cargo().args(["fmt", "--all", "--check"]))?;
    }
    crate::kernels::kernels()?;
    crate::verify::verify()?;
    crate::golden::check()?;
    crate::budget::check()?;
    run(cargo().args(["test", "--workspace", "--no-fail-fast", "--features", "system-tests/emulated"]))?;
    // By itself: the probe's library takes longer to build than all the rest of `host-sim`.
    run(cargo().args(["test", "--package", "host-sim", "--features", "fake-probe", "--test", "fake_probe"]))
}
