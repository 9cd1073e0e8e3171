//! Least squares on the simulation error with Gaussian priors: Gauss-Newton within bounds and a trust region.
//!
//! The region is a ball in scaled parameters, so that "near" means standard deviations of what is uncertain: logs are so
//! precise that a clearance off by a few deviations starts hundreds of noise levels away, and an unguarded step
//! would go wherever the linearisation points.
//!
//! Sensitivities are finite differences of whole simulations, computed in parallel and put together in order, so that
//! the number of threads changes nothing. A parameter that only concerns a sensor needs no simulation of the plant, but for the
//! first delay or bandwidth of a log whose sensors were prompt: a late sensor reads between the samples.

use crate::linear::{dot, factor, gram, project};
use crate::model::Model;
use crate::noise::NoiseModel;
use crate::nuisance::PerSession;
use crate::parameter::Parameter;
use crate::session::{Columns, Data};
use crate::step::bounded_step;
use bench::Bench;
use bench::respond::{RespondError, Response, Truth, sensed};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::sync::Arc;

/// First radius of the trust region, in scaled units, and the one that ends a fit.
const FIRST_RADIUS: f64 = 2.0;
const LAST_RADIUS: f64 = 1e-4;
/// Fall of the objective that ends a fit: absolute, and as a share of what is above the noise.
const ENOUGH: f64 = 0.02;
const ENOUGH_SHARE: f64 = 3e-4;

/// Factor on its information that holds a parameter in place, but for a ten-thousandth.
const HELD: f64 = 1e4;

/// A bench simulated under all sessions.
pub(crate) struct Simulation {
    /// Resolved and without sensors, one a session: what the truths depend on, but for how fine they are.
    plants: Vec<Bench>,
    truths: Vec<Arc<Truth>>,
    pub(crate) columns: Columns,
}

fn without_sensors(resolved: &Bench) -> Bench {
    let mut bench = resolved.clone();
    match &mut bench {
        Bench::Transmission(b) => b.sensors.clear(),
        Bench::FrictionRig(r) => r.sensors.clear(),
    }
    bench
}

/// Simulates a bench, or one a session; takes the truths of `known` where a session's plant is the same.
pub(crate) fn simulate(
    data: &Data,
    benches: &impl PerSession,
    known: Option<&Simulation>,
) -> Result<Simulation, RespondError> {
    let resolved: Vec<Bench> = data.sessions.iter().map(|s| benches.of(s.number).resolved()).collect();
    let plants: Vec<Bench> = resolved.iter().map(without_sensors).collect();
    let truth_of = |i: usize| {
        let (bench, inputs) = (&resolved[i], &data.sessions[i].inputs);
        let same = known.filter(|k| k.plants.get(i) == plants.get(i)).and_then(|k| k.truths.get(i));
        let same = same.filter(|truth| truth.serves(bench, inputs));
        let anew = || Truth::of(bench, inputs).map(Arc::new);
        same.map_or_else(anew, |truth| Ok(Arc::clone(truth)))
    };
    let truths = (0..resolved.len()).into_par_iter().map(truth_of).collect::<Result<Vec<_>, _>>()?;
    let sessions = data.sessions.iter().zip(&resolved).zip(&truths);
    let responses: Vec<Response> = sessions.map(|((s, bench), t)| sensed(bench, &s.inputs, t)).collect();
    Ok(Simulation { plants, truths, columns: data.columns(&responses) })
}

/// A fitted model.
pub(crate) struct Fit {
    pub(crate) model: Model,
    /// Scaled parameters.
    pub(crate) z: Vec<f64>,
    pub(crate) simulation: Simulation,
    /// Weighted residual of the fitted samples.
    pub(crate) residual: Vec<f64>,
    /// Weighted sensitivities of the fitted samples.
    pub(crate) jacobian: Vec<Vec<f64>>,
    /// Chi-square of data and priors.
    pub(crate) objective: f64,
    /// Whether it was taken to the optimum, with sensitivities that hold there.
    pub(crate) settled: bool,
}

impl Fit {
    /// `J'J`: what the data say.
    pub(crate) fn fisher(&self) -> DMatrix<f64> {
        gram(&self.jacobian)
    }

    /// `J'J` plus the priors' unit rows.
    pub(crate) fn information(&self) -> DMatrix<f64> {
        with_priors(&self.model, self.fisher())
    }

