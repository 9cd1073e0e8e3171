//! Tuned constants of the module `verdict`: acceptance, remaining structure, probabilities.
//!
//! The thresholds were chosen by looking at the cells of seeds 1 to 7 of `cargo xtask
//! hidden-effects`. Seeds 8 to 100 of `docs/hidden-effects.md` are independent of that choice.

use crate::search::tuning::FAMILY_ERROR;

/// Probability of an unknown cause, at least, where the rules of acceptance reject the causes.
/// Chosen by hand, not measured.
pub(crate) const MIN_UNKNOWN_PROBABILITY: f64 = 0.5;
/// Time constants after which an effect has settled to 5 %. Derived: `exp(-3)`.
pub(crate) const SETTLED_TIME_CONSTANTS: f64 = 3.0;
/// Share of a sensor limit from which on a reading reaches it. Chosen by hand, not measured.
pub(crate) const LIMIT_REACHED_SHARE: f64 = 0.99;
/// Share of the repeatable held-out residual that causes must explain if structure remains. Chosen
/// by hand, not measured.
pub(crate) const MAIN_SHARE: f64 = 0.75;
/// Least upper end of that share's 95 % interval. Set with `cargo xtask hidden-effects --quick` on
/// the driven axes: if the true effect was removed from the catalogue, wrong names fell from .43 to
/// .24 of the cells.
pub(crate) const MAIN_SHARE_UPPER: f64 = 0.9;
/// Least upper end of the share's 95 % interval if no structure remains. Set with `cargo xtask
/// hidden-effects --quick`: effects similar to a removed one were named at shares down to .35. The
/// true causes below this limit are slow ones that only interleaved hold-out names.
pub(crate) const FULL_SHARE_UPPER: f64 = 0.95;
/// Chance that a true cause appears inconsistent, shared by all tests of a model: that of the
/// search.
pub(crate) const INCONSISTENCY_FAMILY_ERROR: f64 = FAMILY_ERROR;
/// Share of a cause's fall of chi-square below which an inconsistency is negligible. In `cargo
/// xtask hidden-effects`, an effect that imitates a removed one explains .9 to .97 of the residual,
/// so .03 separates it from the true one.
pub(crate) const MIN_INCONSISTENCY_SHARE: f64 = 0.03;
/// Share of the largest information from which a direction counts: rounding errors only. Chosen by
/// hand, not measured.
pub(crate) const MIN_EIGENVALUE: f64 = 1e-6;
/// Largest correlation of neighbouring samples that counts as noise; it limits the inflation to 19.
/// Chosen by hand, not measured.
pub(crate) const MAX_NEIGHBOUR_CORRELATION: f64 = 0.9;
/// Declared deviations beyond which a declared number is out of tolerance. Chosen by hand, not
/// measured: one correct declaration in 370 is exceeded.
pub(crate) const MAX_TOLERATED: f64 = 3.0;
/// Least posterior probability of a declared number that is out of tolerance. Chosen by hand, not
/// measured.
pub(crate) const MIN_BEYOND: f64 = 0.8;
/// Share of the noise floor up to which the change of a channel is immaterial. Chosen by hand, not
/// measured.
pub(crate) const MATERIAL_SHARE: f64 = 0.05;
/// Change of the explained share that changes the odds of an unknown cause by a factor of e. With
/// .9 explained, unknown has a probability of .05. Chosen by hand, not measured.
pub(crate) const SHARE_WIDTH: f64 = 0.05;
/// Largest odds of an unknown cause if no structure remains: structure that the tests overlook is
/// negligible. Chosen by hand, not measured.
pub(crate) const MAX_UNSEEN_ODDS: f64 = 0.05;
/// Bins of the free-form model of a channel. Chosen by hand, not measured.
pub(crate) const FREE_FORM_BINS: usize = 24;
/// Change of chi-square over one prior standard deviation below which the logs do not show a
/// parameter. Chosen by hand, not measured.
pub(crate) const DEAD_CHI_SQUARE: f64 = 0.01;
/// Share of its prior's standard deviation above which an estimate comes from the prior and not
/// from the logs. Chosen by hand, not measured.
pub(crate) const PRIOR_SHARE: f64 = 0.9;
/// Absolute correlation of two estimates above which only a combination is known. Chosen by hand,
/// not measured.
pub(crate) const MAX_CORRELATION: f64 = 0.95;
/// Share of a prior's standard deviation below which a declared parameter is known well enough for
/// a diagnosis, though it correlates with another one. Chosen by hand, not measured.
pub(crate) const INSEPARABLE_SHARE: f64 = 0.1;
/// Eigenvalue of the information in prior units below which a direction is flat. Chosen by hand,
/// not measured.
pub(crate) const FLAT_EIGENVALUE: f64 = 0.1;
/// Change of chi-square below which the opposite sign fits as well: two standard deviations. Chosen
/// by hand, not measured.
pub(crate) const SIGN_CHI_SQUARE: f64 = 4.0;
/// Component of a unit vector from which a parameter is named as part of a flat direction. Chosen
/// by hand, not measured.
pub(crate) const NAMED_COMPONENT: f64 = 0.25;
/// Rms of structure, in units of the noise, below which it is negligible. Chosen by hand, not
/// measured.
pub(crate) const MIN_STRUCTURE_RMS: f64 = 0.2;
/// Rms of a residual over the declared noise above which it is more than noise; a declaration may
/// be wrong by as much. Chosen by hand, not measured.
pub(crate) const MAX_RMS_OVER_DECLARED: f64 = 1.2;
/// Chance that a log without model error shows structure, shared by channels and tests: that of the
/// search.
pub(crate) const STRUCTURE_FAMILY_ERROR: f64 = FAMILY_ERROR;
/// Most bins of a cycle. Chosen by hand, not measured.
pub(crate) const MAX_PHASE_BINS: usize = 24;
/// Fewest bins of a cycle. Chosen by hand, not measured.
pub(crate) const MIN_PHASE_BINS: usize = 4;
/// Blocks of a log without cycles. Chosen by hand, not measured.
pub(crate) const DRIFT_BLOCKS: usize = 48;
/// Share of the best feature's explained power at which a simpler feature is preferred. Chosen by
/// hand, not measured.
pub(crate) const SIMPLER_FEATURE_SHARE: f64 = 0.85;
/// Least upper end of the explained share's 95 % interval for a pair of causes that was selected
/// against the noise floor. Two causes imitate what one cannot, so it is stricter than
/// [`FULL_SHARE_UPPER`]. With `cargo xtask hidden-effects` and pairs, both of two hidden effects
/// are named in .86 of the cells (without: .62); other values were not tried.
pub(crate) const PAIR_SHARE_UPPER: f64 = 0.985;
/// Correlation times of the noise in a bin of a cycle, so that bins are independent. Chosen by
/// hand, not measured.
pub(crate) const BIN_CORRELATION_TIMES: f64 = 4.0;
/// Share of its samples that a bin of a cycle must have. Chosen by hand, not measured.
pub(crate) const MIN_BIN_FILL: f64 = 0.6;
/// Share of the fullest cycle or block that another one must have. Chosen by hand, not measured.
pub(crate) const MIN_BLOCK_FILL: f64 = 0.8;
/// Share by which the held-out error rises at least if one of several causes is left out; less is
/// not worth a name. Chosen by hand, not measured.
pub(crate) const MIN_PART_RISE: f64 = 0.05;
