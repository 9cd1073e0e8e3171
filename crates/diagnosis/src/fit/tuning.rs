//! Tuned constants of the module `fit`: steps, trust region, intervals.

/// Share of its scale below which a one-sided effect counts as absent: a nearly rigid shaft or oil
/// column would only slow the simulation. Chosen by hand, not measured.
pub(crate) const ABSENT_SHARE: f64 = 0.02;
/// Finite-difference step of a declared parameter, in its standard deviations: large against the
/// integrator's error of nanometres, small against the curvature of the response. Chosen by hand,
/// not measured.
pub(crate) const DECLARED_STEP: f64 = 0.03;
/// Finite-difference step of an effect's parameter, in its scale. Chosen by hand, not measured.
pub(crate) const EFFECT_STEP: f64 = 0.1;
/// Distance from a bound, in scaled units, that counts as on the bound: rounding errors only.
/// Chosen by hand, not measured.
pub(crate) const BOUND_TOLERANCE: f64 = 1e-6;
/// Smallest share of its described value that a positive parameter may fall to. Chosen by hand, not
/// measured.
pub(crate) const MIN_POSITIVE_SHARE: f64 = 0.1;
/// Declared standard deviations that calibration may move a parameter. A larger deviation is a
/// finding. Part of the documented contract (`docs/diagnosis.md`, `docs/hidden-effects.md`). Chosen
/// by hand, not measured.
pub(crate) const MAX_DEVIATIONS: f64 = 4.0;
/// Standard deviation of an offset in units of the sensor's resolution. Derived: `1/sqrt(3)`, that
/// of a value spread evenly over one resolution to either side.
pub(crate) const OFFSET_SHARE: f64 = 0.577;
/// Prior precision of a guessed shape: a standard deviation of 100 of its steps. Without a prior,
/// an onset between two samples would have no defined place. Chosen by hand, not measured.
pub(crate) const GUESS_PRECISION: f64 = 1e-4;
/// Newton iterations along an alias. The value is nearly linear, so three or four suffice. Chosen
/// by hand, not measured.
pub(crate) const ALIAS_ITERATIONS: usize = 6;
/// Relative difference of two values that count as the same: rounding errors only. Chosen by hand,
/// not measured.
pub(crate) const ALIAS_TOLERANCE: f64 = 1e-12;
/// Length of a sandwich block in correlation times, so that blocks are independent. Chosen by hand,
/// not measured.
pub(crate) const BLOCK_CORRELATION_TIMES: f64 = 8.0;
/// Largest number of sandwich blocks of a log. Chosen by hand, not measured.
pub(crate) const MAX_BLOCKS_PER_LOG: usize = 64;
/// Fewest sandwich blocks; with fewer the sandwich scatters too much. Chosen by hand, not measured.
pub(crate) const MIN_BLOCKS: usize = 8;
/// Fewest logs, or cycles, between which a variance is estimated: with two, Student's factor is
/// 6.5. Chosen by hand, not measured.
pub(crate) const MIN_GROUPS: usize = 3;
/// Level of the test whether groups differ by more than the sensor noise: the conventional one.
/// Without the test, intervals from three logs would nearly always be 2.7 times too wide: Student's
/// factor, 2.2, times `sqrt(3/2)`.
pub(crate) const GROUP_TEST_LEVEL: f64 = 0.05;
/// First radius of the trust region, in scaled units (standard deviations of what is declared).
/// Chosen by hand, not measured.
pub(crate) const INITIAL_RADIUS: f64 = 2.0;
/// Radius that ends a fit, in scaled units. Chosen by hand, not measured.
pub(crate) const MIN_RADIUS: f64 = 1e-4;
/// Predicted fall of chi-square that ends a fit: far below the 6 that separate candidates. Chosen
/// by hand, not measured.
pub(crate) const MIN_FALL: f64 = 0.02;
/// The same as a share of the chi-square above the noise; the larger of the two ends a fit. Chosen
/// by hand, not measured.
pub(crate) const MIN_FALL_SHARE: f64 = 3e-4;
/// Factor on the information of a parameter at its bound, so that it absorbs a ten-thousandth of an
/// added effect. Chosen by hand, not measured.
pub(crate) const BOUND_STIFFNESS: f64 = 1e4;
/// Draws of the block bootstrap: 12 of them are in the 2.5 % tail. Chosen by hand, not measured.
pub(crate) const BOOTSTRAP_DRAWS: usize = 500;
/// Seed of the block bootstrap. Any constant, so that every run gives the same interval.
pub(crate) const BOOTSTRAP_SEED: u64 = 0x50_49_4e_54;
/// Bootstrap blocks of a cycle for the explained share. A block is a period of time, whatever
/// fitted samples lie in it. Chosen by hand, not measured.
pub(crate) const GAIN_BLOCKS_PER_CYCLE: f64 = 8.0;
/// Bootstrap blocks of a cycle for the test whether the error falls. An effect may act in an eighth
/// of a cycle, and many draws of eight blocks would miss it. Chosen by hand, not measured.
pub(crate) const IMPROVEMENT_BLOCKS_PER_CYCLE: f64 = 32.0;
/// Fewest samples of a bootstrap block. Chosen by hand, not measured.
pub(crate) const MIN_BLOCK_SAMPLES: usize = 8;
/// Standard deviations of the noise power, `sqrt(2/n)` each, below which the power above the noise
/// has no share. Chosen by hand, not measured.
pub(crate) const MIN_POWER_SIGMAS: f64 = 3.0;
/// Ratio of achieved to predicted fall of chi-square above which a step is accepted: a usual value
/// of trust-region methods.
pub(crate) const MIN_GAIN_RATIO: f64 = 1e-3;
/// Ratio of achieved to predicted fall below which the sensitivities are computed anew. Chosen by
/// hand, not measured.
pub(crate) const RENEW_RATIO: f64 = 0.5;
/// Ratio of achieved to predicted fall above which the trust region grows: a usual value of
/// trust-region methods.
pub(crate) const GROW_RATIO: f64 = 0.75;
/// Length of a step, in radii, from which on the trust region limits it and may grow. Chosen by
/// hand, not measured.
pub(crate) const GROW_LENGTH: f64 = 0.8;
/// Growth of the trust region. Chosen by hand, not measured.
pub(crate) const GROW_FACTOR: f64 = 3.0;
/// Ratio of achieved to predicted fall below which the trust region shrinks: a usual value of
/// trust-region methods.
pub(crate) const SHRINK_RATIO: f64 = 0.25;
/// Radius after a poor accepted step, in lengths of the step. Chosen by hand, not measured.
pub(crate) const SHRINK_FACTOR: f64 = 0.4;
/// Radius after a rejected step, in lengths of the step: a usual value of trust-region methods.
pub(crate) const REJECT_FACTOR: f64 = 0.25;
/// Factor on the radius if outdated sensitivities fail and no fresh ones are allowed. Chosen by
/// hand, not measured.
pub(crate) const STALE_FACTOR: f64 = 0.5;
/// Standard deviations of a normal distribution on either side of a 95 % interval. Derived.
pub(crate) const Z_95: f64 = 1.96;
/// Probability beyond either end of a 95 % interval. Derived.
pub(crate) const TAIL_95: f64 = 0.025;
/// Level of the test whether the error on held-out samples falls: the conventional one.
pub(crate) const IMPROVEMENT_LEVEL: f64 = 0.05;
/// Largest number of steps of a fit to the optimum; it bounds the work. Chosen by hand, not
/// measured.
pub(crate) const FULL_ITERATIONS: usize = 40;
/// Largest number of sets of sensitivities of a fit to the optimum; it bounds the work. Chosen by
/// hand, not measured.
pub(crate) const FULL_JACOBIANS: usize = 12;
/// Largest number of steps of a limited fit; it bounds the work. Chosen by hand, not measured.
pub(crate) const LIMITED_ITERATIONS: usize = 24;
/// Largest number of sets of sensitivities of a limited fit; it bounds the work. Chosen by hand,
/// not measured.
pub(crate) const LIMITED_JACOBIANS: usize = 4;
/// Largest number of steps of a rough fit; it bounds the work. Chosen by hand, not measured.
pub(crate) const ROUGH_ITERATIONS: usize = 10;
/// Distance beyond a bound, in scaled units, that a step may end: rounding errors only. Chosen by
/// hand, not measured.
pub(crate) const STEP_ROUNDING: f64 = 1e-12;
/// Largest number of bisections of the damping. It only ends the loop: [`DAMPING_STEP`],
/// [`MIN_DAMPING`] and [`DAMPING_RATIO`] need about 12.
pub(crate) const MAX_DAMPING_STEPS: usize = 60;
/// Factor on the damping while no lower bound of it is known. Chosen by hand, not measured.
pub(crate) const DAMPING_STEP: f64 = 1e-4;
/// Damping, as a share of the gradient's norm, below which it has no effect: rounding errors only.
/// Chosen by hand, not measured.
pub(crate) const MIN_DAMPING: f64 = 1e-12;
/// Ratio of the bounds of the damping that ends the bisection: the length of a step is then within
/// about 5 % of the radius. Chosen by hand, not measured.
pub(crate) const DAMPING_RATIO: f64 = 1.05;
/// Ridges, as powers of ten of the largest diagonal element, that are tried on a singular matrix,
/// from rounding errors on. Chosen by hand, not measured.
pub(crate) const RIDGE_EXPONENTS: [i32; 4] = [-13, -11, -9, -7];
/// Share of the log's effort by which mass and friction may be negative: their estimate scatters
/// about 0 where a bench has none. Chosen by hand, not measured.
pub(crate) const NEGATIVE_SHARE: f64 = 0.01;
