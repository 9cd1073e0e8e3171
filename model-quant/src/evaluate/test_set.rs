//! Test rows with their histories, and the forces that networks give for them.

use crate::data::draw::{Draw, HistorySet, Purpose};
use crate::data::features::FloatFeatures;
use crate::data::rows::{Row, draw_rows};
use crate::data::window::draw_history;
use crate::network::checkpoint::Checkpoint;
use crate::network::float_pair::{FloatEstimate, FloatPair};
use crate::quantise::image::{AnyModel, AnyPair};
use inference::{ContactState, Estimate, WINDOW};
use rayon::prelude::*;

/// Number of test rows in a verification.
pub(crate) const TEST_ROWS: usize = 20_000;

pub(super) fn forces_n(estimate: &Estimate) -> [f64; 2] {
    [estimate.normal_force_mn, estimate.friction_force_mn].map(|force_mn| f64::from(force_mn) / 1000.0)
}

pub(super) fn float_forces_n(estimate: &FloatEstimate) -> [f64; 2] {
    [f64::from(estimate.normal_force_n), f64::from(estimate.friction_force_n)]
}

/// Draws the first rows of a checkpoint's test set with their histories.
pub fn draw_test_set(checkpoint: &Checkpoint, count: usize) -> Vec<(Row, [ContactState; WINDOW])> {
    let recipe = &checkpoint.recipe;
    let features = FloatFeatures::from_header(&checkpoint.header());
    (draw_rows(checkpoint.bearing, recipe.range, recipe.seed, Purpose::TestRows, count)
        .into_par_iter()
        .enumerate())
    .map(|(index, row)| {
        let mut draw = Draw::history(recipe.seed, HistorySet::Test, index as u64);
        (row, draw_history(&features, &row, &mut draw))
    })
    .collect()
}

/// Normal and friction force in N of float networks after each history.
pub(crate) fn float_forces_after(set: &[(Row, [ContactState; WINDOW])], pair: &FloatPair) -> Vec<[f64; 2]> {
    set.par_iter()
        .map_init(
            || pair.clone(),
            |pair, (_, states)| {
                pair.reset();
                float_forces_n(&states.map(|state| pair.push(&state))[WINDOW - 1])
            },
        )
        .collect()
}

/// Normal and friction force in N of an image after each history.
pub(crate) fn image_forces_after(
    set: &[(Row, [ContactState; WINDOW])],
    model: AnyModel<'_>,
) -> Vec<[f64; 2]> {
    set.par_iter()
        .map_init(
            || AnyPair::new(model),
            |pair, (_, states)| {
                pair.reset();
                forces_n(&states.map(|state| pair.push(&state))[WINDOW - 1])
            },
        )
        .collect()
}
