//! Table rows of the training report.

use super::facts::BearingFacts;
use super::rig::{GroupFacts, RigFacts};
use crate::network::recipe::TrainingSet;

/// Formats a number with three significant digits.
fn figures(value: f64) -> String {
    let digits = if value == 0.0 { 0 } else { (2 - value.abs().log10().floor() as i32).clamp(0, 6) };
    format!("{value:.*}", digits as usize)
}

/// Errors of every network on test rows and on held-out bench runs.
pub(super) fn error_rows(all: &[BearingFacts]) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for verdict in all.iter().flat_map(|facts| &facts.verdicts) {
        let torque = |force_n: f64| {
            if verdict.network == "friction" {
                figures(force_n * crate::evaluate::errors::FRICTION_RADIUS_M)
            } else {
                "-".into()
            }
        };
        let row = |rows: String, [r2_image, r2_float]: [f64; 2], [mae_n, share, largest_n]: [f64; 3]| {
            vec![
                verdict.bearing.to_owned(),
                verdict.network.to_owned(),
                rows,
                format!("{r2_image:.6}"),
                format!("{r2_float:.6}"),
                figures(mae_n),
                torque(mae_n),
                format!("{:.3}", 100.0 * share),
                figures(largest_n),
            ]
        };
        let errors = [verdict.mae_n, verdict.mae_share_of_p99, verdict.largest_n];
        let r2 = [verdict.r2_quantised, verdict.r2_float];
        rows.push(row(format!("test rows, {}", verdict.rows), r2, errors));
        if let Some(held_out) = &verdict.held_out {
            let (image, float) = (&held_out.image, &held_out.float);
            let errors = [image.mae_n, image.mae_share_of_p99, image.largest_n];
            rows.push(row(format!("held-out bench runs, {}", held_out.runs), [image.r2, float.r2], errors));
        }
    }
    rows
}

/// Errors of the rig's networks by test group.
pub(super) fn rig_rows(rigs: &[RigFacts]) -> Vec<Vec<String>> {
    let groups = rigs.iter().flat_map(|rig| rig.errors.iter().map(|group| (rig.bearing, group)));
    let row = |(bearing, group): (&str, &GroupFacts)| {
        let mut cells = vec![bearing.to_owned(), group.group.clone(), group.truth.samples.to_string()];
        for errors in [&group.truth, &group.cleaned] {
            let r2 = if errors.r2 < 0.0 { "below 0".to_owned() } else { format!("{:.5}", errors.r2) };
            cells.extend([r2, figures(errors.mae_nm), figures(errors.largest_nm)]);
        }
        cells
    };
    groups.map(row).collect()
}

/// Errors of every quantisation mode.
pub(super) fn mode_rows(all: &[BearingFacts]) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for facts in all {
        for mode in &facts.modes {
            let [normal, friction] = mode.mae_quantisation_n;
            let [largest_normal, largest_friction] = mode.largest_quantisation_n;
            let [r2, _] = mode.r2_quantised;
            rows.push(vec![
                facts.bearing.to_owned(),
                mode.mode.name().to_owned(),
                mode.bytes.to_string(),
                figures(normal),
                figures(largest_normal),
                figures(friction),
                figures(largest_friction),
                format!("{r2:.6}"),
            ]);
        }
    }
    rows
}

/// Recipes of the networks.
pub(super) fn recipe_rows(all: &[BearingFacts]) -> Vec<Vec<String>> {
    all.iter()
        .map(|facts| {
            let recipe = &facts.recipe;
            vec![
                facts.bearing.to_owned(),
                format!("{:?}", recipe.range).to_lowercase(),
                recipe.seed.to_string(),
                match recipe.set {
                    TrainingSet::Drawn => recipe.rows.to_string(),
                    TrainingSet::Full => "full set".to_owned(),
                },
                recipe.validation_rows.to_string(),
                recipe.epochs.to_string(),
                recipe.grid_epochs.to_string(),
                recipe.batch.to_string(),
                recipe.instruction_set.name().to_owned(),
                facts.training_id.clone(),
            ]
        })
        .collect()
}
