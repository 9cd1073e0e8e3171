//! The full matrix of hidden effects: the program of `tests`, built for speed.

use crate::run::{ChoreError, cargo, run};

/// Runs the program with what stands behind `hidden-effects`.
pub(crate) fn hidden_effects(arguments: &[String]) -> Result<(), ChoreError> {
    let program =
        ["run", "--quiet", "--release", "--package", "system-tests", "--bin", "hidden_effects", "--"];
    run(cargo().args(program).args(arguments))
}
