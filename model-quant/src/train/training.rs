//! Training of one network, epoch by epoch.

use super::cosine_rate;
use super::freezer::Freezer;
use super::trainer::{CHUNK, ErrorSums, Loss, Trainer, Windows};
use crate::data::draw::{Draw, Purpose};
use crate::data::permutation::Permutation;
use crate::network::checkpoint::Trained;
use crate::network::recipe::{GridMethod, Recipe};
use crate::network::{Network, Shape};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Share of the grid epochs after which every weight is frozen; in the others only biases change.
/// At .9 the biases have time to settle at the end.
const FREEZING_SHARE: f64 = 0.9;

/// Source of windows.
pub trait Source: Sync {
    /// Windows in an epoch.
    fn count(&self) -> u64;

    /// Adds the window of a row and its target.
    fn add(&self, row: u64, draw: &mut Draw, windows: &mut Windows);
}

/// State of a training after an epoch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// Epochs done, of both kinds.
    pub epoch: usize,
    /// True in an epoch that moves the weights to the 8-bit grid.
    pub on_grid: bool,
    /// Mean squared error over the epoch, in units of the target's rms squared.
    pub loss: f64,
    /// Mean absolute error over the epoch, in units of the target's rms.
    pub mean_absolute_error: f64,
    /// Mean squared error on the validation windows.
    pub validation_loss: f64,
    /// Mean absolute error on the validation windows.
    pub validation_mean_absolute_error: f64,
    /// Learning rate at the epoch's end.
    pub learning_rate: f64,
}

/// Best weights of the epochs with free weights.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Best {
    pub(super) epoch: usize,
    pub(super) loss: f64,
    pub(super) network: Network,
}

/// A training between two epochs.
pub struct Training<'a> {
    pub(super) recipe: &'a Recipe,
    source: &'a dyn Source,
    validation: Windows,
    /// Number of the random stream, so that two trainings do not share draws.
    pub(super) stream: u64,
    /// Root mean square of the validation targets; the network learns targets in this unit.
    unit: f32,
    pub(super) trainer: Trainer,
    pub(super) best: Option<Best>,
    pub(super) freezer: Option<Freezer>,
    pub(super) history: Vec<Progress>,
}

