//! `model-quant train --friction rig`: the friction network of the rig, and what it is worth.

use super::{Arguments, Watch, recipe};
use crate::cli::{CliError, print, print_json};
use model_quant::dataset::friction::FrictionSet;
use model_quant::dataset::friction_source::{from_logs, from_rig, truth_of_rig};
use model_quant::errors::Errors;
use model_quant::features::FloatFeatures;
use model_quant::pipeline::Network;
use model_quant::ranges::{RangeKind, header};
use model_quant::recipe::Recipe;
use model_quant::rig::{CLEARANCE_M, SMOOTHING_S, check_loads, collision_force_n, train_on};
use model_quant::shapes::collision;
use model_quant::sources::Sources;
use model_quant::train::{Loss, Training};
use model_quant::write::{check_directory, write_whole};
use serde_json::json;

/// Passes over the rows unless given: both networks learn little after that.
const EPOCHS: usize = 60;

/// Refuses what has no meaning here, so that nobody believes it was heeded.
fn check(arguments: &Arguments) -> Result<(), CliError> {
    let given = [
        ("--range", arguments.range.is_some()),
        ("--grid-epochs", arguments.grid_epochs.is_some()),
        ("--grid-method", arguments.grid_method.is_some()),
        ("--resume", arguments.resume),
    ];
    match given.into_iter().find(|(_, is_given)| *is_given) {
        Some((name, _)) => {
            let expected = "nothing: the rig has its range, no 8-bit grid and no state that is kept";
            Err(CliError::Argument(name, "it with --friction rig".to_owned(), expected))
        }
        None => Ok(()),
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    check(arguments)?;
    check_directory(&arguments.out)?;
    let mut recipe = Recipe { range: RangeKind::Rig, grid_epochs: 0, ..recipe(arguments)? };
    recipe.epochs = arguments.epochs.unwrap_or(EPOCHS);
    let bearing = arguments.bearing;
    let preset = format!("friction-rig-{}", bearing.name());
    let description = arguments.rig.as_deref().unwrap_or(&preset);
    let (logs, truth) = if arguments.logs.is_empty() {
        (from_rig(description, bearing, recipe.seed)?, truth_of_rig(description, recipe.seed)?)
    } else {
        (from_logs(description, &arguments.logs)?, Vec::new())
    };
    let set = FrictionSet::new(logs, SMOOTHING_S, recipe.seed)?;
    let features = FloatFeatures::of(&header(bearing, recipe.range));
    check_loads(&set, &features)?;
    let mut watch = Watch::new(&recipe);
    let sources = Sources::new(bearing, &recipe);
    let (rows, validation) = sources.of(Network::Collision);
    let mut fit = Training::new(&recipe, collision(), (&rows, &validation), Loss::Clamped, 0);
    while !fit.is_done() {
        watch.epoch(Network::Collision, &fit.epoch());
    }
    let collision = fit.finish().float;
    let outcome = train_on(&set, &truth, &collision, &features, &recipe, &mut |progress| {
        watch.epoch(Network::Friction, &progress);
    });
    watch.bar.finish_and_clear();
    let loads = [100e3, 150e3, 200e3, 240e3];
    let forces: Vec<_> = (loads.iter())
        .map(|&load_n| json!({ "load_n": load_n, "collision_force_n": collision_force_n(&collision, &features, load_n) }))
        .collect();
    let errors = |errors: &Errors| json!({ "rows": errors.rows, "r2": errors.r2, "mae_nm": errors.mae_n, "largest_nm": errors.largest_n });
    let result = json!({
        "bearing": bearing.name(),
        "groups": set.groups.iter().map(|g| json!({ "source": g.source, "part": g.split.name() })).collect::<Vec<_>>(),
        "scales": set.scales,
        "recipe": recipe,
        "clearance_m": CLEARANCE_M,
        "collision": forces,
        "test_against_truth": outcome.truth.as_ref().map(errors),
        "test_against_cleaned": errors(&outcome.cleaned),
        "shape": outcome.network.shape(),
        "parameters": outcome.network.parameters().collect::<Vec<f32>>(),
        "collision_parameters": collision.parameters().collect::<Vec<f32>>(),
        "epochs": outcome.history,
    });
    let file = arguments.out.join(format!("{}.rig.json", bearing.name()));
    write_whole(&file, format!("{result}\n").as_bytes())?;
    if arguments.json {
        return print_json(&result);
    }
    let line = |what: &str, errors: &Errors| {
        print(format_args!(
            "test groups, {} samples, torque against {what}: R^2 {:.5}, mean absolute error {:.2} N m, largest {:.1} N m",
            errors.rows, errors.r2, errors.mae_n, errors.largest_n
        ))
    };
    if let Some(truth) = &outcome.truth {
        line("the truth without noise", truth)?;
    }
    line("the cleaned torque", &outcome.cleaned)?;
    print(format_args!("wrote {}", file.display()))
}
