//! Tuned constants of the module `data`: split of the samples, noise, cycles, bins.

/// Time skipped after the load ramp of a transmission-bench log, s: the journal lands in this time.
/// Chosen by hand, not measured.
pub(crate) const START_MARGIN_S: f64 = 0.010;
/// Time skipped at the end of a transmission-bench log, s: the drive is smoothed from one side
/// there. Derived: half the window over which `bench::simulate` smooths the drive.
pub(crate) const END_MARGIN_S: f64 = 0.010;
/// Blocks of a log without two cycles; every second one is held out. Chosen by hand, not measured.
pub(crate) const BLOCKS_WITHOUT_CYCLES: usize = 16;
/// Interleaved blocks of a cycle. Odd, so that a phase of the motion that is fitted in one cycle is
/// held out in the next. An onset in a held-out block is known to one block: 0.1 s of a cycle of 4
/// s. Chosen by hand, not measured.
pub(crate) const BLOCKS_PER_CYCLE: f64 = 41.0;
/// Fewest samples of an interleaved block, several times the correlation of a sensor's noise.
/// Chosen by hand, not measured.
pub(crate) const MIN_BLOCK_SAMPLES: f64 = 16.0;
/// Part of a cycle that may be missing of a complete one, in cycles. Chosen by hand, not measured.
pub(crate) const MISSING_CYCLE_SHARE: f64 = 0.05;
/// Divisor of a held-out log without two cycles: its first eighth calibrates the log's nuisance
/// parameters. Chosen by hand, not measured.
pub(crate) const CALIBRATION_DIVISOR: usize = 8;
/// White noise over declared noise above which the declaration is not believed. Chosen by hand, not
/// measured.
pub(crate) const MAX_WHITE_OVER_DECLARED: f64 = 1.15;
/// Observed over declared noise below which the report mentions the declaration. Chosen by hand,
/// not measured.
pub(crate) const MIN_OBSERVED_OVER_DECLARED: f64 = 0.5;
/// Observed over declared noise above which the report mentions the declaration. Chosen by hand,
/// not measured.
pub(crate) const MAX_OBSERVED_OVER_DECLARED: f64 = 1.5;
/// Realisations of the input's noise from which its share of an output is computed. Chosen by hand,
/// not measured.
pub(crate) const INPUT_NOISES: u64 = 6;
/// Noise that an output has from the input, as a share of its sensor's, above which its noise
/// counts as correlated. Chosen by hand, not measured.
pub(crate) const MIN_INPUT_SHARE: f64 = 0.1;
/// Smallest noise floor as a share of the largest reading; it only excludes a floor of 0. Chosen by
/// hand, not measured.
pub(crate) const MIN_FLOOR_SHARE: f64 = 1e-9;
/// Longest correlation of a sensor's own noise, samples; a longer one is model error. Chosen by
/// hand, not measured.
pub(crate) const MAX_SENSOR_CORRELATION_SAMPLES: f64 = 16.0;
/// Largest lag of the autocorrelation as a share of a run of samples. Chosen by hand, not measured.
pub(crate) const MAX_LAG_SHARE: f64 = 0.25;
/// Fewest complete cycles that separate the repeatable part from noise. Derived: the lower quartile
/// needs two differences of neighbours.
pub(crate) const MIN_CYCLES: i64 = 3;
/// Fewest samples of a cycle; with fewer a residual has no shape. Chosen by hand, not measured.
pub(crate) const MIN_POINTS_PER_CYCLE: usize = 8;
/// Share of the points of a cycle that two cycles must have in common. Chosen by hand, not
/// measured.
pub(crate) const MIN_COMMON_SHARE: f64 = 0.5;
/// Hysteresis of the cycle counter as a share of the motion's range. Chosen by hand, not measured.
pub(crate) const CYCLE_HYSTERESIS: f64 = 0.2;
/// Fewest samples of a log after the start transient. Chosen by hand, not measured.
pub(crate) const MIN_USED_SAMPLES: usize = 32;
/// Standard deviations of an rms, `1/sqrt(2 n)` each, below which an excess over the floor is
/// chance. Chosen by hand, not measured.
pub(crate) const RMS_SIGMAS: f64 = 3.0;
/// Standard deviations of an autocorrelation, `1/sqrt(n)` each, below which the sum over lags ends.
/// Chosen by hand, not measured.
pub(crate) const RHO_SIGMAS: f64 = 2.5;
/// Smallest relative range over which a feature is divided into bins; below it the feature is
/// constant. Chosen by hand, not measured.
pub(crate) const MIN_FEATURE_SPAN: f64 = 1e-3;
/// Bins of the load. Chosen by hand, not measured.
pub(crate) const LOAD_BINS: usize = 4;
/// Bins of the speed, the position, and the load times the direction. Chosen by hand, not measured.
pub(crate) const MOTION_BINS: usize = 8;
/// Bins of the time. Chosen by hand, not measured.
pub(crate) const TIME_BINS: usize = 12;
/// Bins of the cycle phase. Chosen by hand, not measured.
pub(crate) const PHASE_BINS: usize = 24;
