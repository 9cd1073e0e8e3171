//! `model-quant train`: trains a float checkpoint by a recipe.

mod rig;

use super::{CliError, parse_bearing, print_json};
use crate::data::collision::CollisionSet;
use crate::data::file_io::{WriteError, check_directory, write_atomically};
use crate::data::ranges::RangeKind;
use crate::data::split::Split;
use crate::network::NetworkKind;
use crate::network::checkpoint::Checkpoint;
use crate::network::recipe::{GridMethod, InstructionSet, Recipe, TrainingSet};
use crate::network::shipped::shipped_checkpoint;
use crate::train::Progress;
use crate::train::history;
use crate::train::pipeline::{Outcome, StateFiles, train_both};
use indicatif::{ProgressBar, ProgressStyle};
use inference::BearingMaterial;
use serde_json::json;
use std::path::PathBuf;
use std::time::{Duration, Instant};

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
    /// Bearing material, such as babbitt
    #[arg(long, value_parser = parse_bearing, default_value = "babbitt")]
    bearing: BearingMaterial,
    /// Output directory for BEARING.float
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// Train again and compare with the shipped checkpoint; write nothing
    #[arg(long, conflicts_with_all = ["range", "set", "seed", "rows", "epochs", "grid_epochs", "grid_method",
        "patience", "portable", "out", "resume", "friction", "rig", "logs"])]
    check: bool,
    /// Ranges and distributions
    #[arg(long, value_enum)]
    range: Option<RangeKind>,
    /// Source of the rows
    #[arg(long, value_enum)]
    set: Option<TrainingSet>,
    /// Seed of every random draw
    #[arg(long)]
    seed: Option<u64>,
    /// Rows of the training set
    #[arg(long)]
    rows: Option<usize>,
    /// Number of epochs with free weights
    #[arg(long)]
    epochs: Option<usize>,
    /// Number of epochs in which the weights move to the 8-bit grid
    #[arg(long)]
    grid_epochs: Option<usize>,
    /// Method that moves the weights to the 8-bit grid
    #[arg(long, value_enum)]
    grid_method: Option<GridMethod>,
    /// End the epochs with free weights after this many without a better validation error
    #[arg(long)]
    patience: Option<usize>,
    /// Portable arithmetic even if AVX2 and FMA are available: about half as fast, other bytes
    #[arg(long)]
    portable: bool,
    /// Continue from the states in the output directory
    #[arg(long)]
    resume: bool,
    /// Minimum time in s between two states; 0 writes one after every epoch
    #[arg(long, default_value_t = 30)]
    keep_s: u64,
    /// Source of the friction network's targets
    #[arg(long, value_enum, default_value_t = FrictionSource::Law)]
    friction: FrictionSource,
    /// Friction rig, with --friction rig: preset or file [default: friction-rig-BEARING]
    #[arg(long, value_name = "RIG")]
    rig: Option<String>,
    /// Measured logs in place of the rig, one group a file, in the format of the rig's description
    #[arg(long, value_name = "CSV", num_args = 1.., requires = "rig")]
    logs: Vec<PathBuf>,
    /// Print the history as JSON
    #[arg(long)]
    json: bool,
}

/// Source of the friction network's targets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum FrictionSource {
    /// The law, for the controller: trains both networks
    Law,
    /// The friction set of the rig or of measured logs; the collision network covers its loads
    Rig,
}

fn recipe(arguments: &Arguments) -> Result<Recipe, CliError> {
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
    for (name, value, low, high, expected) in [
        ("--rows", recipe.rows, recipe.batch, 10_000_000, "at least a batch of 512, at most 10000000"),
        ("--epochs", recipe.epochs, 1, 100_000, "1 to 100000"),
        ("--grid-epochs", recipe.grid_epochs, 0, 100_000, "0 to 100000"),
        ("--patience", recipe.patience.unwrap_or(1), 1, 100_000, "1 to 100000"),
    ] {
        if !(low..=high).contains(&value) {
            return Err(CliError::Argument(name, value.to_string(), expected));
        }
    }
    Ok(recipe)
}

/// Progress bar over the epochs of both networks.
struct EpochBar {
    bar: ProgressBar,
    /// Epochs of one network.
    epochs: usize,
    /// Epochs done, of both networks.
    done: usize,
}

