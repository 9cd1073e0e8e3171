//! What a training report tells of a bearing.

use super::ReportError;
use super::history::History;
use super::torque::{self, Curve};
use crate::checkpoint::Checkpoint;
use crate::held_out::judged;
use crate::image::AnyModel;
use crate::layers::{LayerError, layer_errors};
use crate::mode::{Mode, Packing, Plan};
use crate::quantise::quantise;
use crate::recipe::Recipe;
use crate::verify::{Verdict, image_forces_after, test_set, verify};
use serde::Serialize;

/// Rows whose forces are drawn one by one.
const DRAWN_ROWS: usize = 600;

/// A mode of quantisation and what it costs.
#[derive(Clone, Debug, Serialize)]
pub struct ModeFacts {
    /// Widths of weights and activations.
    pub mode: Mode,
    /// Size of the image.
    pub bytes: usize,
    /// Mean absolute difference from the float networks in N: normal force, friction.
    pub mae_quantisation_n: [f64; 2],
    /// Largest difference from the float networks in N.
    pub largest_quantisation_n: [f64; 2],
    /// R^2 against the law.
    pub r2_quantised: [f64; 2],
}

/// Forces in N at one test row: law, image; each normal force and friction.
pub type DrawnRow = [[f64; 2]; 2];

/// Everything about a bearing's networks.
#[derive(Clone, Debug, Serialize)]
pub struct BearingFacts {
    /// Bearing.
    pub bearing: &'static str,
    /// Training id in hexadecimal.
    pub training_id: String,
    /// What they were trained with.
    pub recipe: Recipe,
    /// Errors of the default image, collision first.
    pub verdicts: [Verdict; 2],
    /// What each layer's quantisation costs.
    pub layers: Vec<LayerError>,
    /// Every mode.
    pub modes: Vec<ModeFacts>,
    /// Torque over load and speed.
    pub torque: Vec<Curve>,
    /// The same at the speeds of the map.
    pub torque_map: Vec<Curve>,
    /// Errors over the epochs, where they are known.
    pub history: Option<History>,
    /// Some test rows.
    #[serde(skip)]
    pub drawn: Vec<DrawnRow>,
}

impl BearingFacts {
    /// Quantises a checkpoint and measures.
    ///
    /// # Errors
    ///
    /// It cannot be quantised, or the bench cannot be run.
    pub fn of(
        checkpoint: &Checkpoint,
        training_id: u64,
        history: Option<History>,
    ) -> Result<Self, ReportError> {
        let plan = Plan::default();
        let quantised = quantise(checkpoint, training_id, plan)?;
        let model = AnyModel::load(&quantised.image)?;
        let verdicts = judged(verify(checkpoint, training_id, &quantised.image)?, checkpoint, model)?;
        let set = test_set(checkpoint, DRAWN_ROWS);
        let found = image_forces_after(&set, model);
        let drawn = set
            .iter()
            .zip(found)
            .map(|((row, _), image)| [[row.normal_force_n, row.friction_force_n], image]);
        Ok(Self {
            bearing: checkpoint.bearing.name(),
            training_id: format!("{training_id:016x}"),
            recipe: checkpoint.recipe.clone(),
            layers: layer_errors(checkpoint, &quantised, plan)?,
            modes: modes(checkpoint, training_id)?,
            torque: torque::curves(model, &torque::speeds(&model.header())),
            torque_map: torque::curves(model, &torque::SPEEDS_M_S),
            history,
            drawn: drawn.collect(),
            verdicts,
        })
    }
}

fn modes(checkpoint: &Checkpoint, training_id: u64) -> Result<Vec<ModeFacts>, ReportError> {
    let one = |mode: Mode| {
        let quantised = quantise(checkpoint, training_id, Plan { mode, packing: Packing::Speed })?;
        let verdicts = verify(checkpoint, training_id, &quantised.image)?;
        Ok(ModeFacts {
            mode,
            bytes: quantised.image.len(),
            mae_quantisation_n: verdicts.each_ref().map(|v| v.mae_quantisation_n),
            largest_quantisation_n: verdicts.each_ref().map(|v| v.largest_quantisation_n),
            r2_quantised: verdicts.each_ref().map(|v| v.r2_quantised),
        })
    };
    Mode::ALL.into_iter().map(one).collect()
}
