//! Figures of one bearing in the training report.

use super::ReportError;
use crate::evaluate::layers::{LayerError, layer_errors};
use crate::evaluate::test_set::{draw_test_set, image_forces_after};
use crate::evaluate::verdict::Verdict;
use crate::evaluate::verify::add_held_out_errors;
use crate::evaluate::verify::verify;
use crate::network::checkpoint::Checkpoint;
use crate::network::recipe::Recipe;
use crate::quantise::image::AnyModel;
use crate::quantise::mode::{Mode, Packing, Plan};
use crate::quantise::quantise;
use crate::report::torque::{self, Curve};
use crate::train::history::History;
use serde::Serialize;

/// Number of test rows that are plotted as points.
const PLOTTED_ROWS: usize = 600;

/// Error of one quantisation mode.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct ModeFacts {
    /// Widths of weights and activations.
    pub mode: Mode,
    /// Size of the image in bytes.
    pub bytes: usize,
    /// Mean absolute difference from the float networks in N: normal force, friction.
    pub mae_quantisation_n: [f64; 2],
    /// Largest difference from the float networks in N.
    pub largest_quantisation_n: [f64; 2],
    /// R^2 against the law.
    pub r2_quantised: [f64; 2],
}

/// Forces in N at one test row: law, image; each normal force and friction.
pub(crate) type PlottedRow = [[f64; 2]; 2];

/// All figures of a bearing's networks.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct BearingFacts {
    /// Bearing.
    pub bearing: &'static str,
    /// Training id in hexadecimal.
    pub training_id: String,
    /// Recipe of the training.
    pub recipe: Recipe,
    /// Errors of the default image, collision first.
    pub verdicts: [Verdict; 2],
    /// Error of each quantisation step.
    pub layers: Vec<LayerError>,
    /// Errors of every mode.
    pub modes: Vec<ModeFacts>,
    /// Torque over load and speed.
    pub torque: Vec<Curve>,
    /// Torque over load at the speeds of the map.
    pub torque_map: Vec<Curve>,
    /// Errors over the epochs, if known.
    pub history: Option<History>,
    /// Forces at some test rows.
    #[serde(skip)]
    pub plotted: Vec<PlottedRow>,
}

impl BearingFacts {
    /// Quantises a checkpoint and measures it.
    ///
    /// # Errors
    ///
    /// The checkpoint cannot be quantised, or the bench cannot be simulated.
    pub(crate) fn measure(
        checkpoint: &Checkpoint,
        training_id: u64,
        history: Option<History>,
    ) -> Result<Self, ReportError> {
        let plan = Plan::default();
        let quantised = quantise(checkpoint, training_id, plan)?;
        let model = AnyModel::load(&quantised.image)?;
        let verdicts =
            add_held_out_errors(verify(checkpoint, training_id, &quantised.image)?, checkpoint, model)?;
        let set = draw_test_set(checkpoint, PLOTTED_ROWS);
        let found = image_forces_after(&set, model);
        let plotted = set
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
            plotted: plotted.collect(),
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
