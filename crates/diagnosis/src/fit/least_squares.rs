//! Least squares on the simulation error with Gaussian priors: Gauss-Newton within bounds and a
//! trust region.
//!
//! The trust region is a ball in scaled parameters, so its radius counts standard deviations of the
//! uncertain parameters. Logs are so precise that a clearance that is wrong by a few deviations
//! causes an error of hundreds of noise levels. An unlimited step would follow the linearisation
//! far beyond its range.

use super::linear::{cholesky, dot, gram, project};
use super::model::Model;
use super::parameter::Parameter;
use super::sensitivities::sensitivities;
use super::simulation::{Simulation, simulate};
use super::trust_region::bounded_step;
use super::tuning;
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use bench::simulate::RespondError;
use nalgebra::{DMatrix, DVector};

/// A fitted model.
pub(crate) struct Fit {
    pub(crate) model: Model,
    /// Scaled parameters.
    pub(crate) z: Vec<f64>,
    pub(crate) simulation: Simulation,
    /// Weighted residual of the fitted samples.
    pub(crate) residual: Vec<f64>,
    /// Weighted sensitivities of the fitted samples, one column per parameter.
    pub(crate) jacobian: Vec<Vec<f64>>,
    /// Chi-square of data and priors.
    pub(crate) objective: f64,
    /// True if the fit ran to its optimum, with sensitivities that hold there.
    pub(crate) is_converged: bool,
}

impl Fit {
    /// Information of the data, `J'J`.
    pub(crate) fn fisher(&self) -> DMatrix<f64> {
        gram(&self.jacobian)
    }

    /// Information of data and priors, `J'J + P`.
    pub(crate) fn information(&self) -> DMatrix<f64> {
        with_priors(&self.model, self.fisher())
    }

    /// [`Self::information`] with declared parameters at a bound fixed there, so that they absorb
    /// nothing of an added effect.
    pub(crate) fn information_with_bounds_fixed(&self) -> DMatrix<f64> {
        let mut information = self.information();
        for (i, is_at_bound) in self.at_bound().into_iter().enumerate() {
            if is_at_bound {
                information[(i, i)] *= tuning::BOUND_STIFFNESS;
            }
        }
        information
    }

    /// Returns true for each parameter that is declared and lies on a bound of calibration.
    pub(crate) fn at_bound(&self) -> Vec<bool> {
        let is_at_bound = |(p, z): (&Parameter, &f64)| p.is_declared() && p.bound_at(*z).is_some();
        self.model.parameters.iter().zip(&self.z).map(is_at_bound).collect()
    }

    /// The objective in units of another noise.
    pub(crate) fn objective_with(&self, data: &Data, noise: &NoiseModel) -> f64 {
        objective(data, noise, &self.model, (&self.z, &self.simulation))
    }

    /// Remaining gradient, 0 at the optimum.
    pub(crate) fn gradient(&self) -> DVector<f64> {
        gradient(&self.model, &self.jacobian, &self.residual, &self.z)
    }

    /// Standard deviations in scaled units if the noise model holds and the response is linear.
    pub(crate) fn linear_standard_deviations(&self) -> Vec<f64> {
        let information = self.information();
        let inverse = cholesky(&information).map(|c| c.inverse());
        let deviation = |i: usize| inverse.as_ref().map_or(f64::INFINITY, |m| m[(i, i)].max(0.0).sqrt());
        (0..information.nrows()).map(deviation).collect()
    }
}

/// Chi-square of data and priors of a model at scaled parameters, with their simulation.
pub(crate) fn objective(
    data: &Data,
    noise: &NoiseModel,
    model: &Model,
    (z, simulation): (&[f64], &Simulation),
) -> f64 {
    let residual = noise.stack(data, &data.residual(&simulation.columns));
    dot(&residual, &residual) + prior(model, z)
}

/// Limit of the work of a fit.
#[derive(Clone, Copy)]
pub(crate) struct Effort {
    /// Largest number of steps.
    iterations: usize,
    /// Largest number of fresh sets of sensitivities; with 1 the fit does not converge fully.
    jacobians: usize,
}

