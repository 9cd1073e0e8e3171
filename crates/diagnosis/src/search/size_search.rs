//! Search for the size of an effect, by trials on few samples. It is used if the base is far from
//! the noise, where sensitivities at size 0 do not predict the size.

use super::score::Score;
use super::tuning;
use crate::data::logs::Data;
use crate::data::noise::NoiseModel;
use crate::fit::least_squares::{Effort, Fit, fit_from};
use crate::fit::linear::dot;
use crate::fit::model::Model;
use crate::fit::sensitivities::sensitivities;
use crate::fit::simulation::{Simulation, simulate};
use bench::simulate::RespondError;

/// A base at its described values on few samples, with its sensitivities there.
pub(crate) struct Origin<'a> {
    data: &'a Data,
    noise: &'a NoiseModel,
    z: Vec<f64>,
    simulation: Simulation,
    jacobian: Vec<Vec<f64>>,
}

impl<'a> Origin<'a> {
    /// Declared parameters at their described values; effects that the base has stay as fitted.
    pub(crate) fn new(data: &'a Data, noise: &'a NoiseModel, base: &Fit) -> Result<Self, RespondError> {
        let z: Vec<f64> = base
            .z
            .iter()
            .zip(&base.model.parameters)
            .map(|(z, p)| if p.is_declared() { 0.0 } else { *z })
            .collect();
        let simulation = simulate(data, &base.model.at(&z), None)?;
        let all: Vec<usize> = (0..z.len()).collect();
        let jacobian = sensitivities(data, noise, &base.model, &z, &simulation, &all)?;
        Ok(Self { data, noise, z, simulation, jacobian })
    }

    /// Fits a candidate roughly from its best trial size; returns scaled parameters and objective.
    ///
    /// The objective is infinite if the plant cannot simulate the effect at any size.
    pub(crate) fn search(&self, base: &Fit, score: &Score) -> Result<(Vec<f64>, f64), RespondError> {
        let trial = Trial::new(self, base, score);
        // A guessed size is nearly right, so no other order of magnitude is tried.
        let guessed = score.candidate.guess.filter(|_| score.candidate.guesses_size());
        let sizes: Vec<f64> = match guessed {
            Some(guess) => vec![guess.value / guess.step],
            None => trial.plausible_sizes(),
        };
        let Some((size, coarse)) = trial.best_of(&sizes) else {
            return Ok((self.z.clone(), f64::INFINITY));
        };
        let between: Vec<f64> = tuning::TRIAL_FACTORS.iter().map(|factor| factor * size).collect();
        let finer = trial.best_of(&between).filter(|(_, start)| start.chi_square < coarse.chi_square);
        let (size, unrotated) = finer.unwrap_or((size, coarse));
        let rotated = tuning::TRIAL_TURNS_RAD
            .iter()
            .filter(|_| trial.has_unknown_ratio)
            .filter_map(|&angle_rad| trial.at(size, angle_rad));
        let rotated = rotated.min_by(|a, b| a.chi_square.total_cmp(&b.chi_square));
        let unrotated = trial.rough_fit(unrotated)?;
        let rotated = rotated.map(|start| trial.rough_fit(start)).transpose()?;
        let found = rotated.filter(|t| t.objective < unrotated.objective).unwrap_or(unrotated);
        Ok((found.z, found.objective))
    }
}

/// A candidate on top of an origin.
struct Trial<'a> {
    origin: &'a Origin<'a>,
    model: Model,
    /// Ratio of the added parameters, the largest being 1; 1 for a single size.
    direction: Vec<f64>,
    /// True if that ratio is unknown. The score determines it for a ripple, but not for an effect
    /// whose response is even in its two sizes, such as a tilt.
    has_unknown_ratio: bool,
}

/// Start of a fit.
struct Start {
    z: Vec<f64>,
    simulation: Simulation,
    /// Chi-square of the data.
    chi_square: f64,
}

