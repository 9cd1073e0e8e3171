//! `model-quant train`: trains a float checkpoint by a recipe.

mod arguments;
mod epoch_bar;
mod rig;

pub(crate) use arguments::Arguments;
use arguments::{FrictionSource, recipe};
use epoch_bar::EpochBar;

use crate::cli::error::CliError;
use crate::cli::output::{print, print_json};
use crate::data::collision::CollisionSet;
use crate::data::file_io::{WriteError, check_directory, write_atomically};
use crate::data::split::Split;
use crate::network::NetworkKind;
use crate::network::checkpoint::Checkpoint;
use crate::network::recipe::TrainingSet;
use crate::network::shipped::shipped_checkpoint;
use crate::train::history;
use crate::train::pipeline::{Outcome, StateFiles, train_both};
use serde_json::json;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

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
        ControlFlow::Continue(())
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
        print(format_args!(
            "trained {} in {seconds:.1} s, {samples_per_s:.0} samples/s, {}, training id {id:016x}",
            arguments.bearing.name(),
            recipe.instruction_set.name()
        ))?;
        if !arguments.check {
            print(format_args!("wrote {}", file.display()))?;
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
