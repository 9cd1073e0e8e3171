//! Arguments of `model-quant train`, and the recipe that they select.

use crate::cli::checkpoint::BearingParser;
use crate::cli::error::CliError;
use crate::data::ranges::RangeKind;
use crate::network::checkpoint::Checkpoint;
use crate::network::recipe::{GridMethod, InstructionSet, Recipe, RecipeError, TrainingSet};
use crate::network::shipped::shipped_checkpoint;
use inference::BearingMaterial;
use std::path::PathBuf;

/// Train both networks of a bearing and write the float checkpoint
///
/// Without options that change the recipe this gives the shipped checkpoint byte for byte, on any
/// number of threads of a machine with AVX2 and FMA. `--check` trains with the recipe of the
/// shipped checkpoint, compares and writes nothing. BEARING.history.json gets the errors of every
/// epoch. During the training, BEARING-collision.training and BEARING-friction.training hold its
/// state: after an interruption `--resume` with the same options continues to the same bytes.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  model-quant train --bearing babbitt --out model-quant/models\n  \
                        model-quant train --bearing plastic --check\n  \
                        model-quant train --set full --epochs 200 --out long   \
                        # all ten million rows; hours\n  \
                        model-quant train --set full --epochs 200 --out long --resume\n  \
                        model-quant train --bearing plastic --friction rig --out rig")]
pub(crate) struct Arguments {
    /// Bearing material
    #[arg(long, value_parser = BearingParser, default_value = "babbitt")]
    pub(super) bearing: BearingMaterial,
    /// Output directory for BEARING.float
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub(super) out: PathBuf,
    /// Train again and compare with the shipped checkpoint; write nothing
    #[arg(long, conflicts_with_all = ["range", "set", "seed", "rows", "epochs", "grid_epochs", "grid_method",
        "patience", "portable", "out", "resume", "friction", "rig", "logs"])]
    pub(super) check: bool,
    /// Ranges and distributions
    #[arg(long, value_enum)]
    pub(super) range: Option<RangeKind>,
    /// Source of the rows
    #[arg(long, value_enum)]
    pub(super) set: Option<TrainingSet>,
    /// Seed of every random draw
    #[arg(long)]
    pub(super) seed: Option<u64>,
    /// Rows of the training set
    #[arg(long)]
    pub(super) rows: Option<usize>,
    /// Number of epochs with free weights
    #[arg(long)]
    pub(super) epochs: Option<usize>,
    /// Number of epochs in which the weights move to the 8-bit grid
    #[arg(long)]
    pub(super) grid_epochs: Option<usize>,
    /// Method that moves the weights to the 8-bit grid
    #[arg(long, value_enum)]
    pub(super) grid_method: Option<GridMethod>,
    /// End the epochs with free weights after this many without a better validation error
    #[arg(long)]
    pub(super) patience: Option<usize>,
    /// Portable arithmetic even if AVX2 and FMA are available: about half as fast, other bytes
    #[arg(long)]
    pub(super) portable: bool,
    /// Continue from the states in the output directory
    #[arg(long)]
    pub(super) resume: bool,
    /// Minimum time in s between two states; 0 writes one after every epoch
    #[arg(long, default_value_t = 30)]
    pub(super) keep_s: u64,
    /// Source of the friction network's targets
    #[arg(long, value_enum, default_value_t = FrictionSource::Law)]
    pub(super) friction: FrictionSource,
    /// Friction rig, with --friction rig: preset or file [default: friction-rig-BEARING]
    #[arg(long, value_name = "RIG")]
    pub(super) rig: Option<String>,
    /// Measured logs in place of the rig, one group a file, in the format of the rig's description
    #[arg(long, value_name = "CSV", num_args = 1.., requires = "rig")]
    pub(super) logs: Vec<PathBuf>,
    /// Print the history as JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// Source of the friction network's targets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum FrictionSource {
    /// The law, for the controller: trains both networks
    Law,
    /// The friction set of the rig or of measured logs; the collision network covers its loads
    Rig,
}

/// Recipe of the training that the options select.
pub(super) fn recipe(arguments: &Arguments) -> Result<Recipe, CliError> {
    let mut recipe = Recipe::standard(arguments.bearing);
    if arguments.check {
        recipe = Checkpoint::from_bytes(shipped_checkpoint(arguments.bearing))?.recipe;
    }
    recipe.range = arguments.range.unwrap_or(recipe.range);
    recipe.set = arguments.set.unwrap_or(recipe.set);
    recipe.seed = arguments.seed.unwrap_or(recipe.seed);
    recipe.rows = arguments.rows.unwrap_or(recipe.rows);
    recipe.epochs = arguments.epochs.unwrap_or(recipe.epochs);
    recipe.grid_epochs = arguments.grid_epochs.unwrap_or(recipe.grid_epochs);
    recipe.grid_method = arguments.grid_method.unwrap_or(recipe.grid_method);
    recipe.patience = arguments.patience.or(recipe.patience);
    if arguments.portable || !(arguments.check || recipe.instruction_set.is_available()) {
        recipe.instruction_set = InstructionSet::Portable;
    }
    if !recipe.instruction_set.is_available() {
        let name = recipe.instruction_set.name();
        return Err(CliError::Refused(format!(
            "the checked-in checkpoint was trained with {name}, \
             which this machine does not support"
        )));
    }
    let refused = |e: RecipeError| CliError::Argument(e.option, e.found.to_string(), e.expected);
    recipe.check().map_err(refused)?;
    Ok(recipe)
}