impl Effort {
    /// Runs to the optimum.
    pub(crate) const FULL: Self =
        Self { iterations: tuning::FULL_ITERATIONS, jacobians: tuning::FULL_JACOBIANS };
    /// Runs to the optimum unless that is far away; a far optimum belongs to a wrong candidate.
    pub(crate) const LIMITED: Self =
        Self { iterations: tuning::LIMITED_ITERATIONS, jacobians: tuning::LIMITED_JACOBIANS };
    /// Runs until the first sensitivities no longer hold; enough to eliminate a candidate.
    pub(crate) const ROUGH: Self = Self { iterations: tuning::ROUGH_ITERATIONS, jacobians: 1 };
}

/// Fits `model` from the scaled start `z`.
pub(crate) fn fit(data: &Data, noise: &NoiseModel, model: Model, z: Vec<f64>) -> Result<Fit, RespondError> {
    fit_from(data, noise, model, z, None, Effort::FULL)
}

/// Fits `model` from the scaled start `z`, with sensitivities that hold near it if they are known.
pub(crate) fn fit_from(
    data: &Data,
    noise: &NoiseModel,
    model: Model,
    mut z: Vec<f64>,
    jacobian: Option<Vec<Vec<f64>>>,
    effort: Effort,
) -> Result<Fit, RespondError> {
    let bounds: Vec<(f64, f64)> = model.parameters.iter().map(Parameter::bounds).collect();
    z.iter_mut().zip(&bounds).for_each(|(z, (min, max))| *z = z.clamp(*min, *max));
    let problem = Problem { data, noise, model, bounds };
    let point = problem.point(z, None)?;
    let is_stale = jacobian.is_some();
    let jacobian = match jacobian {
        Some(jacobian) => jacobian,
        None => problem.sensitivities(&point)?,
    };
    let radius = tuning::INITIAL_RADIUS;
    let mut descent = Descent { problem, point, jacobian, is_stale, fresh: usize::from(!is_stale), radius };
    for _ in 0..effort.iterations {
        if !descent.iterate(effort)? {
            break;
        }
    }
    let is_converged = effort.jacobians > 1;
    if is_converged {
        descent.finish()?;
    }
    let Descent { problem: Problem { model, .. }, point, jacobian, .. } = descent;
    let Point { z, simulation, residual, objective } = point;
    Ok(Fit { model, z, simulation, residual, jacobian, objective, is_converged })
}

/// A least-squares problem.
struct Problem<'a> {
    data: &'a Data,
    noise: &'a NoiseModel,
    model: Model,
    /// Bounds of the scaled parameters.
    bounds: Vec<(f64, f64)>,
}

/// A simulated set of parameters.
struct Point {
    z: Vec<f64>,
    simulation: Simulation,
    residual: Vec<f64>,
    objective: f64,
}

impl Problem<'_> {
    fn point(&self, z: Vec<f64>, known: Option<&Simulation>) -> Result<Point, RespondError> {
        let simulation = simulate(self.data, &self.model.at(&z), known)?;
        let residual = self.noise.stack(self.data, &self.data.residual(&simulation.columns));
        let objective = dot(&residual, &residual) + prior(&self.model, &z);
        Ok(Point { z, simulation, residual, objective })
    }

    fn sensitivities(&self, point: &Point) -> Result<Vec<Vec<f64>>, RespondError> {
        let all: Vec<usize> = (0..self.model.parameters.len()).collect();
        sensitivities(self.data, self.noise, &self.model, &point.z, &point.simulation, &all)
    }
}

/// State of a fit.
struct Descent<'a> {
    problem: Problem<'a>,
    point: Point,
    jacobian: Vec<Vec<f64>>,
    /// True if the point has moved since the sensitivities were computed.
    is_stale: bool,
    /// Fresh sets of sensitivities so far.
    fresh: usize,
    /// Radius of the trust region in scaled units.
    radius: f64,
}

/// Next action after a tried step.
enum Next {
    Step,
    FreshSensitivities,
    Stop,
}

