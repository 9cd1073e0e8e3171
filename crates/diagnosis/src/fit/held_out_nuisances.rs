//! Nuisance parameters of held-out logs, fitted on the calibration samples of each of them.

use super::least_squares::{Fit, fit};
use super::model::Model;
use super::simulation::{Simulation, simulate};
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use bench::simulate::RespondError;

/// Simulates a fitted model for all logs; returns the fit of the held-out logs' nuisance parameters
/// too, if any are declared.
pub(crate) fn simulate_all(
    data: &Data,
    noise: &NoiseModel,
    model: &Model,
    z: &[f64],
) -> Result<(Simulation, Option<Fit>), RespondError> {
    let mut benches = model.at(z);
    let held_out = match data.calibration_view() {
        Some(calibration) => {
            let model = model.fixed_at(z).with_nuisances(&calibration);
            let start = vec![0.0; model.parameters.len()];
            if start.is_empty() { None } else { Some(fit(&calibration, noise, model, start)?) }
        }
        None => None,
    };
    if let Some(fit) = &held_out {
        benches.own.extend(fit.model.at(&fit.z).own);
    }
    Ok((simulate(data, &benches, None)?, held_out))
}