impl<'a> Training<'a> {
    /// Starts with random weights.
    pub fn new(
        recipe: &'a Recipe,
        shape: Shape,
        (source, validation): (&'a dyn Source, &dyn Source),
        loss: Loss,
        stream: u64,
    ) -> Self {
        let draw_for = |purpose, index: u64| Draw::new(recipe.seed, purpose, stream << 40 | index);
        let parts: Vec<Windows> = (0..validation.count().div_ceil(CHUNK as u64))
            .into_par_iter()
            .map(|chunk| {
                let mut windows = Windows::default();
                let first = chunk * CHUNK as u64;
                for row in first..(first + CHUNK as u64).min(validation.count()) {
                    validation.add(row, &mut draw_for(Purpose::FixedHistories, row), &mut windows);
                }
                windows
            })
            .collect();
        let validation = parts.into_iter().fold(Windows::default(), |mut all, part| {
            all.columns.extend(part.columns);
            all.targets.extend(part.targets);
            all
        });
        let power: f64 = validation.targets.iter().map(|&target| f64::from(target) * f64::from(target)).sum();
        let unit = libm::sqrt(power / validation.targets.len().max(1) as f64).max(1e-30) as f32;
        let network = Network::start(shape, &mut draw_for(Purpose::Weights, 0));
        let trainer = Trainer::new(&network, recipe.instruction_set, loss);
        Self {
            recipe,
            source,
            validation,
            stream,
            unit,
            trainer,
            best: None,
            freezer: None,
            history: Vec::new(),
        }
    }

    /// All epochs up to now.
    pub fn history(&self) -> &[Progress] {
        &self.history
    }

    /// Returns true if the epochs with free weights are complete or no longer improve.
    fn is_settled(&self) -> bool {
        let free = self.history.iter().take_while(|progress| !progress.on_grid).count();
        let since = self.best.as_ref().map_or(0, |best| free - best.epoch);
        free >= self.recipe.epochs || self.recipe.patience.is_some_and(|patience| since >= patience)
    }

    /// Number of completed epochs on the grid.
    fn grid_epochs(&self) -> usize {
        self.history.iter().filter(|progress| progress.on_grid).count()
    }

    /// Returns true if all epochs are complete.
    pub fn is_done(&self) -> bool {
        self.is_settled() && self.grid_epochs() >= self.recipe.grid_epochs
    }

    /// Runs one epoch.
    pub fn epoch(&mut self) -> Progress {
        let on_grid = self.is_settled();
        let (phase, phases, highest) = if on_grid {
            (self.grid_epochs(), self.recipe.grid_epochs, self.recipe.grid_learning_rate)
        } else {
            (self.history.len(), self.recipe.epochs, self.recipe.learning_rate)
        };
        if on_grid {
            self.freeze(phase, phases);
        }
        let epoch = self.history.len();
        let count = self.source.count();
        let mut order = Draw::new(self.recipe.seed, Purpose::Order, self.stream << 40 | epoch as u64);
        let order = Permutation::new(count, (order.unit() * 9_007_199_254_740_992.0) as u64);
        let batch = self.recipe.batch as u64;
        let batches = count.div_ceil(batch);
        let chunks = batch.div_ceil(CHUNK as u64);
        let mut errors = ErrorSums::default();
        let mut rate = 0.0;
        for index in 0..batches {
            let first = index * batch;
            let done = (phase as u64 * batches + index) as f64 / (phases as u64 * batches) as f64;
            rate = cosine_rate(highest, done);
            let number = (epoch as u64 * batches + index) * chunks;
            let (recipe, stream, source) = (self.recipe, self.stream, self.source);
            let found = self.trainer.step(
                (first + batch).min(count).saturating_sub(first) as usize,
                self.unit,
                rate,
                |chunk, rows| {
                    let index = stream << 40 | (number + chunk as u64);
                    let mut draw = Draw::new(recipe.seed, Purpose::Histories, index);
                    let mut windows = Windows::default();
                    for row in rows {
                        source.add(order.at(first + row as u64), &mut draw, &mut windows);
                    }
                    windows
                },
            );
            errors.squared += found.squared;
            errors.absolute += found.absolute;
        }
        let per = |sum: f64, count: u64| sum / (count.max(1) as f64 * self.trainer.shape().outputs as f64);
        let checked = self.trainer.errors(&self.validation, self.unit);
        let rows = self.validation.targets.len() as f64;
        let progress = Progress {
            epoch: epoch + 1,
            on_grid,
            loss: per(errors.squared, count),
            mean_absolute_error: per(errors.absolute, count),
            validation_loss: checked.squared / rows.max(1.0),
            validation_mean_absolute_error: checked.absolute / rows.max(1.0),
            learning_rate: rate,
        };
        self.history.push(progress);
        let better = |best: &Best| progress.validation_loss < best.loss;
        if !on_grid && self.best.as_ref().is_none_or(better) {
            let network = self.trainer.network();
            self.best = Some(Best { epoch: epoch + 1, loss: progress.validation_loss, network });
        }
        progress
    }

    /// Prepares an epoch on the grid: starts from the best free weights, then freezes a further
    /// share.
    fn freeze(&mut self, phase: usize, phases: usize) {
        let mut network = self.trainer.network();
        if let (0, Some(best)) = (phase, &self.best) {
            network = best.network.clone();
            self.trainer.restart(None);
        }
        let freezer = self.freezer.get_or_insert_with(|| Freezer::new(&network));
        let method = self.recipe.grid_method;
        let done = match method {
            GridMethod::Exact if phase + 1 < phases => 0.0,
            GridMethod::Exact => 1.0,
            _ => ((phase + 1) as f64 / (FREEZING_SHARE * phases as f64)).min(1.0),
        };
        // The largest weight of every channel defines the grid and must stay frozen. The last
        // weights are the hardest to compensate, so the share grows ever more slowly.
        let share = (1.0 - (1.0 - done).powi(3)).max(freezer.share_of_ends());
        freezer.freeze(&mut network, share);
        self.trainer.replace(&network);
        self.trainer.set_free(Some(freezer.free()));
        if method != GridMethod::Freeze {
            self.trainer.use_fixed_point_forward(freezer.parts()[0], &self.validation);
        }
    }

    /// Returns the current results with outputs in the targets' unit.
    pub fn finish(&self) -> Trained {
        let last = self.trainer.network();
        let float = self.best.as_ref().map_or_else(|| last.clone(), |best| best.network.clone());
        let mut tuned = last;
        if self.grid_epochs() == 0 {
            tuned = float.clone();
            Freezer::new(&float).freeze(&mut tuned, 1.0);
        }
        Trained { float: in_unit(float, self.unit), tuned: in_unit(tuned, self.unit) }
    }
}

/// Scales the head so that the output is in the targets' unit.
fn in_unit(mut network: Network, unit: f32) -> Network {
    let convolutions = 2 * network.shape().convolutions.len();
    for weight in network.slices_mut().skip(convolutions).flatten() {
        *weight *= unit;
    }
    network
}
