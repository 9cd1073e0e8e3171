//! Windows of the test set and what the float networks give for them, to check other runtimes with.

use super::description::Which;
use super::samples::Samples;
use super::weights::trained;
use crate::checkpoint::Checkpoint;
use crate::draw::{Draw, Purpose};
use crate::features::FloatFeatures;
use crate::rows::rows;
use crate::window;

/// Number of windows.
const WINDOWS: usize = 256;

/// Windows of one network of a checkpoint.
pub fn windows(checkpoint: &Checkpoint, which: Which) -> Samples {
    let recipe = &checkpoint.recipe;
    let features = FloatFeatures::of(&checkpoint.header());
    let network = &trained(checkpoint, which).float;
    let drawn = rows(checkpoint.bearing, recipe.range, recipe.seed, Purpose::TestRows, WINDOWS);
    let windows: Vec<Vec<f32>> = (drawn.iter().enumerate())
        .map(|(index, row)| {
            let mut draw = Draw::new(recipe.seed, Purpose::FixedHistories, 2 << 32 | index as u64);
            match which {
                Which::Collision => {
                    window::collision(&features, row, &mut draw).columns.as_flattened().to_vec()
                }
                Which::Friction => {
                    window::friction(&features, row, &mut draw).columns.as_flattened().to_vec()
                }
            }
        })
        .collect();
    let outputs = windows.iter().map(|window| network.evaluate(window)).collect();
    Samples { windows, outputs }
}