impl<'a> Trial<'a> {
    fn new(origin: &'a Origin<'a>, base: &Fit, score: &Score) -> Self {
        let model = base.model.with_effect(score.candidate.clone(), origin.noise);
        let parameters = score.candidate.kind.parameters(&base.model.at(&base.z).common);
        let count = parameters.iter().filter(|p| p.is_size).count();
        let largest = score.estimate.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
        let ratio = |b: &f64| if count > 1 && largest > 0.0 { b / largest } else { 1.0 };
        let direction = score.estimate.iter().map(ratio).collect();
        Self { origin, model, direction, has_unknown_ratio: count == 2 && score.candidate.guess.is_none() }
    }

    /// Trial sizes of both signs; the large ones only if the prior of every size allows them.
    fn plausible_sizes(&self) -> Vec<f64> {
        let sizes = self.model.parameters.iter().skip(self.origin.z.len()).filter(|p| p.is_size());
        let precision = sizes.fold(0.0_f64, |m, p| m.max(p.precision));
        let is_plausible =
            |s: &&f64| **s <= tuning::LARGE_TRIAL || **s * precision.sqrt() <= tuning::PLAUSIBLE_DEVIATIONS;
        tuning::TRIAL_SIZES.iter().filter(is_plausible).flat_map(|s| [*s, -s]).collect()
    }

    /// The effect at a size, with its two sizes rotated against each other; none if the plant
    /// cannot simulate it.
    fn at(&self, size: f64, angle_rad: f64) -> Option<Start> {
        let origin = self.origin;
        let mut z = origin.z.clone();
        z.resize(self.model.parameters.len(), 0.0);
        let direction = |k: usize| self.direction.get(k).copied().unwrap_or(1.0);
        for k in 0..z.len() - origin.z.len() {
            let (place, parameter) = (origin.z.len() + k, &self.model.parameters[origin.z.len() + k]);
            if parameter.is_size() {
                let across = if k == 0 { -direction(1) } else { direction(0) };
                z[place] = size * (angle_rad.cos() * direction(k) + angle_rad.sin() * across);
                let (min, max) = parameter.bounds();
                if !(min..=max).contains(&z[place]) {
                    return None;
                }
            }
        }
        let simulation = simulate(origin.data, &self.model.at(&z), Some(&origin.simulation)).ok()?;
        let residual = origin.noise.stack(origin.data, &origin.data.residual(&simulation.columns));
        Some(Start { z, simulation, chi_square: dot(&residual, &residual) })
    }

    /// The size with the smallest chi-square, as a start.
    fn best_of(&self, sizes: &[f64]) -> Option<(f64, Start)> {
        let tried = sizes.iter().filter_map(|&size| Some((size, self.at(size, 0.0)?)));
        tried.min_by(|a, b| a.1.chi_square.total_cmp(&b.1.chi_square))
    }

    /// Fits the effect and all parameters of the origin roughly from a start.
    fn rough_fit(&self, start: Start) -> Result<Fit, RespondError> {
        let Origin { data, noise, z, jacobian, .. } = self.origin;
        let added: Vec<usize> = (z.len()..start.z.len()).collect();
        let own = sensitivities(data, noise, &self.model, &start.z, &start.simulation, &added)?;
        let near = jacobian.iter().cloned().chain(own).collect();
        if !self.has_unknown_ratio {
            return fit_from(data, noise, self.model.clone(), start.z, Some(near), Effort::ROUGH);
        }
        // The effect is fitted alone first: declared parameters would adapt to a direction that is
        // still wrong.
        let mut alone = self.model.clone();
        alone.parameters.iter_mut().take(z.len()).for_each(|p| p.precision *= tuning::DECLARED_STIFFNESS);
        let alone = fit_from(data, noise, alone, start.z, Some(near), Effort::LIMITED)?;
        fit_from(data, noise, self.model.clone(), alone.z, Some(alone.jacobian), Effort::ROUGH)
    }
}
