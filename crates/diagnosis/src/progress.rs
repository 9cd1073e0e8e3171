//! Steps of a diagnosis as progress reports name them, with the share of the time that has passed
//! before each. The shares are rough: chosen by hand, not measured.

/// A step of a diagnosis.
#[derive(Clone, Copy)]
pub(crate) struct Step {
    /// Share done before the step, 0 to 1.
    pub(crate) share: f64,
    pub(crate) name: &'static str,
}

/// Checks of the logs.
pub(crate) const CHECK: Step = Step { share: 0.0, name: "checking the logs" };
/// Preparation of the logs and simulation of the described bench.
pub(crate) const PREPARE: Step = Step { share: 0.02, name: "reading the motion" };
/// Search for a first cause.
pub(crate) const FIRST_CAUSE: Step = Step { share: 0.1, name: "calibrating and ranking the effects" };
/// Search for a second cause.
pub(crate) const SECOND_CAUSE: Step = Step { share: 0.6, name: "searching for a second cause" };
/// Tests of the residual, and the verdict.
pub(crate) const VERDICT: Step = Step { share: 0.9, name: "testing the remaining residual" };
/// Share done before every step of the pass with interleaved hold-out.
pub(crate) const INTERLEAVED_SHARE: f64 = 0.95;
/// Share done before every step of the pass that selects pairs of causes.
pub(crate) const PAIR_SHARE: f64 = 0.97;
/// Search for causes beside an error that remains.
pub(crate) const PARTS: Step = Step { share: 0.98, name: "searching for causes beside the remaining error" };
/// End of the diagnosis.
pub(crate) const DONE: Step = Step { share: 1.0, name: "done" };
