//! `model-quant train`: a float checkpoint from a recipe.

mod rig;

use super::{CliError, parse_bearing, print_json};
use indicatif::{ProgressBar, ProgressStyle};
use inference::Bearing;
use model_quant::checkpoint::Checkpoint;
use model_quant::dataset::grid::ROWS;
use model_quant::dataset::split::Split;
use model_quant::float_pair::shipped;
use model_quant::history;
use model_quant::pipeline::{Keep, Network, Outcome, train_both};
use model_quant::ranges::RangeKind;
use model_quant::recipe::{GridMethod, Recipe, TrainingSet};
use model_quant::train::{InstructionSet, Progress};
use model_quant::write::write_whole;
use serde_json::json;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Train both networks of a bearing and write the float checkpoint
///
/// Without options that change the recipe, this gives the checked-in checkpoint byte for byte, on any number of
/// threads of a machine with AVX2 and FMA. `--check` trains with the recipe of the checked-in checkpoint, compares and
/// writes nothing. Beside the checkpoint BEARING.history.json has the errors of every epoch. While it runs,
/// BEARING-collision.training and BEARING-friction.training hold its state: after a kill, `--resume` with the same options
/// goes on from there to the same bytes.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  model-quant train --bearing babbitt --out model-quant/models\n  \
                        model-quant train --bearing plastic --check\n  \
                        model-quant train --set full --epochs 200 --out long   # all ten million rows; hours\n  \
                        model-quant train --set full --epochs 200 --out long --resume\n  \
                        model-quant train --bearing plastic --friction rig --out rig")]
pub(crate) struct Arguments {
    /// Bearing: babbitt or plastic
    #[arg(long, value_parser = parse_bearing, default_value = "babbitt")]
    bearing: Bearing,
    /// Directory that gets BEARING.float
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// Train again, compare with the checked-in checkpoint, write nothing
    #[arg(long, conflicts_with_all = ["range", "set", "seed", "rows", "epochs", "grid_epochs", "grid_method", "patience", "portable", "out", "resume", "friction", "rig", "logs"])]
    check: bool,
    /// Ranges and distributions
    #[arg(long, value_enum)]
    range: Option<RangeKind>,
    /// Where the rows come from
    #[arg(long, value_enum)]
    set: Option<TrainingSet>,
    /// Seed of every draw
    #[arg(long)]
    seed: Option<u64>,
    /// Rows of the training set
    #[arg(long)]
    rows: Option<usize>,
    /// Passes with free weights
    #[arg(long)]
    epochs: Option<usize>,
    /// Passes while the weights are put on the 8-bit grid
    #[arg(long)]
    grid_epochs: Option<usize>,
    /// How weights come on to the grid
    #[arg(long, value_enum)]
    grid_method: Option<GridMethod>,
    /// End the passes with free weights after so many that were no better on the validation rows
    #[arg(long)]
    patience: Option<usize>,
    /// Plain arithmetic, even where AVX2 and FMA are there: about half as fast, other bytes
    #[arg(long)]
    portable: bool,
    /// Go on from the states in the output directory
    #[arg(long)]
    resume: bool,
    /// Least time in s between two states; 0 keeps one after every epoch
    #[arg(long, default_value_t = 30)]
    keep_s: u64,
    /// Where the friction network's torque comes from
    #[arg(long, value_enum, default_value_t = FrictionSource::Law)]
    friction: FrictionSource,
    /// Friction rig, with --friction rig: preset or file [default: friction-rig-BEARING]
    #[arg(long, value_name = "RIG")]
    rig: Option<String>,
    /// Measured logs in the rig's place, one a group, read as the rig's description says
    #[arg(long, value_name = "CSV", num_args = 1.., requires = "rig")]
    logs: Vec<PathBuf>,
    /// Print the history as JSON
    #[arg(long)]
    json: bool,
}

/// Where the friction network's targets come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum FrictionSource {
    /// The law, for the controller: both networks
    Law,
    /// The friction set of the rig or of measured logs, behind a collision network that knows its loads
    Rig,
}

fn recipe(arguments: &Arguments) -> Result<Recipe, CliError> {
    let mut recipe = Recipe::standard(arguments.bearing);
    if arguments.check {
        recipe = Checkpoint::from_bytes(shipped(arguments.bearing))?.recipe;
    }
    recipe.range = arguments.range.unwrap_or(recipe.range);
    recipe.set = arguments.set.unwrap_or(recipe.set);
    recipe.seed = arguments.seed.unwrap_or(recipe.seed);
    recipe.rows = arguments.rows.unwrap_or(recipe.rows);
    recipe.epochs = arguments.epochs.unwrap_or(recipe.epochs);
    recipe.grid_epochs = arguments.grid_epochs.unwrap_or(recipe.grid_epochs);
    recipe.grid_method = arguments.grid_method.unwrap_or(recipe.grid_method);
    recipe.patience = arguments.patience.or(recipe.patience);
    if arguments.portable || !(arguments.check || recipe.instruction_set.is_here()) {
        recipe.instruction_set = InstructionSet::Portable;
    }
    if !recipe.instruction_set.is_here() {
        let name = recipe.instruction_set.name();
        return Err(CliError::Refused(format!(
            "the checked-in checkpoint was trained with {name}, which is not here"
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

/// The bar and what it counts.
struct Watch {
    bar: ProgressBar,
    epochs: usize,
    done: usize,
}

impl Watch {
    fn new(recipe: &Recipe) -> Self {
        let epochs = recipe.epochs + recipe.grid_epochs;
        let bar = ProgressBar::new(2 * epochs as u64);
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} epochs, {eta} left  {msg}") {
            bar.set_style(style);
        }
        Self { bar, epochs, done: 0 }
    }

    fn epoch(&mut self, network: Network, progress: &Progress) {
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
    let keep = (!arguments.check).then(|| Keep {
        directory: arguments.out.clone(),
        every: Duration::from_secs(arguments.keep_s),
        resume: arguments.resume,
    });
    let mut watch = Watch::new(&recipe);
    let started = Instant::now();
    let outcome = train_both(arguments.bearing, &recipe, keep.as_ref(), &mut |network, progress| {
        watch.epoch(network, &progress);
    })?;
    watch.bar.finish_and_clear();
    let seconds = started.elapsed().as_secs_f64();
    let bytes = outcome.checkpoint.to_bytes()?;
    let id = Checkpoint::training_id(&bytes);
    let file = arguments.out.join(format!("{}.float", arguments.bearing.name()));
    if let Some(keep) = &keep {
        write_whole(&file, &bytes)?;
        write_whole(&file.with_extension("history.json"), history::file(&outcome, id).as_bytes())?;
        for network in Network::ALL {
            let path = keep.file(arguments.bearing, network);
            std::fs::remove_file(&path).map_err(|source| CliError::Read { path, source })?;
        }
    }
    let rows = match recipe.set {
        TrainingSet::Drawn => recipe.rows as u64,
        TrainingSet::Full => Split::Training.rows_of(ROWS),
    };
    let samples_per_s = watch.done as f64 * rows as f64 / seconds;
    let equal = bytes == shipped(arguments.bearing);
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
            "checked-in checkpoint of {name}: training it again gave other bytes"
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

fn line(network: Network, progress: &Progress) -> String {
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