    /// The same with what stops at a bound held there: it takes up nothing of what is added.
    pub(crate) fn held_information(&self) -> DMatrix<f64> {
        let mut information = self.information();
        for (i, _) in self.stopped().into_iter().enumerate().filter(|(_, stopped)| *stopped) {
            information[(i, i)] *= HELD;
        }
        information
    }

    /// Which declared parameters have gone as far as they may.
    pub(crate) fn stopped(&self) -> Vec<bool> {
        let stops = |(p, z): (&Parameter, &f64)| p.is_declared() && p.bound_at(*z).is_some();
        self.model.parameters.iter().zip(&self.z).map(stops).collect()
    }

    /// The objective in units of another noise.
    pub(crate) fn objective_with(&self, data: &Data, noise: &NoiseModel) -> f64 {
        let residual = noise.stack(data, &data.residual(&self.simulation.columns));
        dot(&residual, &residual) + prior(&self.model, &self.z)
    }

    /// Gradient that is left, 0 at the optimum.
    pub(crate) fn gradient(&self) -> DVector<f64> {
        gradient(&self.model, &self.jacobian, &self.residual, &self.z)
    }

    /// Standard deviations in scaled units.
    pub(crate) fn deviations(&self) -> Vec<f64> {
        let information = self.information();
        let inverse = factor(&information).map(|c| c.inverse());
        let of = |i: usize| inverse.as_ref().map_or(f64::INFINITY, |m| m[(i, i)].max(0.0).sqrt());
        (0..information.nrows()).map(of).collect()
    }
}

fn with_priors(model: &Model, mut information: DMatrix<f64>) -> DMatrix<f64> {
    for (i, p) in model.parameters.iter().enumerate() {
        information[(i, i)] += p.precision;
    }
    information
}

fn gradient(model: &Model, jacobian: &[Vec<f64>], residual: &[f64], z: &[f64]) -> DVector<f64> {
    let mut g = project(jacobian, residual);
    for (i, p) in model.parameters.iter().enumerate() {
        g[i] -= p.precision * z[i];
    }
    g
}

