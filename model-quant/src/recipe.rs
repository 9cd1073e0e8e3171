//! Everything that a training depends on.

use crate::ranges::RangeKind;
use crate::train::InstructionSet;
use serde::{Deserialize, Serialize};

/// Recipe of one training of both networks of a bearing. The same recipe gives the same bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Name of the bearing.
    pub bearing: String,
    /// Range and distribution of the rows.
    pub range: RangeKind,
    /// Seed of every draw.
    pub seed: u64,
    /// Rows of the training set.
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
            seed: 2,
            rows: 1 << 17,
            validation_rows: 1 << 13,
            instruction_set: InstructionSet::Avx2Fma,
            batch: 512,
            epochs: 180,
            patience: None,
            grid_epochs: 120,
            learning_rate: 6e-3,
            grid_learning_rate: 5e-4,
        }
    }
}
