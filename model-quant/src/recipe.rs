//! Everything that a training depends on.

use crate::ranges::RangeKind;
use crate::train::InstructionSet;
use serde::{Deserialize, Serialize};

/// Where the rows of a training come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum TrainingSet {
    /// A number of rows drawn from the range, kept in memory
    #[default]
    Drawn,
    /// All ten million rows of the collision set's training part (`model-quant dataset collision`), made as they are needed
    Full,
}

/// How weights come on to the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum GridMethod {
    /// A few weights at a time are frozen on the grid, the free ones make up for them; activations in floats
    #[default]
    Freeze,
    /// The way forward in the controller's whole numbers, slopes as if nothing were rounded; frozen in the last epoch
    Exact,
    /// Both: frozen a few at a time, the way forward in whole numbers
    ExactFreeze,
}

/// Recipe of one training of both networks of a bearing. The same recipe gives the same bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Name of the bearing.
    pub bearing: String,
    /// Range and distribution of the rows.
    pub range: RangeKind,
    /// Where the rows come from.
    #[serde(default)]
    pub set: TrainingSet,
    /// Seed of every draw.
    pub seed: u64,
    /// Rows of the training set; the full set has its own number.
    pub rows: usize,
    /// Rows of the validation set.
    pub validation_rows: usize,
    /// Arithmetic of the training.
    #[serde(default = "portable")]
    pub instruction_set: InstructionSet,
    /// Windows per step of the optimiser.
    pub batch: usize,
    /// Passes over the rows with free weights.
    pub epochs: usize,
    /// The passes with free weights end when this many in a row were no better on the validation set.
    #[serde(default)]
    pub patience: Option<usize>,
    /// Further passes with the weights on the 8-bit grid in the forward pass.
    pub grid_epochs: usize,
    /// Largest learning rate; falls as a cosine to a thousandth.
    pub learning_rate: f64,
    /// What happens in the passes on the grid.
    #[serde(default)]
    pub grid_method: GridMethod,
    /// Largest learning rate of the passes on the grid; falls in the same way.
    pub grid_learning_rate: f64,
}

/// What trained the checkpoints that do not name it.
fn portable() -> InstructionSet {
    InstructionSet::Portable
}

impl Recipe {
    /// The recipe of the checked-in models.
    pub fn standard(bearing: inference::Bearing) -> Self {
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