/// Weighted sensitivities of the fitted samples to the parameters `which` at `z`.
///
/// An effect that moves the very number that an uncertain parameter moves has that parameter's sensitivity, exactly:
/// two finite differences would differ by their curvature, and with thousands of precise samples that difference would
/// pass for information.
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
        let (least, most) = model.parameters[i].bounds();
        // Central, or at a bound the one-sided difference of second order: values and weights.
        let [near, far, here, one, two] = if z[i] + step > most {
            [-step, -2.0 * step, 3.0, -4.0, 1.0]
        } else if z[i] - step < least {
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

/// How much a fit may cost.
#[derive(Clone, Copy)]
pub(crate) struct Effort {
    iterations: usize,
    jacobians: usize,
}

impl Effort {
    /// To the optimum.
    pub(crate) const FULL: Self = Self { iterations: 40, jacobians: 12 };
    /// To the optimum, unless the way is so long that it is the wrong one.
    pub(crate) const FAIR: Self = Self { iterations: 24, jacobians: 4 };
    /// To see whether it leads anywhere.
    pub(crate) const GLANCE: Self = Self { iterations: 10, jacobians: 1 };
}

/// Fits `model` from the scaled start `z`.
pub(crate) fn fit(data: &Data, noise: &NoiseModel, model: Model, z: Vec<f64>) -> Result<Fit, RespondError> {
    fit_from(data, noise, model, z, None, Effort::FULL)
}

/// Fits `model` from the scaled start `z`, with sensitivities that hold near it, where known.
///
/// Between fresh sensitivities Broyden's rank-one updates serve, as long as steps keep their promise.
pub(crate) fn fit_from(
    data: &Data,
    noise: &NoiseModel,
    model: Model,
    mut z: Vec<f64>,
    jacobian: Option<Vec<Vec<f64>>>,
    effort: Effort,
) -> Result<Fit, RespondError> {
    let bounds: Vec<(f64, f64)> = model.parameters.iter().map(Parameter::bounds).collect();
    z.iter_mut().zip(&bounds).for_each(|(z, (least, most))| *z = z.clamp(*least, *most));
    let mut simulation = simulate(data, &model.at(&z), None)?;
    let mut residual = noise.stack(data, &data.residual(&simulation.columns));
    let mut objective = dot(&residual, &residual) + prior(&model, &z);
    let all: Vec<usize> = (0..model.parameters.len()).collect();
    let mut stale = jacobian.is_some();
    let mut jacobian = match jacobian {
        Some(jacobian) => jacobian,
        None => sensitivities(data, noise, &model, &z, &simulation, &all)?,
    };
    let (mut radius, mut fresh) = (FIRST_RADIUS, usize::from(!stale));
    for _ in 0..effort.iterations {
        let information = with_priors(&model, gram(&jacobian));
        let g = gradient(&model, &jacobian, &residual, &z);
        let Some(step) = bounded_step(&information, &g, &z, &bounds, radius) else { break };
        let length = step.norm();
        let promised = 2.0 * g.dot(&step) - (&information * &step).dot(&step);
        let enough = ENOUGH.max(ENOUGH_SHARE * (objective - residual.len() as f64));
        let trial: Vec<f64> = z.iter().zip(step.iter()).map(|(z, s)| z + s).collect();
        let mut renew = promised < enough;
        if !renew {
            // A parameter set that the plant cannot take is a step that does not help.
            let tried = simulate(data, &model.at(&trial), Some(&simulation)).ok().map(|there| {
                let residual = noise.stack(data, &data.residual(&there.columns));
                let objective = dot(&residual, &residual) + prior(&model, &trial);
                (there, residual, objective)
            });
            match tried {
                Some((there, there_residual, there_objective))
                    if objective - there_objective > 1e-3 * promised =>
                {
                    let kept = (objective - there_objective) / promised;
                    update(&mut jacobian, &residual, &there_residual, &step);
                    (z, simulation, residual, objective) = (trial, there, there_residual, there_objective);
                    stale = true;
                    renew = kept < 0.5;
                    if kept > 0.75 && length > 0.8 * radius {
                        radius *= 3.0;
                    } else if kept < 0.25 {
                        radius = 0.4 * length.min(radius);
                    }
                }
                _ if stale => renew = true,
                _ => {
                    radius = 0.25 * length.min(radius);
                    if radius < LAST_RADIUS {
                        break;
                    }
                }
            }
        }
        if renew {
            if !stale {
                // Fresh sensitivities promise nothing more, or have just been followed.
                break;
            }
            if promised < enough && effort.jacobians <= 1 {
                // Good enough to see whether it leads anywhere.
                break;
            }
            if fresh >= effort.jacobians {
                if promised < enough {
                    break;
                }
                radius *= 0.5;
                continue;
            }
            jacobian = sensitivities(data, noise, &model, &z, &simulation, &all)?;
            (stale, fresh) = (false, fresh + 1);
        }
    }
    if effort.jacobians > 1 {
        if stale {
            jacobian = sensitivities(data, noise, &model, &z, &simulation, &all)?;
        }
        // Where an effect and an uncertain parameter move one number, a fit ends anywhere in a valley that bends.
        let trial = model.unaliased(&z);
        if prior(&model, &trial) < prior(&model, &z) {
            let there = simulate(data, &model.at(&trial), Some(&simulation))?;
            let there_residual = noise.stack(data, &data.residual(&there.columns));
            let there_objective = dot(&there_residual, &there_residual) + prior(&model, &trial);
            if there_objective < objective {
                jacobian = sensitivities(data, noise, &model, &trial, &there, &all)?;
                (z, simulation, residual, objective) = (trial, there, there_residual, there_objective);
            }
        }
    }
    Ok(Fit { model, z, simulation, residual, jacobian, objective, settled: effort.jacobians > 1 })
}

/// Broyden's update: the least change of the sensitivities that explains the last step.
fn update(jacobian: &mut [Vec<f64>], before: &[f64], after: &[f64], step: &DVector<f64>) {
    let square = step.norm_squared();
    if square <= 0.0 {
        return;
    }
    let mut missed: Vec<f64> = before.iter().zip(after).map(|(b, a)| b - a).collect();
    for (column, s) in jacobian.iter().zip(step.iter()) {
        missed.iter_mut().zip(column).for_each(|(m, c)| *m -= s * c);
    }
    for (column, s) in jacobian.iter_mut().zip(step.iter()) {
        column.iter_mut().zip(&missed).for_each(|(c, m)| *c += m * s / square);
    }
}

fn prior(model: &Model, z: &[f64]) -> f64 {
    z.iter().zip(&model.parameters).map(|(z, p)| p.precision * z * z).sum()
}
