//! Tuned constants of the module `check`.
//!
//! Most limits lie between the effect of a change of the bench within its declared uncertainty and
//! the effect of a fault of the log. `cargo test -p diagnosis check::` checks both sides:
//! `clean_log_tests` that no clean log has a wrong channel, `tests` that every fault is found.
//!
//! "Half" and "double" state which of these tests notice another value: one constant was changed at
//! a time, by a factor of two. The three slowest tests, `clean_logs_*` and `a_load_far_*`, were not
//! part of that. A constant whose half and double pass is not critical in these logs, which does
//! not show that it is right in others.

use std::ops::Range;

/// Share of missing readings above which an output is left out. Chosen by hand; half and double
/// pass.
pub(crate) const MAX_MISSING_SHARE: f64 = 0.2;
/// Standard deviations of the neighbours' prediction above which a reading is an outlier. Chosen by
/// hand; double passes, half fails `a_rail_is_reported_and_left_to_the_diagnosis`.
pub(crate) const OUTLIER_SIGMAS: f64 = 10.0;
/// Standard deviations above which a reading may turn out to be an outlier once its neighbours are
/// removed. Chosen by hand; half and double pass.
pub(crate) const SUSPECT_SIGMAS: f64 = 0.5 * OUTLIER_SIGMAS;
/// Standard deviations above which another channel shows an event at the same time. Chosen by hand;
/// double passes, half fails `outliers_are_left_out_with_their_count`.
pub(crate) const COINCIDENCE_SIGMAS: f64 = 4.0;
/// Share of the readings above which suspects are the channel's behaviour and not outliers. Chosen
/// by hand; half and double pass.
pub(crate) const MAX_OUTLIER_SHARE: f64 = 0.02;
/// Largest number of outliers of a channel; it bounds the work. Chosen by hand, not measured.
pub(crate) const MAX_OUTLIERS: usize = 1000;
/// Suspects for each outlier that a channel may have, above which the suspects are its behaviour.
/// It bounds the work. Chosen by hand, not measured.
pub(crate) const SUSPECTS_PER_OUTLIER: usize = 10;
/// Longest run of isolated readings. Chosen by hand; half and double pass.
pub(crate) const MAX_OUTLIERS_IN_A_ROW: usize = 2;
/// Readings on either side that give the local scatter. Chosen by hand; half and double pass.
pub(crate) const NEIGHBOURHOOD_ROWS: usize = 25;
/// Readings on either side in which an impact of the simulation explains a jump: impacts occur a
/// little early or late. Chosen by hand; half and double pass.
pub(crate) const IMPACT_ROWS: usize = 25;
/// Readings on either side whose prediction is computed anew when a reading is removed. A
/// prediction uses the two good readings on either side, so it is more than enough unless several
/// outliers are close together. Chosen by hand; half and double pass.
pub(crate) const PREDICTION_REACH_ROWS: usize = 8;
/// Smallest scatter that an outlier is compared with, as a share of the channel's range. Chosen by
/// hand; half and double pass.
pub(crate) const MIN_OUTLIER_SHARE: f64 = 2e-4;
/// Ratio of the full range to that of the inner readings above which the full range is due to gross
/// errors. Chosen by hand; half and double pass.
pub(crate) const GROSS_RANGE: f64 = 10.0;
/// Divisor of the count of readings: one in so many at either end is not an inner reading. Chosen
/// by hand; half and double pass.
pub(crate) const OUTERMOST_DIVISOR: usize = 100;
/// Absolute value from which a number is a filler and no reading. The product of three smaller
/// numbers is finite.
pub(crate) const MAX_READING: f64 = 1e100;
/// Readings for each distinct value from which a resolution is looked for. Chosen by hand; half and
/// double pass.
pub(crate) const MIN_REPEATS: usize = 4;
/// Share of the range below which a difference of two readings is a rounding error and no step.
/// Chosen by hand; half and double pass.
pub(crate) const MIN_STEP_SHARE: f64 = 1e-9;
/// Fewest equal readings in a row that count as constant. Chosen by hand; half and double pass.
pub(crate) const MIN_RUN: usize = 8;
/// Noise floors that the simulation must move during such a run. Chosen by hand; half and double
/// pass.
pub(crate) const MOVED_SIGMAS: f64 = 8.0;
/// Fewest readings at the end of a channel's range that make it a rail. Chosen by hand; half and
/// double pass.
pub(crate) const MIN_RAIL_READINGS: usize = 5;
/// Fewest readings in a row at a rail. Chosen by hand; half and double pass.
pub(crate) const MIN_RAIL_RUN: usize = 3;
/// Fewest runs at a rail that show that the channel returns to it. Chosen by hand; half and double
/// pass.
pub(crate) const MIN_RAIL_RETURNS: usize = 3;
/// Share of the readings at a rail for which the simulation lies beyond it. Chosen by hand; half
/// and double pass.
pub(crate) const BEYOND_SHARE: f64 = 0.7;
/// The same share if the channel returns to the rail several times. Chosen by hand; half and double
/// pass.
pub(crate) const BEYOND_SHARE_REPEATED: f64 = 0.4;
/// Share of the readings at a rail for which the bench may lie inside it. Chosen by hand; half and
/// double pass.
pub(crate) const MAX_INSIDE_SHARE: f64 = 0.1;
/// Share of stuck readings above which a channel is left out. Chosen by hand; double passes, half
/// fails `gaps_and_coarse_readings_are_reported`.
pub(crate) const MAX_STUCK_SHARE: f64 = 0.05;
/// Resolution steps that the simulation must move during a run: within one step a coarse reading is
/// constant without a fault. Chosen by hand; double passes, half fails
/// `an_encoder_with_a_resolution_of_one_degree_is_coarse_and_not_stuck`.
pub(crate) const MOVED_STEPS: f64 = 1.5;
/// Smallest movement that counts, as a share of the simulated range. Chosen by hand; half passes,
/// double fails
/// `clipped_readings_are_saturated_and_readings_constant_while_the_bench_returns_are_stuck`.
pub(crate) const MIN_MOVED_SHARE: f64 = 0.02;
/// Relative rms residual of the relation from which two signals are unrelated. Chosen by hand; half
/// and double pass.
pub(crate) const MAX_UNRELATED: f64 = 0.2;
/// Deviation of the ratio of gains from 1 that two working sensors do not reach. Chosen by hand;
/// half and double pass.
pub(crate) const MAX_GAIN_ERROR: f64 = 0.1;
/// Logarithm of the factor of an input from which the finding is called a unit and not a gain: more
/// than a diameter taken for a radius. Chosen by hand; double passes, half fails
/// `factors_of_the_geometry_are_named_and_corrected`.
pub(crate) const MIN_LOG_UNIT_OF_INPUT: f64 = 1.0;
/// Deviation of the ratio of gains that is reported. Chosen by hand; half and double pass.
pub(crate) const DOUBTFUL_GAIN_ERROR: f64 = 0.03;
/// Relative tolerance of a factor that has a name. Derived: half the distance of the closest two of
/// bench B, the lever ratio 1.2 and 4/pi.
pub(crate) const NAMED_TOLERANCE: f64 = 0.03;
/// Relative difference of two factors that count as the same: rounding errors only.
pub(crate) const SAME_FACTOR_TOLERANCE: f64 = 1e-9;
/// Relative distance from an integer within which a scale is written as that integer: rounding
/// errors only.
pub(crate) const SCALE_ROUNDING: f64 = 1e-12;
/// Ratio to the described stroke within which a corrected stroke must lie. Chosen by hand; half and
/// double pass.
pub(crate) const MAX_STROKE_RATIO: f64 = 4.0;
/// Ratio to the described stroke from which a unit is suspected. Chosen by hand; half and double
/// pass.
pub(crate) const UNLIKELY_STROKE_RATIO: f64 = 12.0;
/// Delay between two inputs that is a contradiction, samples. Chosen by hand; half and double pass.
pub(crate) const MAX_DELAY_SAMPLES: f64 = 2.0;
/// Delay between two inputs that is a contradiction, s. Chosen by hand; half and double pass.
pub(crate) const MAX_DELAY_S: f64 = 2e-3;
/// Ratio of the smallest to the largest singular value below which offset and gain cannot be
/// separated. Chosen by hand; half and double pass.
pub(crate) const MIN_SINGULAR_RATIO: f64 = 1e-3;
/// Fewest rows between two gaps that a relation is fitted to. Chosen by hand; half and double pass.
pub(crate) const MIN_RUN_ROWS: usize = 32;
/// Largest number of sweeps of the singular value decomposition of a 3 x 3 matrix, which needs
/// about ten. It only ends the work on numbers that do not converge.
pub(crate) const MAX_SVD_SWEEPS: usize = 1000;
/// Share of rows with times out of order above which a log is refused. Chosen by hand; half and
/// double pass.
pub(crate) const MAX_LOST_SHARE: f64 = 0.1;
/// Interval between rows, in median intervals, from which rows are missing. Chosen by hand; half
/// and double pass.
pub(crate) const GAP_INTERVALS: f64 = 2.5;
/// Share of the median interval from which the scatter of the intervals is reported. Chosen by
/// hand; half and double pass.
pub(crate) const JITTER_SHARE: f64 = 0.05;
/// Largest ratio of the described to the recorded sample rate that needs no other clock unit.
/// Chosen by hand; half and double pass.
pub(crate) const MAX_RATE_RATIO: f64 = 5.0;
/// Ratio of the described to the recorded sample rate from which another clock unit is suspected.
/// Chosen by hand; half and double pass.
pub(crate) const SUSPECT_RATE_RATIO: f64 = 2.0 * MAX_RATE_RATIO;
/// Share of the mismatch that a corrected gain may leave: uncertain parameters cause the remainder.
/// Chosen by hand; double passes, half fails `factors_of_the_geometry_are_named_and_corrected`.
pub(crate) const MAX_LEFT_SHARE_GAIN: f64 = 0.5;
/// Relative tolerance of a gain against the described bench. Chosen by hand; half and double pass.
pub(crate) const GAIN_TOLERANCE: f64 = 0.1;
/// Smallest logarithm of a unit's factor: fourfold, more than any expected change of a bench.
/// Chosen by hand; half and double fail `factors_of_the_geometry_are_named_and_corrected` and
/// `units_are_named_and_corrected`.
pub(crate) const MIN_LOG_FACTOR: f64 = 1.4;
/// The same for friction efforts, which a description may miss by far: thirtyfold. Chosen by hand;
/// half passes, double fails `faults_of_a_friction_rig_are_named_too`.
pub(crate) const MIN_LOG_FACTOR_FRICTION: f64 = 3.5;
/// Mismatch from which a channel does not fit the described bench, and below which a corrected one
/// does. The test `clean_logs_have_no_wrong_channels` shows that changes of a bench stay below it.
/// Chosen by hand; half passes, double fails `faults_of_a_friction_rig_are_named_too`.
pub(crate) const MAX_MISMATCH: f64 = 0.5;
/// Share of the mismatch that an exact correction may leave. Chosen by hand; half and double pass.
pub(crate) const MAX_LEFT_SHARE: f64 = 0.4;
/// Mean mismatch of all outputs from which the load is suspected. Chosen by hand; half passes,
/// double fails `factors_of_the_geometry_are_named_and_corrected`.
pub(crate) const LOAD_MISMATCH: f64 = 0.1;
/// Share of that mismatch that another load may leave. Chosen by hand; double passes, half fails
/// `factors_of_the_geometry_are_named_and_corrected`.
pub(crate) const MAX_LEFT_SHARE_LOAD: f64 = 0.3;
/// Ratio to the described load above which no simulation is tried: it may take very long. Chosen by
/// hand; half and double pass.
pub(crate) const MAX_LOAD_RATIO: f64 = 50.0;
/// Described load, N, below which the ratio to it means nothing. Chosen by hand, not measured.
pub(crate) const MIN_LOAD_N: f64 = 1.0;
/// Factors of the load that are tried without regard to the described load: those of areas and
/// levers. Chosen by hand, not measured.
pub(crate) const GEOMETRY_FACTORS: Range<f64> = 0.2..5.0;
/// Smallest logarithm of the ratio by which the correction of any other factor must bring the load
/// nearer to the described one. Chosen by hand; half and double pass.
pub(crate) const MIN_LOG_APPROACH: f64 = 1.0;
/// Cycles of a log with which a factor of the load is tried; it bounds the work. Chosen by hand,
/// not measured.
pub(crate) const TRIAL_CYCLES: f64 = 2.0;
/// Scatter of a cubic prediction error in scatters of a reading. Derived: `sqrt(1 + 2 (4^2 +
/// 1)/36)`.
pub(crate) const PREDICTION_SIGMAS: f64 = 1.39;
/// Deviation of a difference from an integer multiple of the resolution, in resolutions. Chosen by
/// hand; half and double pass.
pub(crate) const STEP_TOLERANCE: f64 = 0.02;
/// Divisor of the count of differences: at most one in so many may be no integer multiple of the
/// resolution. Chosen by hand; half and double pass.
pub(crate) const OFF_GRID_DIVISOR: usize = 100;
/// Declared noise floors from which a resolution is reported as doubtful. Chosen by hand; half and
/// double pass.
pub(crate) const COARSE_STEPS: f64 = 4.0;
/// Noise floors by which a bench lies beyond or inside a rail. Chosen by hand, not measured.
pub(crate) const RAIL_SIGMAS: f64 = 4.0;
/// Fewest samples that are compared with the simulation. Chosen by hand, not measured.
pub(crate) const MIN_STEADY_SAMPLES: usize = 32;
/// Largest mismatch of one output in the mean of all. Chosen by hand, not measured.
pub(crate) const MAX_MISMATCH_COUNTED: f64 = 2.0;
/// Smallest logarithm of a geometry factor. Derived: above `ln(1 + GAIN_TOLERANCE)`, 0.095.
pub(crate) const MIN_LOG_GEOMETRY: f64 = 0.12;
/// Share of a log lost in gaps from which the finding is doubtful. Chosen by hand, not measured.
pub(crate) const DOUBTFUL_GAP_SHARE: f64 = 0.2;
/// Ratio within which position over integrated velocity must agree with a clock unit. Chosen by
/// hand, not measured.
pub(crate) const CLOCK_RATIO: f64 = 1.3;
/// Ratio within which a period must agree with the described one after a change of the clock unit.
/// Chosen by hand, not measured.
pub(crate) const CLOCK_PERIOD_RATIO: f64 = 10.0;
