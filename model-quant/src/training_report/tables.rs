//! The rows of a training report's tables.

use super::facts::BearingFacts;
use super::rig::{GroupFacts, RigFacts};
use crate::recipe::TrainingSet;

/// A number in three figures.
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
                figures(force_n * crate::errors::FRICTION_RADIUS_M)
            } else {
                "-".into()
            }
        };
        rows.push(vec![
            verdict.bearing.to_owned(),
            verdict.network.to_owned(),
            format!("test rows, {}", verdict.rows),
            format!("{:.6}", verdict.r2_quantised),
            format!("{:.6}", verdict.r2_float),
            figures(verdict.mae_n),
            torque(verdict.mae_n),
            format!("{:.3}", 100.0 * verdict.mae_share_of_p99),
            figures(verdict.largest_n),
        ]);
        if let Some(held_out) = &verdict.held_out {
            let (image, float) = (&held_out.image, &held_out.float);
            rows.push(vec![
                verdict.bearing.to_owned(),
                verdict.network.to_owned(),
                format!("held-out bench runs, {}", held_out.runs),
                format!("{:.6}", image.r2),
                format!("{:.6}", float.r2),
                figures(image.mae_n),
                torque(image.mae_n),
                format!("{:.3}", 100.0 * image.mae_share_of_p99),
                figures(image.largest_n),
            ]);
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

/// What every mode of quantisation costs.
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

/// What the networks were trained with.
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
