//! Test windows with the outputs of the float networks, as reference for other runtimes.

use super::samples::Samples;
use crate::data::draw::{Draw, HistorySet, Purpose};
use crate::data::features::FloatFeatures;
use crate::data::rows::draw_rows;
use crate::data::window;
use crate::network::NetworkKind;
use crate::network::checkpoint::Checkpoint;

/// Number of windows.
const WINDOWS: usize = 256;

/// Windows of one network of a checkpoint, with its outputs.
pub(crate) fn generate_samples(checkpoint: &Checkpoint, which: NetworkKind) -> Samples {
    let recipe = &checkpoint.recipe;
    let features = FloatFeatures::from_header(&checkpoint.header());
    let network = &checkpoint.trained(which).float;
    let drawn = draw_rows(checkpoint.bearing, recipe.range, recipe.seed, Purpose::TestRows, WINDOWS);
    let windows: Vec<Vec<f32>> = (drawn.iter().enumerate())
        .map(|(index, row)| {
            let mut draw = Draw::history(recipe.seed, HistorySet::Test, index as u64);
            match which {
                NetworkKind::Collision => {
                    window::draw_collision_window(&features, row, &mut draw).columns.as_flattened().to_vec()
                }
                NetworkKind::Friction => {
                    window::draw_friction_window(&features, row, &mut draw).columns.as_flattened().to_vec()
                }
            }
        })
        .collect();
    let outputs = windows.iter().map(|window| network.evaluate(window)).collect();
    Samples { windows, outputs }
}
