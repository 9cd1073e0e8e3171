//! Random draws that depend on (seed, purpose, index) alone.
//!
//! Every row, chunk or epoch has a separate ChaCha stream, so a result does not depend on how the
//! work was divided over threads. Transforms use `libm`, so a draw is the same on every machine.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Purpose of a stream. The numbers are part of the recipe and must not change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Rows of the training set.
    TrainingRows = 1,
    /// Rows of the validation set, used during training.
    ValidationRows = 2,
    /// Rows for calibration of the activations' ranges.
    CalibrationRows = 3,
    /// Rows of the test set, never seen in training.
    TestRows = 4,
    /// Histories of the training windows.
    Histories = 5,
    /// Histories of the windows of the other sets.
    FixedHistories = 6,
    /// Initial weights.
    Weights = 7,
    /// Order of the rows in an epoch.
    Order = 8,
    /// Windows that other runtimes are compared on.
    PeerWindows = 9,
    /// Values of the axes of a data set.
    DatasetAxes = 10,
    /// Order of the rows of a data set.
    DatasetOrder = 11,
    /// Assignment of groups or runs to training, validation and test.
    DatasetSplit = 12,
    /// Samples that are taken from a group.
    DatasetSamples = 13,
}

/// Set of windows with fixed histories; each set has its own stream of
/// [`Purpose::FixedHistories`]. The numbers are part of the recipe and must not change. Validation
/// has the number 0, which the number of the training's stream precedes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HistorySet {
    /// Calibration of the activations' ranges.
    Calibration = 1,
    /// Test set.
    Test = 2,
    /// Data set in three parts.
    Dataset = 3,
}

/// Stream of random numbers.
#[derive(Clone, Debug)]
pub struct Draw(ChaCha8Rng);

impl Draw {
    /// Opens the stream of an index.
    pub fn new(seed: u64, purpose: Purpose, index: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream((purpose as u64) << 48 | index);
        Self(rng)
    }

    /// Opens the stream of the history of a row.
    pub(crate) fn history(seed: u64, set: HistorySet, row: u64) -> Self {
        Self::new(seed, Purpose::FixedHistories, (set as u64) << 32 | row)
    }

    /// Uniform in 0..1, 53 bits.
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / 9_007_199_254_740_992.0
    }

    /// Uniform in `low..high`.
    pub(crate) fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Log-uniform in `low..high`, both above 0.
    pub(crate) fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        libm::exp(self.uniform(libm::log(low), libm::log(high)))
    }

    /// Exponential with a mean of `high / 5`, truncated to `0..high`.
    pub(crate) fn truncated_exponential(&mut self, high: f64) -> f64 {
        let share_below_high = 1.0 - libm::exp(-5.0);
        -high / 5.0 * libm::log(1.0 - share_below_high * self.unit())
    }

    /// Exponential with a mean of 1.
    pub(crate) fn exponential(&mut self) -> f64 {
        -libm::log(1.0 - self.unit())
    }

    /// Standard normal (Box and Muller). Another generator would change every trained weight.
    pub fn normal(&mut self) -> f64 {
        libm::sqrt(2.0 * self.exponential()) * libm::cos(core::f64::consts::TAU * self.unit())
    }

    /// -1 or 1.
    pub(crate) fn sign(&mut self) -> f64 {
        if self.0.next_u32() & 1 == 0 { 1.0 } else { -1.0 }
    }

    /// Uniform in `0..bound`, by multiplication (bias below 2^-32 for each step of the bound).
    pub(crate) fn below(&mut self, bound: usize) -> usize {
        ((u64::from(self.0.next_u32()) * bound as u64) >> 32) as usize
    }
}
