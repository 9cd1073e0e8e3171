//! Where to start with an effect whose size no sensitivity at 0 tells: sizes are tried on few samples, from the described values.

use crate::fit::{Effort, Fit, Simulation, fit_from, sensitivities, simulate};
use crate::linear::dot;
use crate::model::Model;
use crate::noise::NoiseModel;
use crate::rank::Score;
use crate::session::Data;
use bench::respond::RespondError;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Sizes of an effect, in multiples of its scale, that a search tries.
const SIZES: [f64; 6] = [0.3, 1.0, 3.0, 10.0, 30.0, 100.0];
/// Factors on the best of them that are tried, too: oscillations that are out of step have many a valley.
const BETWEEN: [f64; 4] = [0.6, 0.8, 1.25, 1.6];
/// Turns of two sizes against each other that are tried at the best size.
const TURNS_RAD: [f64; 3] = [FRAC_PI_4, FRAC_PI_2, 3.0 * FRAC_PI_4];
/// Factor on the precision of what is declared, to hold it.
const HELD: f64 = 1e8;

/// A base at its described values on few samples, with its sensitivities there: where searches start.
pub(crate) struct Origin<'a> {
    data: &'a Data,
    noise: &'a NoiseModel,
    z: Vec<f64>,
    simulation: Simulation,
    jacobian: Vec<Vec<f64>>,
}

impl<'a> Origin<'a> {
    /// The origin of a base; the effects that it has stay as fitted.
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

    /// A glance at a candidate from the size that fits best: scaled parameters and objective, which is infinite where the plant takes the effect in no size.
    pub(crate) fn search(&self, base: &Fit, score: &Score) -> Result<(Vec<f64>, f64), RespondError> {
        let trial = Trial::new(self, base, score);
        // A guessed size is no order of magnitude but nearly right.
        let guessed = score.candidate.guess.filter(|_| score.candidate.guesses_size());
        let sizes: Vec<f64> = match guessed {
            Some(guess) => vec![guess.value / guess.step],
            None => SIZES.iter().flat_map(|s| [*s, -s]).collect(),
        };
        let Some((size, coarse)) = trial.best_of(&sizes) else {
            return Ok((self.z.clone(), f64::INFINITY));
        };
        let between: Vec<f64> = BETWEEN.iter().map(|factor| factor * size).collect();
        let finer = trial.best_of(&between).filter(|(_, start)| start.square < coarse.square);
        let (size, straight) = finer.unwrap_or((size, coarse));
        let turned = TURNS_RAD.iter().filter(|_| trial.turns).filter_map(|&turn| trial.at(size, turn));
        let turned = turned.min_by(|a, b| a.square.total_cmp(&b.square));
        let straight = trial.glance(straight)?;
        let turned = turned.map(|start| trial.glance(start)).transpose()?;
        let found = turned.filter(|t| t.objective < straight.objective).unwrap_or(straight);
        Ok((found.z, found.objective))
    }
}

/// A candidate on top of an origin.
struct Trial<'a> {
    origin: &'a Origin<'a>,
    model: Model,
    /// How the added parameters go together, the largest 1; of a single size, 1.
    direction: Vec<f64>,
    /// Whether that is not known: of what is even in its two sizes, as a tilt, a score does not say it; of a ripple it does.
    turns: bool,
}

/// Where a fit may start.
struct Start {
    z: Vec<f64>,
    simulation: Simulation,
    /// Chi-square of the data.
    square: f64,
}

impl<'a> Trial<'a> {
    fn new(origin: &'a Origin<'a>, base: &Fit, score: &Score) -> Self {
        let model = base.model.with(score.candidate, origin.noise);
        let parameters = score.candidate.kind.parameters(&base.model.at(&base.z).common);
        let count = parameters.iter().filter(|p| p.is_size).count();
        let largest = score.estimate.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
        let of = |b: &f64| if count > 1 && largest > 0.0 { b / largest } else { 1.0 };
        let direction = score.estimate.iter().map(of).collect();
        Self { origin, model, direction, turns: count == 2 && score.candidate.guess.is_none() }
    }

    /// The effect at a size, its two sizes turned against each other; none where the plant does not take it.
    fn at(&self, size: f64, turned_rad: f64) -> Option<Start> {
        let origin = self.origin;
        let mut z = origin.z.clone();
        z.resize(self.model.parameters.len(), 0.0);
        let direction = |k: usize| self.direction.get(k).copied().unwrap_or(1.0);
        for k in 0..z.len() - origin.z.len() {
            let (place, parameter) = (origin.z.len() + k, &self.model.parameters[origin.z.len() + k]);
            if parameter.is_size() {
                let across = if k == 0 { -direction(1) } else { direction(0) };
                z[place] = size * (turned_rad.cos() * direction(k) + turned_rad.sin() * across);
                let (least, most) = parameter.bounds();
                if !(least..=most).contains(&z[place]) {
                    return None;
                }
            }
        }
        let simulation = simulate(origin.data, &self.model.at(&z), Some(&origin.simulation)).ok()?;
        let residual = origin.noise.stack(origin.data, &origin.data.residual(&simulation.columns));
        Some(Start { z, simulation, square: dot(&residual, &residual) })
    }

    fn best_of(&self, sizes: &[f64]) -> Option<(f64, Start)> {
        let tried = sizes.iter().filter_map(|&size| Some((size, self.at(size, 0.0)?)));
        tried.min_by(|a, b| a.1.square.total_cmp(&b.1.square))
    }

    fn glance(&self, start: Start) -> Result<Fit, RespondError> {
        let Origin { data, noise, z, jacobian, .. } = self.origin;
        let added: Vec<usize> = (z.len()..start.z.len()).collect();
        let own = sensitivities(data, noise, &self.model, &start.z, &start.simulation, &added)?;
        let near = jacobian.iter().cloned().chain(own).collect();
        if !self.turns {
            return fit_from(data, noise, self.model.clone(), start.z, Some(near), Effort::GLANCE);
        }
        // Alone first: what is declared would bend to the direction that is not yet right.
        let mut alone = self.model.clone();
        alone.parameters.iter_mut().take(z.len()).for_each(|p| p.precision *= HELD);
        let alone = fit_from(data, noise, alone, start.z, Some(near), Effort::FAIR)?;
        fit_from(data, noise, self.model.clone(), alone.z, Some(alone.jacobian), Effort::GLANCE)
    }
}
