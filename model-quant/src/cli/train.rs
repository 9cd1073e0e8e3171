//! `model-quant train`: a float checkpoint from a recipe.

use super::{CliError, parse_bearing, print_json};
use indicatif::{ProgressBar, ProgressStyle};
use inference::Bearing;
use model_quant::checkpoint::Checkpoint;
use model_quant::float_pair::shipped;
use model_quant::pipeline::{Network, train_both};
use model_quant::ranges::RangeKind;
use model_quant::recipe::Recipe;
use model_quant::train::Progress;
use model_quant::write::write_whole;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

/// Train both networks of a bearing and write the float checkpoint
///
/// Without options that change the recipe, this gives the checked-in checkpoint byte for byte, on any number of
/// threads. `--check` trains with the recipe of the checked-in checkpoint, compares and writes nothing.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  model-quant train --bearing babbitt --out model-quant/models\n  \
                        model-quant train --bearing plastic --check")]
pub(crate) struct Arguments {
    /// Bearing: babbitt or plastic
    #[arg(long, value_parser = parse_bearing, default_value = "babbitt")]
    bearing: Bearing,
    /// Directory that gets BEARING.float
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// Train again, compare with the checked-in checkpoint, write nothing
    #[arg(long, conflicts_with_all = ["range", "seed", "rows", "epochs", "grid_epochs", "out"])]
    check: bool,
    /// Ranges and distributions
    #[arg(long, value_enum)]
    range: Option<RangeKind>,
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
    /// Print the history as JSON
    #[arg(long)]
    json: bool,
}

fn recipe(arguments: &Arguments) -> Result<Recipe, CliError> {
    let mut recipe = Recipe::standard(arguments.bearing);
    if arguments.check {
        recipe = Checkpoint::from_bytes(shipped(arguments.bearing))?.recipe;
    }
    recipe.range = arguments.range.unwrap_or(recipe.range);
    recipe.seed = arguments.seed.unwrap_or(recipe.seed);
    recipe.rows = arguments.rows.unwrap_or(recipe.rows);
    recipe.epochs = arguments.epochs.unwrap_or(recipe.epochs);
    recipe.grid_epochs = arguments.grid_epochs.unwrap_or(recipe.grid_epochs);
    for (name, value, low, high, expected) in [
        ("--rows", recipe.rows, recipe.batch, 10_000_000, "at least a batch of 512, at most 10000000"),
        ("--epochs", recipe.epochs, 1, 100_000, "1 to 100000"),
        ("--grid-epochs", recipe.grid_epochs, 0, 100_000, "0 to 100000"),
    ] {
        if !(low..=high).contains(&value) {
            return Err(CliError::Argument(name, value.to_string(), expected));
        }
    }
    Ok(recipe)
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let recipe = recipe(arguments)?;
    let epochs = recipe.epochs + recipe.grid_epochs;
    let bar = ProgressBar::new(2 * epochs as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} {eta} {msg}") {
        bar.set_style(style);
    }
    let started = Instant::now();
    let mut history = Vec::new();
    let trained = train_both(arguments.bearing, &recipe, &mut |network: Network, progress: Progress| {
        bar.inc(1);
        bar.set_message(line(network, &progress));
        if progress.epoch.is_multiple_of(epochs.div_ceil(10)) || progress.epoch == epochs {
            bar.suspend(|| eprintln!("{}", line(network, &progress)));
        }
        history.push((network, progress));
    });
    bar.finish_and_clear();
    let seconds = started.elapsed().as_secs_f64();
    let bytes = trained.to_bytes()?;
    let file = arguments.out.join(format!("{}.float", arguments.bearing.name()));
    if !arguments.check {
        write_whole(&file, &bytes)?;
    }
    let samples_per_s = (2 * epochs * recipe.rows) as f64 / seconds;
    if arguments.json {
        let epochs: Vec<_> = history.iter().map(|(network, progress)| entry(*network, progress)).collect();
        print_json(&json!({
            "bearing": arguments.bearing.name(),
            "recipe": recipe,
            "training_id": format!("{:016x}", Checkpoint::training_id(&bytes)),
            "file": (!arguments.check).then(|| file.display().to_string()),
            "equals_checked_in": bytes == shipped(arguments.bearing),
            "seconds": seconds,
            "samples_per_s": samples_per_s,
            "epochs": epochs,
        }))?;
    } else {
        let id = Checkpoint::training_id(&bytes);
        super::print(format_args!(
            "trained {} in {seconds:.1} s, {samples_per_s:.0} samples/s, training id {id:016x}",
            arguments.bearing.name()
        ))?;
        if !arguments.check {
            super::print(format_args!("wrote {}", file.display()))?;
        }
    }
    if arguments.check && bytes != shipped(arguments.bearing) {
        let name = arguments.bearing.name();
        return Err(CliError::Differs(format!(
            "checked-in checkpoint of {name}: training it again gave other bytes"
        )));
    }
    Ok(())
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

fn entry(network: Network, progress: &Progress) -> serde_json::Value {
    json!({
        "network": network.name(),
        "epoch": progress.epoch,
        "on_grid": progress.on_grid,
        "loss": progress.loss,
        "mae": progress.mean_absolute_error,
        "validation_loss": progress.validation_loss,
        "validation_mae": progress.validation_mean_absolute_error,
    })
}
