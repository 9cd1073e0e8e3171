//! Tuned constants of the module `search`: guesses, refits, selection.
//!
//! The thresholds were chosen by looking at the cells of seeds 1 to 7 of `cargo xtask
//! hidden-effects`. Seeds 8 to 100 of `docs/hidden-effects.md` are independent of that choice.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Step of a periodogram in units of its resolution. Derived: the power at a peak is underestimated
/// by 5 % at most.
pub(crate) const PERIODOGRAM_STEP: f64 = 0.25;
/// Largest number of wave numbers of a periodogram; it bounds the work. Chosen by hand, not
/// measured.
pub(crate) const MAX_WAVE_NUMBERS: f64 = 1e6;
/// Largest number of guesses of a frequency or wavelength. Chosen by hand, not measured.
pub(crate) const MAX_PEAKS: usize = 4;
/// Margin over the expected highest noise peak, `ln n`, in units of the noise power. Derived: a
/// chance of `exp(-7)`, about 0.001, for a peak in pure noise.
pub(crate) const PEAK_MARGIN: f64 = 7.0;
/// Times at which a step may begin. A fit moves an onset by little, so the guess must be near.
/// Chosen by hand, not measured.
pub(crate) const ONSET_BINS: usize = 2048;
/// First bin in which a step may begin, a hundredth of the log: the level before a step must be
/// known from more than the start transient. Chosen by hand, not measured.
pub(crate) const FIRST_ONSET_BIN: usize = 20;
/// Relative difference of evidence between onsets without a fitted sample in between: rounding
/// errors only. Chosen by hand, not measured.
pub(crate) const EQUAL_EVIDENCE: f64 = 1e-9;
/// Part of a log that the first periodogram covers, s; it bounds the work. Chosen by hand, not
/// measured.
pub(crate) const COARSE_WINDOW_S: f64 = 8.0;
/// Highest frequency of a periodogram, Hz. Chosen by hand, not measured.
pub(crate) const MAX_FREQUENCY_HZ: f64 = 200.0;
/// Samples of each channel that a periodogram over position uses; it bounds the work. Chosen by
/// hand, not measured.
pub(crate) const POSITION_SAMPLES: usize = 8000;
/// Most waves of a ripple over the range of the motion. Chosen by hand, not measured.
pub(crate) const MAX_WAVES: f64 = 100.0;
/// Fewest waves over the range of the motion: a slower ripple looks like a trend or the motion
/// itself. Chosen by hand, not measured.
pub(crate) const MIN_WAVES: f64 = 1.5;
/// Fewest periods of a ripple over time in a log: a slower ripple would imitate any other change
/// during the log. Chosen by hand, not measured.
pub(crate) const MIN_PERIODS: f64 = 3.0;
/// Step of the last periodogram around a frequency, in units of its resolution. The phase counts
/// from the clock's zero, so it needs a precise frequency. Chosen by hand, not measured.
pub(crate) const FINEST_FREQUENCY_STEP: f64 = 0.005;
/// Step of a guessed sensor limit as a share of the limit. Chosen by hand, not measured.
pub(crate) const LIMIT_STEP: f64 = 0.02;
/// Step of a guessed onset, s. Chosen by hand, not measured.
pub(crate) const ONSET_STEP_S: f64 = 0.02;
/// Largest step of a guessed onset as a share of the log. The step must reach across held-out
/// samples, where chi-square does not depend on the onset. Chosen by hand, not measured.
pub(crate) const MAX_ONSET_STEP_SHARE: f64 = 0.01;
/// Largest number of candidates that are refitted; it bounds the work. Chosen by hand, not
/// measured.
pub(crate) const MAX_REFITS: usize = 8;
/// Chi-square per sample from which a base is far from the noise, so that its sensitivities mean
/// little. Chosen by hand, not measured.
pub(crate) const FAR_CHI_SQUARE: f64 = 1.5;
/// Difference of chi-square on the first cycle from the best candidate within which a candidate is
/// fitted to all samples. Chosen by hand, not measured.
pub(crate) const NEAR_CHI_SQUARE: f64 = 400.0;
/// The same difference as a share of the best chi-square; the larger of the two counts. Chosen by
/// hand, not measured.
pub(crate) const NEAR_SHARE: f64 = 1.0;
/// Largest number of candidates that are fitted to all samples after the search; it bounds the
/// work. Chosen by hand, not measured.
pub(crate) const MAX_FULL_FITS: usize = 4;
/// Difference in BIC from the best rough fit within which a fit is taken to its optimum. Chosen by
/// hand, not measured.
pub(crate) const ROUGH_MARGIN: f64 = 60.0;
/// Share of the chi-square above the noise that is added to [`ROUGH_MARGIN`]. Chosen by hand, not
/// measured.
pub(crate) const ROUGH_SHARE: f64 = 0.3;
/// Largest number of searched candidates that are converged on the first cycle; it bounds the work.
/// Chosen by hand, not measured.
pub(crate) const MAX_CONVERGED_SEARCHES: usize = 5;
/// Smallest score that is worth a refit, in chi-square. Chosen by hand, not measured.
pub(crate) const MIN_SCORE: f64 = 4.0;
/// Share of the best score, less [`SCORE_MARGIN`], below which a candidate is eliminated. Chosen by
/// hand, not measured.
pub(crate) const MIN_SCORE_SHARE: f64 = 0.4;
/// Margin below that share, in chi-square. Chosen by hand, not measured.
pub(crate) const SCORE_MARGIN: f64 = 30.0;
/// Best score below which no candidate will be a cause. Derived: with four or more candidates the
/// family-wise threshold is at least 12.1.
pub(crate) const SMALL_SCORE: f64 = 12.0;
/// Largest number of candidates that are refitted in that case, for the ranking only. Chosen by
/// hand, not measured.
pub(crate) const MAX_REFITS_SMALL_SCORE: usize = 2;
/// Share of an effect's squared sensitivity that must survive the projection: rounding errors only.
/// Chosen by hand, not measured.
pub(crate) const MIN_SURVIVAL: f64 = 1e-13;
/// Chance that a log without any effect passes the threshold, shared by all candidates. Chosen by
/// hand; the clean logs of `cargo xtask hidden-effects` verify it.
pub(crate) const FAMILY_ERROR: f64 = 0.002;
/// Factor of change of a noise weight above which another round is run. Chosen by hand, not
/// measured.
pub(crate) const NOISE_TOLERANCE: f64 = 1.15;
/// Largest number of rounds of a stage. Chosen by hand, not measured.
pub(crate) const MAX_ROUNDS: usize = 4;
/// Fall of chi-square that shows that a base had stopped at a local minimum. Chosen by hand, not
/// measured.
pub(crate) const STUCK_MARGIN: f64 = 1.0;
/// Largest number of first causes beside which a second one is searched for; it bounds the work.
/// Chosen by hand, not measured.
pub(crate) const MAX_PAIR_FIRSTS: usize = 5;
/// Difference of BIC within which two candidates fit equally: odds of `exp(3)`, 20 to 1. Chosen by
/// hand, not measured.
pub(crate) const EQUIVALENT_BIC: f64 = 6.0;
/// Trial sizes of an effect in multiples of its scale: half decades up to the largest plausible
/// size. Chosen by hand, not measured.
pub(crate) const TRIAL_SIZES: [f64; 10] = [0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1e3, 3e3, 1e4];
/// Trial size, in multiples of the scale, from which on a size must be plausible to be tried.
/// Chosen by hand, not measured.
pub(crate) const LARGE_TRIAL: f64 = 100.0;
/// Standard deviations of its prior within which such a size is plausible. Chosen by hand, not
/// measured.
pub(crate) const PLAUSIBLE_DEVIATIONS: f64 = 2.0;
/// Factors on the best trial size that are tried too: oscillations out of phase have many local
/// minima. Chosen by hand, not measured.
pub(crate) const TRIAL_FACTORS: [f64; 4] = [0.6, 0.8, 1.25, 1.6];
/// Trial angles between two sizes of an effect, rad: quarters of a half turn. Chosen by hand, not
/// measured.
pub(crate) const TRIAL_TURNS_RAD: [f64; 3] = [FRAC_PI_4, FRAC_PI_2, 3.0 * FRAC_PI_4];
/// Factor on the prior precision of declared parameters that keeps them in place: they move by a
/// hundred-millionth. Chosen by hand, not measured.
pub(crate) const DECLARED_STIFFNESS: f64 = 1e8;
/// Share of a step's squared sensitivity that must survive the projection: rounding errors only.
/// Chosen by hand, not measured.
pub(crate) const MIN_ONSET_SURVIVAL: f64 = 1e-9;
/// Highest frequency of a periodogram in sample rates: a tenth below the Nyquist frequency. Chosen
/// by hand, not measured.
pub(crate) const NYQUIST_SHARE: f64 = 0.45;
/// Step of a guessed frequency or wave number in units of its resolution. Chosen by hand, not
/// measured.
pub(crate) const SHAPE_STEP: f64 = 0.1;
/// Largest number of causes that are named beside an error that remains. Chosen by hand, not
/// measured.
pub(crate) const MAX_PARTS: usize = 6;
/// Largest number of stages in which causes are compared in each other's place; it bounds the work.
/// Chosen by hand, not measured.
pub(crate) const MAX_PART_STAGES: usize = 24;
/// Share of a log that lies before an onset at least, if it is less than a cycle or the log has
/// none. Chosen by hand, not measured.
pub(crate) const ONSET_MARGIN_SHARE: f64 = 0.2;
/// Multiples of the motion's own frequency at which a pulsation would imitate an effect of the
/// motion. Chosen by hand, not measured.
pub(crate) const MOTION_HARMONICS: f64 = 5.0;
/// Largest number of contenders that are dropped for the next one; it bounds the work. Chosen by
/// hand, not measured.
pub(crate) const MAX_FALLBACKS: usize = 4;