impl Descent<'_> {
    /// Takes one step; returns whether another one may help.
    fn iterate(&mut self, effort: Effort) -> Result<bool, RespondError> {
        let (problem, point) = (&self.problem, &self.point);
        let information = with_priors(&problem.model, gram(&self.jacobian));
        let g = gradient(&problem.model, &self.jacobian, &point.residual, &point.z);
        let Some(step) = bounded_step(&information, &g, &point.z, &problem.bounds, self.radius) else {
            return Ok(false);
        };
        let predicted = 2.0 * g.dot(&step) - (&information * &step).dot(&step);
        let above_noise = point.objective - point.residual.len() as f64;
        let is_small = predicted < tuning::MIN_FALL.max(tuning::MIN_FALL_SHARE * above_noise);
        let next = if is_small { Next::FreshSensitivities } else { self.try_step(&step, predicted) };
        match next {
            Next::Step => Ok(true),
            Next::Stop => Ok(false),
            Next::FreshSensitivities => self.renew(is_small, effort),
        }
    }

    /// Moves to the end of a step if the objective falls there, and adapts the trust region.
    fn try_step(&mut self, step: &DVector<f64>, predicted: f64) -> Next {
        let length = step.norm();
        let trial: Vec<f64> = self.point.z.iter().zip(step.iter()).map(|(z, s)| z + s).collect();
        // A set of parameters that the plant cannot simulate is a step that does not help.
        match self.problem.point(trial, Some(&self.point.simulation)) {
            Ok(there) if self.point.objective - there.objective > tuning::MIN_GAIN_RATIO * predicted => {
                let ratio = (self.point.objective - there.objective) / predicted;
                broyden_update(&mut self.jacobian, &self.point.residual, &there.residual, step);
                self.point = there;
                self.is_stale = true;
                if ratio > tuning::GROW_RATIO && length > tuning::GROW_LENGTH * self.radius {
                    self.radius *= tuning::GROW_FACTOR;
                } else if ratio < tuning::SHRINK_RATIO {
                    self.radius = tuning::SHRINK_FACTOR * length.min(self.radius);
                }
                if ratio < tuning::RENEW_RATIO { Next::FreshSensitivities } else { Next::Step }
            }
            _ if self.is_stale => Next::FreshSensitivities,
            _ => {
                self.radius = tuning::REJECT_FACTOR * length.min(self.radius);
                if self.radius < tuning::MIN_RADIUS { Next::Stop } else { Next::Step }
            }
        }
    }

    /// Computes the sensitivities anew; returns whether another step may help.
    ///
    /// `is_small` means that the outdated sensitivities predict a negligible fall of the objective.
    fn renew(&mut self, is_small: bool, effort: Effort) -> Result<bool, RespondError> {
        if !self.is_stale || (is_small && effort.jacobians <= 1) {
            return Ok(false);
        }
        if self.fresh >= effort.jacobians {
            self.radius *= tuning::STALE_FACTOR;
            return Ok(!is_small);
        }
        self.jacobian = self.problem.sensitivities(&self.point)?;
        (self.is_stale, self.fresh) = (false, self.fresh + 1);
        Ok(true)
    }

    /// Brings the sensitivities up to date, and moves along aliases to the most probable
    /// parameters.
    ///
    /// If an effect and a declared parameter change the same number, the optimum is a curved
    /// valley, and a fit may end anywhere in it.
    fn finish(&mut self) -> Result<(), RespondError> {
        let problem = &self.problem;
        if self.is_stale {
            self.jacobian = problem.sensitivities(&self.point)?;
        }
        let trial = problem.model.unaliased(&self.point.z);
        if prior(&problem.model, &trial) < prior(&problem.model, &self.point.z) {
            let there = problem.point(trial, Some(&self.point.simulation))?;
            if there.objective < self.point.objective {
                self.jacobian = problem.sensitivities(&there)?;
                self.point = there;
            }
        }
        Ok(())
    }
}

/// Broyden's update: the smallest change of the sensitivities that explains the last step.
fn broyden_update(jacobian: &mut [Vec<f64>], before: &[f64], after: &[f64], step: &DVector<f64>) {
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

/// Chi-square of the priors.
fn prior(model: &Model, z: &[f64]) -> f64 {
    z.iter().zip(&model.parameters).map(|(z, p)| p.precision * z * z).sum()
}
