//! `model-quant train --friction rig`: trains and evaluates the friction network of the rig.

use super::arguments::{Arguments, recipe};
use super::epoch_bar::EpochBar;
use crate::cli::error::CliError;
use crate::cli::output::{print, print_json};
use crate::data::features::FloatFeatures;
use crate::data::file_io::{check_directory, write_atomically};
use crate::data::friction::FrictionSet;
use crate::data::friction_source::{from_logs, from_rig, truth_of_rig};
use crate::data::ranges::{RangeKind, header};
use crate::data::static_deformation::CLEARANCE_M;
use crate::evaluate::errors::Errors;
use crate::evaluate::rig;
use crate::network::NetworkKind;
use crate::network::recipe::Recipe;
use crate::train::rig::{SMOOTHING_S, check_loads, collision_force_n, train_on};
use crate::train::sources::Sources;
use crate::train::{Loss, Training};
use serde_json::json;

/// Default number of epochs: later epochs improve both networks little.
const EPOCHS: usize = 60;

/// Refuses options without effect on this training.
fn check(arguments: &Arguments) -> Result<(), CliError> {
    let given = [
        ("--range", arguments.range.is_some()),
        ("--grid-epochs", arguments.grid_epochs.is_some()),
        ("--grid-method", arguments.grid_method.is_some()),
        ("--resume", arguments.resume),
    ];
    match given.into_iter().find(|(_, is_given)| *is_given) {
        Some((name, _)) => {
            let expected =
                "nothing: the training for the rig has a fixed range, no 8-bit grid and no state files";
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
    let features = FloatFeatures::from_header(&header(bearing, recipe.range));
    check_loads(&set, &features)?;
    let mut epoch_bar = EpochBar::new(&recipe);
    let sources = Sources::new(bearing, &recipe);
    let (rows, validation) = sources.parts_for(NetworkKind::Collision);
    let mut fit =
        Training::new(&recipe, NetworkKind::Collision.shape(), (&rows, &validation), Loss::Clamped, 0);
    while !fit.is_done() {
        epoch_bar.add(NetworkKind::Collision, &fit.epoch());
    }
    let collision = fit.finish().float;
    let outcome = train_on(&set, &collision, &features, &recipe, &mut |progress| {
        epoch_bar.add(NetworkKind::Friction, &progress);
    });
    epoch_bar.bar.finish_and_clear();
    let found = rig::errors(&set, &truth, [&collision, &outcome.network], &features);
    let loads = [100e3, 150e3, 200e3, 240e3];
    let forces: Vec<_> = (loads.iter())
        .map(|&load_n| {
            let force_n = collision_force_n(&collision, &features, load_n);
            json!({ "load_n": load_n, "collision_force_n": force_n })
        })
        .collect();
    let errors = |errors: &Errors| {
        let (rows, r2) = (errors.rows, errors.r2);
        json!({ "rows": rows, "r2": r2, "mae_nm": errors.mae_n, "largest_nm": errors.largest_n })
    };
    let groups: Vec<_> = (set.groups.iter())
        .map(|group| json!({ "source": group.source, "part": group.split.name() }))
        .collect();
    let result = json!({
        "bearing": bearing.name(),
        "groups": groups,
        "scales": set.scales,
        "recipe": recipe,
        "clearance_m": CLEARANCE_M,
        "collision": forces,
        "test_against_truth": found.truth.as_ref().map(errors),
        "test_against_cleaned": errors(&found.cleaned),
        "shape": outcome.network.shape(),
        "parameters": outcome.network.parameters().collect::<Vec<f32>>(),
        "collision_parameters": collision.parameters().collect::<Vec<f32>>(),
        "epochs": outcome.history,
    });
    let file = arguments.out.join(format!("{}.rig.json", bearing.name()));
    write_atomically(&file, format!("{result}\n").as_bytes())?;
    if arguments.json {
        return print_json(&result);
    }
    let line = |what: &str, errors: &Errors| {
        print(format_args!(
            "test groups, {} samples, torque against {what}: R^2 {:.5}, mean absolute error {:.2} N m, \
             largest {:.1} N m",
            errors.rows, errors.r2, errors.mae_n, errors.largest_n
        ))
    };
    if let Some(truth) = &found.truth {
        line("the truth without noise", truth)?;
    }
    line("the cleaned torque", &found.cleaned)?;
    print(format_args!("wrote {}", file.display()))
}
