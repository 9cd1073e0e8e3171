//! Training recipe: everything that the result of a training depends on.

use crate::data::ranges::RangeKind;
use serde::{Deserialize, Serialize};

/// Source of the training rows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum TrainingSet {
    /// Rows drawn from the range, kept in memory
    #[default]
    Drawn,
    /// All ten million rows of the collision set's training part (`model-quant dataset collision`),
    /// generated on demand
    Full,
}

/// Method that moves the weights to the 8-bit grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum GridMethod {
    /// Freeze a few weights at a time on the grid while the others adapt; activations in floats
    #[default]
    Freeze,
    /// Fixed-point forward pass with straight-through gradients; all weights frozen in the last
    /// epoch
    Exact,
    /// Both: weights frozen a few at a time, forward pass in fixed point
    ExactFreeze,
}

/// Floating-point arithmetic of a training.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum InstructionSet {
    /// Separate multiply and add: any machine
    Portable,
    /// Fused multiply-add: x86 since 2013, with 512-bit vectors if available, else 256-bit
    Avx2Fma,
}

impl InstructionSet {
    /// Lower-case name.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2Fma => "avx2-fma",
        }
    }
}

/// Recipe of one training of both networks of a bearing. The same recipe gives the same bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Name of the bearing.
    pub bearing: String,
    /// Range and distribution of the rows.
    pub range: RangeKind,
    /// Source of the rows.
    #[serde(default)]
    pub set: TrainingSet,
    /// Seed of every draw.
    pub seed: u64,
    /// Rows of the training set; ignored for the full set.
    pub rows: usize,
    /// Rows of the validation set.
    pub validation_rows: usize,
    /// Arithmetic of the training.
    #[serde(default = "portable")]
    pub instruction_set: InstructionSet,
    /// Windows in one step of the optimiser.
    pub batch: usize,
    /// Maximum number of epochs with free weights.
    pub epochs: usize,
    /// Number of consecutive epochs without a better validation error after which the epochs with
    /// free weights end.
    #[serde(default)]
    pub patience: Option<usize>,
    /// Number of further epochs with weights on the 8-bit grid.
    pub grid_epochs: usize,
    /// Largest learning rate; decays as a cosine to a thousandth.
    pub learning_rate: f64,
    /// Method of the epochs on the grid.
    #[serde(default)]
    pub grid_method: GridMethod,
    /// Largest learning rate of the epochs on the grid; decays in the same way.
    pub grid_learning_rate: f64,
}

/// Arithmetic of the checkpoints whose recipe does not name it.
fn portable() -> InstructionSet {
    InstructionSet::Portable
}

/// Number of a recipe that is out of its range.
#[derive(Debug, thiserror::Error)]
#[error("{}: found {found}; expected {expected}", option.trim_start_matches("--"))]
pub struct RecipeError {
    /// Option of the command line that sets the number.
    pub option: &'static str,
    /// Number found.
    pub found: usize,
    /// Range expected.
    pub expected: &'static str,
}

impl Recipe {
    /// Checks the numbers of rows and epochs.
    ///
    /// # Errors
    ///
    /// The first number that is out of its range.
    pub fn check(&self) -> Result<(), RecipeError> {
        for (option, found, low, high, expected) in [
            ("--rows", self.rows, self.batch, 10_000_000, "at least a batch of 512, at most 10000000"),
            ("--epochs", self.epochs, 1, 100_000, "1 to 100000"),
            ("--grid-epochs", self.grid_epochs, 0, 100_000, "0 to 100000"),
            ("--patience", self.patience.unwrap_or(1), 1, 100_000, "1 to 100000"),
        ] {
            if !(low..=high).contains(&found) {
                return Err(RecipeError { option, found, expected });
            }
        }
        Ok(())
    }

    /// Recipe of the shipped models.
    pub fn standard(bearing: inference::BearingMaterial) -> Self {
        Self {
            bearing: bearing.name().to_owned(),
            range: RangeKind::Bench,
            set: TrainingSet::Drawn,
            seed: 2,
            rows: 1 << 18,
            validation_rows: 1 << 13,
            instruction_set: InstructionSet::Avx2Fma,
            batch: 512,
            epochs: 120,
            patience: None,
            grid_epochs: 200,
            grid_method: GridMethod::Freeze,
            learning_rate: 4e-3,
            grid_learning_rate: 5e-4,
        }
    }
}
