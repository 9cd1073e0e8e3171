//! Tuned constants of the module `experiment`. The changes that experiments make to a run are in
//! the menu itself ([`super::menu`]).

/// Share of the best experiment's separation at which a simpler experiment is preferred. Chosen by
/// hand, not measured.
pub(crate) const SIMPLER_SHARE: f64 = 0.8;
/// Separation, in chi-square, from which the simplest experiment is taken in any case. Chosen by
/// hand, not measured.
pub(crate) const AMPLE_SEPARATION: f64 = 200.0;
/// Read-back error, in chi-square per sample, above which an experiment is proposed only if no
/// other separates by more than [`CLEAR_SEPARATION`]: the simulation of its log would look wrong.
/// Chosen by hand, not measured.
pub(crate) const MAX_READ_BACK: f64 = 1.3;
/// Separation, in chi-square, from which two effects are clearly separated. Chosen by hand, not
/// measured.
pub(crate) const CLEAR_SEPARATION: f64 = 30.0;
/// Smallest separation worth a recording, in chi-square. Derived: a chi-square scatters by twice
/// its root, so nine times in ten 17 exceed the 6 within which candidates fit equally.
pub(crate) const MIN_SEPARATION: f64 = 17.0;
/// Cycles of a recording. Derived: one is fitted, one held out.
pub(crate) const CYCLES: u32 = 2;
/// Seed of the planned recording. Any constant: a plan is compared without its noise.
pub(crate) const SEED: u64 = 0;