impl EpochBar {
    fn new(recipe: &Recipe) -> Self {
        let epochs = recipe.epochs + recipe.grid_epochs;
        let bar = ProgressBar::new(2 * epochs as u64);
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} epochs, {eta} left  {msg}") {
            bar.set_style(style);
        }
        Self { bar, epochs, done: 0 }
    }

    /// Counts an epoch and shows its errors.
    fn add(&mut self, network: NetworkKind, progress: &Progress) {
        self.done += 1;
        self.bar.inc(1);
        self.bar.set_message(line(network, progress));
        if progress.epoch.is_multiple_of(self.epochs.div_ceil(10)) || progress.epoch == self.epochs {
            self.bar.suspend(|| eprintln!("{}", line(network, progress)));
        }
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    if arguments.friction == FrictionSource::Rig {
        return rig::run(arguments);
    }
    if let Some(rig) = &arguments.rig {
        return Err(CliError::Argument("--rig", format!("{rig} without --friction rig"), "both or neither"));
    }
    let recipe = recipe(arguments)?;
    let states = (!arguments.check).then(|| StateFiles {
        directory: arguments.out.clone(),
        interval: Duration::from_secs(arguments.keep_s),
        resume: arguments.resume,
    });
    if let Some(states) = &states {
        check_directory(&states.directory)?;
        let has_state = |network| states.file(arguments.bearing, network).exists();
        if states.resume && !NetworkKind::ALL.into_iter().any(has_state) {
            eprintln!("no state of a training in {}: starts from random weights", arguments.out.display());
        }
    }
    let mut epoch_bar = EpochBar::new(&recipe);
    let started = Instant::now();
    let outcome = train_both(arguments.bearing, &recipe, states.as_ref(), &mut |network, progress| {
        epoch_bar.add(network, &progress);
    })?;
    epoch_bar.bar.finish_and_clear();
    let seconds = started.elapsed().as_secs_f64();
    let bytes = outcome.checkpoint.to_bytes()?;
    let id = Checkpoint::training_id(&bytes);
    let file = arguments.out.join(format!("{}.float", arguments.bearing.name()));
    if let Some(states) = &states {
        write_atomically(&file, &bytes)?;
        write_atomically(&file.with_extension("history.json"), history::file(&outcome, id).as_bytes())?;
        for network in NetworkKind::ALL {
            let path = states.file(arguments.bearing, network);
            std::fs::remove_file(&path).map_err(|source| WriteError { path, source })?;
        }
    }
    let rows = match recipe.set {
        TrainingSet::Drawn => recipe.rows as u64,
        TrainingSet::Full => {
            let set = CollisionSet::new(arguments.bearing, recipe.range, recipe.seed);
            Split::Training.row_count(set.rows())
        }
    };
    let samples_per_s = epoch_bar.done as f64 * rows as f64 / seconds;
    let equal = bytes == shipped_checkpoint(arguments.bearing);
    if arguments.json {
        print_json(&report(arguments, &outcome, id, &file, seconds, samples_per_s, equal))?;
    } else {
        super::print(format_args!(
            "trained {} in {seconds:.1} s, {samples_per_s:.0} samples/s, {}, training id {id:016x}",
            arguments.bearing.name(),
            recipe.instruction_set.name()
        ))?;
        if !arguments.check {
            super::print(format_args!("wrote {}", file.display()))?;
        }
    }
    if arguments.check && !equal {
        let name = arguments.bearing.name();
        return Err(CliError::Differs(format!(
            "checked-in checkpoint of {name}: training again gives other bytes"
        )));
    }
    Ok(())
}

fn report(
    arguments: &Arguments,
    outcome: &Outcome,
    id: u64,
    file: &std::path::Path,
    seconds: f64,
    samples_per_s: f64,
    equal: bool,
) -> serde_json::Value {
    json!({
        "bearing": arguments.bearing.name(),
        "recipe": outcome.checkpoint.recipe,
        "training_id": format!("{id:016x}"),
        "file": (!arguments.check).then(|| file.display().to_string()),
        "equals_checked_in": equal,
        "seconds": seconds,
        "samples_per_s": samples_per_s,
        "epochs": history::epochs(outcome),
    })
}

fn line(network: NetworkKind, progress: &Progress) -> String {
    format!(
        "{} epoch {}{}: loss {:.2e}, mae {:.2e}, validation {:.2e}, mae {:.2e}",
        network.name(),
        progress.epoch,
        if progress.on_grid { " (grid)" } else { "" },
        progress.loss,
        progress.mean_absolute_error,
        progress.validation_loss,
        progress.validation_mean_absolute_error
    )
}
