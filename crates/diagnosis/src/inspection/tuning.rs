//! Tuned constants of the module `inspection`: limits of its computing time.

/// Samples of a transmission bench that are simulated for each parameter; the first cycle of each
/// log if there are more. Chosen by hand, so that a check of five cycles at 1 kHz takes about a
/// second on two cores.
pub(super) const MAX_EXPENSIVE_SAMPLES: usize = 1500;
/// Samples of an axis that are simulated for each parameter; the first cycle of each log if there
/// are more. Chosen by hand, not measured.
pub(super) const MAX_AXIS_SAMPLES: usize = 60_000;
/// Samples of all recordings of an experiment on a transmission bench, beyond which it is not
/// simulated. Chosen by hand, not measured.
pub(super) const MAX_EXPERIMENT_SAMPLES: usize = 4000;
