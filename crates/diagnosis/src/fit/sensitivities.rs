//! Finite-difference sensitivities of simulated outputs to the parameters of a model.
//!
//! Columns are computed in parallel and assembled in order, so the number of threads changes
//! nothing. A parameter of a sensor needs no new simulation of the plant. The exception is the
//! first delay or bandwidth of a log with undelayed sensors, because a delayed sensor reads between
//! the samples.

use super::model::Model;
use super::simulation::{Simulation, simulate};
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use bench::simulate::RespondError;
use rayon::prelude::*;

/// Weighted sensitivities of the fitted samples to the parameters `which` at `z`.
///
/// An effect that changes the same number as a declared parameter gets exactly that parameter's
/// sensitivity. Two finite differences would differ by their curvature, and with thousands of
/// precise samples that difference would look like information.
pub(crate) fn sensitivities(
    data: &Data,
    noise: &NoiseModel,
    model: &Model,
    z: &[f64],
    at: &Simulation,
    which: &[usize],
) -> Result<Vec<Vec<f64>>, RespondError> {
    let column = |i: usize| -> Result<Vec<f64>, RespondError> {
        let step = model.parameters[i].step();
        let (min, max) = model.parameters[i].bounds();
        // Steps and weights of a central difference, or of a one-sided one of second order at a
        // bound.
        let [near, far, here, one, two] = if z[i] + step > max {
            [-step, -2.0 * step, 3.0, -4.0, 1.0]
        } else if z[i] - step < min {
            [step, 2.0 * step, -3.0, 4.0, -1.0]
        } else {
            [step, -step, 0.0, 1.0, -1.0]
        };
        let moved = |by: f64| {
            let mut z = z.to_vec();
            z[i] += by;
            simulate(data, &model.at(&z), Some(at))
        };
        let (near, far) = rayon::join(|| moved(near), || moved(far));
        let (near, far) = (near?.columns, far?.columns);
        let mut difference = at.columns.clone();
        for ((d, n), f) in difference.iter_mut().zip(&near).zip(&far) {
            for ((d, n), f) in d.iter_mut().zip(n).zip(f) {
                *d = (here * *d + one * n + two * f) / (2.0 * step);
            }
        }
        Ok(noise.stack(data, &difference))
    };
    let aliases: Vec<(usize, f64)> = which.iter().map(|&i| model.alias(z, i).unwrap_or((i, 1.0))).collect();
    let mut own: Vec<usize> = aliases.iter().map(|a| a.0).collect();
    own.sort_unstable();
    own.dedup();
    let columns: Vec<Vec<f64>> = own.par_iter().map(|&i| column(i)).collect::<Result<_, _>>()?;
    let scaled = |&(i, factor): &(usize, f64)| -> Vec<f64> {
        let place = own.binary_search(&i).unwrap_or_default();
        columns.get(place).map_or_else(Vec::new, |c| c.iter().map(|v| factor * v).collect())
    };
    Ok(aliases.iter().map(scaled).collect())
}
