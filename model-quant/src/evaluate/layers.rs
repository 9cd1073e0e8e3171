//! Quantisation error of single layers: one layer in fixed point, everything else in floats.
//!
//! The error is the change of the final force against the float networks in N over rows of the test
//! set: the normal force for the collision network, the friction force (with the normal force in
//! floats) for the friction network.
//!
//! "Weights" rounds the float weights of one layer to the mode's grid. In the 8-bit modes the image
//! contains other weights: those that were trained on the grid. Their common error is a separate
//! line, because the layers compensate each other in that training. Biases and sums have 32 bits
//! and stay in floats.

use crate::data::rows::Row;
use crate::data::statistics::mean;
use crate::evaluate::test_set::{draw_test_set, float_forces_after, image_forces_after};
use crate::evaluate::verdict::BANDS_N;
use crate::network::checkpoint::Checkpoint;
use crate::network::float_pair::{ActivationGrid, FloatPair, Rounding};
use crate::network::{LAYERS, Network};
use crate::quantise::Quantised;
use crate::quantise::fixed_point::{Activations, quantise_channels, set_layer_weights};
use crate::quantise::image::AnyModel;
use crate::quantise::mode::{Mode, Plan};
use inference::{Header, ImageError};
use serde::Serialize;

/// Rows of the test set in every measurement.
pub(crate) const LAYER_ROWS: usize = 8192;

/// Effect of one quantisation step in one band of the law's normal force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LayerBand {
    /// Upper end of the band in N.
    pub up_to_n: f64,
    /// Mean absolute change in N.
    pub mae_n: f64,
    /// Largest absolute change in N.
    pub largest_n: f64,
}

/// Effect of one quantisation step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayerError {
    /// `collision` or `friction`.
    pub network: &'static str,
    /// Part of the network in fixed point.
    pub quantised: String,
    /// Mean absolute change over all rows in N.
    pub mae_n: f64,
    /// Changes in each band.
    pub bands: Vec<LayerBand>,
}

const LAYER_NAMES: [&str; LAYERS] = ["convolution 1", "convolution 2", "convolution 3", "head"];

type Nets = [Network; 2];

fn activation_grid(activations: &Activations) -> ActivationGrid {
    ActivationGrid { step: activations.step as f32, max_level: activations.full_scale() as f32 }
}

/// Rounds the weights of one layer.
fn rounded(network: &Network, layer: usize, inputs: &Activations, mode: Mode) -> Network {
    let on_grid = quantise_channels(network, layer, inputs, mode);
    let mut network = network.clone();
    set_layer_weights(&mut network, layer, &on_grid);
    network
}

/// Float networks with one part of one of them in fixed point.
struct Case {
    network: usize,
    quantised: String,
    nets: Nets,
    rounding: [Rounding; 2],
}

fn cases(checkpoint: &Checkpoint, quantised: &Quantised, plan: Plan) -> Vec<Case> {
    let float = [checkpoint.collision.float.clone(), checkpoint.friction.float.clone()];
    let none = [[None; LAYERS]; 2];
    let mut cases = Vec::new();
    for (network, activations) in quantised.activations.iter().enumerate() {
        let inputs = |layer: usize| match layer.checked_sub(1).and_then(|before| activations.get(before)) {
            Some(before) => *before,
            None => Activations::FEATURES,
        };
        let mut add = |quantised: String, nets: Nets, rounding| {
            cases.push(Case { network, quantised, nets, rounding });
        };
        let mut all = none;
        for place in 0..LAYERS {
            let mut rounding = none;
            rounding[network][place] = Some(activation_grid(&inputs(place)));
            all[network][place] = rounding[network][place];
            let name = match place.checked_sub(1) {
                None => "features".to_owned(),
                Some(layer) => format!("activations of {}", LAYER_NAMES[layer]),
            };
            add(name, float.clone(), rounding);
        }
        add("all activations".to_owned(), float.clone(), all);
        let round = |nets: &Nets, layer: usize| {
            let mut nets = nets.clone();
            nets[network] = rounded(&nets[network], layer, &inputs(layer), plan.mode);
            nets
        };
        for (layer, name) in LAYER_NAMES.into_iter().enumerate() {
            add(format!("weights of {name}"), round(&float, layer), none);
        }
        add(
            "all weights".to_owned(),
            (0..LAYERS).fold(float.clone(), |nets, layer| round(&nets, layer)),
            none,
        );
        if plan.mode.has_narrow_weights() {
            let mut tuned = float.clone();
            tuned[network] = [&checkpoint.collision, &checkpoint.friction][network].tuned.clone();
            add("all weights, trained on".to_owned(), tuned, none);
        }
    }
    cases
}

/// Measures every quantisation step over the first [`LAYER_ROWS`] rows of the test set.
///
/// # Errors
///
/// The image does not load.
pub fn layer_errors(
    checkpoint: &Checkpoint,
    quantised: &Quantised,
    plan: Plan,
) -> Result<Vec<LayerError>, ImageError> {
    let header: Header = checkpoint.header();
    let model = AnyModel::load(&quantised.image)?;
    let set = draw_test_set(checkpoint, LAYER_ROWS);
    let float = float_forces_after(&set, &FloatPair::from_checkpoint(checkpoint));
    let image = image_forces_after(&set, model);
    let highest_n = f64::from(header.normal_force_n().high);
    let error = |network: usize, quantised: String, found: &[[f64; 2]]| {
        let changes: Vec<(f64, f64)> = (set.iter().zip(found).zip(&float))
            .map(|((row, found), float): ((&(Row, _), _), _)| {
                let change: f64 = found[network] - float[network];
                (row.0.normal_force_n, change.abs())
            })
            .collect();
        LayerError {
            network: ["collision", "friction"][network],
            quantised,
            mae_n: mean(changes.iter().map(|(_, change)| *change)),
            bands: bands(&changes, highest_n),
        }
    };
    let mut errors = Vec::new();
    let mut cases = cases(checkpoint, quantised, plan).into_iter().peekable();
    for network in 0..2 {
        while let Some(case) = cases.next_if(|case| case.network == network) {
            let found = float_forces_after(&set, &FloatPair::with_rounding(header, case.nets, case.rounding));
            errors.push(error(network, case.quantised, &found));
        }
        errors.push(error(network, "image, both networks".to_owned(), &image));
    }
    Ok(errors)
}

fn bands(changes: &[(f64, f64)], highest_n: f64) -> Vec<LayerBand> {
    let mut low = -1.0;
    (BANDS_N.into_iter().chain([highest_n]))
        .map(|up_to_n| {
            let inside =
                || changes.iter().filter(|(law, _)| *law > low && *law <= up_to_n).map(|pair| pair.1);
            let band = LayerBand { up_to_n, mae_n: mean(inside()), largest_n: inside().fold(0.0, f64::max) };
            low = up_to_n;
            band
        })
        .collect()
}
