//! Result of `host-sim accuracy --worlds`.

use super::goals::Verdict;
use super::score::Case;
use schemars::JsonSchema;
use serde::Serialize;

/// Result of `host-sim accuracy --worlds`, as printed and stored.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Outcome {
    pub(super) worlds: u32,
    pub(super) seed: u64,
    pub(super) goals: Vec<Verdict>,
    pub(super) cases: Vec<Case>,
}
