//! Direct training of one network: Adam on the mean squared error, the same bytes on any number of threads.
//!
//! A batch is cut into chunks of a fixed size; each chunk fills a gradient of its own, and the gradients are added in
//! the order of the chunks. A target of 0 (a contact that separates) asks only that the output be no higher than 0,
//! because the output is clamped there.

use crate::draw::{Draw, Purpose};
use crate::network::{Network, Shape};
use crate::passes::Passes;
use crate::recipe::Recipe;
use crate::round::Freezer;
use crate::rows::Row;
use crate::window::Window;
use rayon::prelude::*;

/// Windows whose gradients are added up by one task.
pub const CHUNK: usize = 64;
const BETA: [f64; 2] = [0.9, 0.999];
/// Share of the passes on the grid after which every weight is frozen; the rest moves biases alone.
const FREEZING_SHARE: f64 = 0.9;
const EPSILON: f32 = 1e-8;

/// State of a training after an epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Epochs done, of both kinds.
    pub epoch: usize,
    /// Whether the weights were on the grid.
    pub on_grid: bool,
    /// Mean squared error over the epoch, in units of the target's rms squared.
    pub loss: f64,
    /// Mean absolute error over the epoch, in units of the target's rms.
    pub mean_absolute_error: f64,
    /// Mean squared error on the validation windows.
    pub validation_loss: f64,
    /// Mean absolute error on the validation windows.
    pub validation_mean_absolute_error: f64,
}

/// The two results of a training.
#[derive(Clone, Debug, PartialEq)]
pub struct Trained {
    /// Free weights.
    pub float: Network,
    /// Weights trained on further so that their rounding costs little.
    pub tuned: Network,
}

/// What distinguishes the two trainings of a bearing.
pub struct Task<'a, F> {
    /// Training rows.
    pub rows: &'a [Row],
    /// Validation rows.
    pub validation: &'a [Row],
    /// Shape of the network.
    pub shape: Shape,
    /// Makes a row's window.
    pub window: F,
    /// Number added to the indices of the streams, so that the two trainings do not share draws.
    pub lane: u64,
}

/// Difference from the target, as far as it counts.
fn residual(output: f32, target: f32) -> f32 {
    if target > 0.0 { output - target } else { output.max(0.0) }
}

/// Sums over one chunk.
struct Chunk {
    gradient: Network,
    squared: f64,
    absolute: f64,
}

/// Adam's moments.
struct Adam {
    mean: Network,
    square: Network,
    powers: [f64; 2],
}

impl Adam {
    fn new(shape: &Shape) -> Self {
        let zero = Network::zero(shape.clone());
        Self { mean: zero.clone(), square: zero, powers: [1.0; 2] }
    }

    fn step(&mut self, net: &mut Network, gradient: &Network, free: &Network, learning_rate: f64) {
        self.powers = [self.powers[0] * BETA[0], self.powers[1] * BETA[1]];
        let rate = (learning_rate * libm::sqrt(1.0 - self.powers[1]) / (1.0 - self.powers[0])) as f32;
        let [b1, b2] = BETA.map(|beta| beta as f32);
        let moments = self.mean.slices_mut().zip(self.square.slices_mut());
        let parts = net.slices_mut().zip(gradient.slices()).zip(free.slices()).zip(moments);
        for (((weights, slopes), free), (means, squares)) in parts {
            let values = weights.iter_mut().zip(slopes).zip(free).zip(means).zip(squares);
            for ((((w, g), free), m), s) in values {
                *m = b1 * *m + (1.0 - b1) * g;
                *s = b2 * *s + (1.0 - b2) * g * g;
                *w -= free * (rate * *m / (s.sqrt() + EPSILON));
            }
        }
    }
}

fn shuffle(order: &mut [u32], draw: &mut Draw) {
    for last in (1..order.len()).rev() {
        order.swap(last, draw.below(last + 1));
    }
}

/// Mean squared and mean absolute error of a network on windows, in units of `unit`.
pub fn errors<const C: usize>(net: &Network, windows: &[Window<C>], unit: f32) -> (f64, f64) {
    let sums: Vec<(f64, f64)> = windows
        .par_chunks(CHUNK)
        .map(|chunk| {
            chunk.iter().fold((0.0, 0.0), |(squared, absolute), window| {
                let output = net.evaluate(window.columns.as_flattened())[0];
                let error = f64::from(residual(output, window.target / unit));
                (squared + error * error, absolute + error.abs())
            })
        })
        .collect();
    let (squared, absolute) = sums.iter().fold((0.0, 0.0), |(s, a), (x, y)| (s + x, a + y));
    let count = windows.len().max(1) as f64;
    (squared / count, absolute / count)
}

/// Trains one network; its output is in the target's own unit.
pub fn train<const C: usize, F>(
    recipe: &Recipe,
    task: &Task<'_, F>,
    report: &mut dyn FnMut(Progress),
) -> Trained
where
    F: Fn(&Row, &mut Draw) -> Window<C> + Sync,
{
    let stream = |purpose, index: u64| Draw::new(recipe.seed, purpose, task.lane << 40 | index);
    let validation: Vec<Window<C>> = (task.validation.par_iter().enumerate())
        .map(|(index, row)| (task.window)(row, &mut stream(Purpose::FixedHistories, index as u64)))
        .collect();
    let power: f64 =
        validation.iter().map(|window| f64::from(window.target) * f64::from(window.target)).sum();
    let unit = libm::sqrt(power / validation.len().max(1) as f64).max(1e-30) as f32;
    let mut net = Network::start(task.shape.clone(), &mut stream(Purpose::Weights, 0));
    let mut float = net.clone();
    let mut adam = Adam::new(&task.shape);
    let mut freezer = Freezer::new(&net);
    let mut order: Vec<u32> = (0..task.rows.len() as u32).collect();
    let batches = order.len().div_ceil(recipe.batch);
    for epoch in 0..recipe.epochs + recipe.grid_epochs {
        let on_grid = epoch >= recipe.epochs;
        let (phase, phases, peak) = if on_grid {
            (epoch - recipe.epochs, recipe.grid_epochs, recipe.grid_learning_rate)
        } else {
            (epoch, recipe.epochs, recipe.learning_rate)
        };
        if on_grid && phase == 0 {
            float = net.clone();
            adam = Adam::new(&task.shape);
            freezer = Freezer::new(&net);
        }
        if on_grid {
            let done = ((phase + 1) as f64 / (FREEZING_SHARE * phases as f64)).min(1.0);
            freezer.freeze(&mut net, 1.0 - (1.0 - done) * (1.0 - done));
        }
        shuffle(&mut order, &mut stream(Purpose::Order, epoch as u64));
        let (mut squared, mut absolute) = (0.0, 0.0);
        for (index, batch) in order.chunks(recipe.batch).enumerate() {
            let number = (epoch * batches + index) * recipe.batch.div_ceil(CHUNK);
            let chunks: Vec<Chunk> = batch
                .par_chunks(CHUNK)
                .enumerate()
                .map(|(chunk, rows)| {
                    let mut draw = stream(Purpose::Histories, (number + chunk) as u64);
                    let windows = rows.iter().map(|&row| (task.window)(&task.rows[row as usize], &mut draw));
                    descend(&net, windows, unit, 2.0 / batch.len() as f32)
                })
                .collect();
            let mut gradient = Network::zero(task.shape.clone());
            for chunk in &chunks {
                add(&mut gradient, &chunk.gradient);
                squared += chunk.squared;
                absolute += chunk.absolute;
            }
            let done = (phase * batches + index) as f64 / (phases * batches) as f64;
            let cosine = 0.5 * (1.0 + libm::cos(core::f64::consts::PI * done));
            adam.step(&mut net, &gradient, freezer.free(), peak * (1e-3 + (1.0 - 1e-3) * cosine));
        }
        let (validation_loss, validation_mean_absolute_error) = errors(&net, &validation, unit);
        let count = order.len().max(1) as f64;
        report(Progress {
            epoch: epoch + 1,
            on_grid,
            loss: squared / count,
            mean_absolute_error: absolute / count,
            validation_loss,
            validation_mean_absolute_error,
        });
    }
    if recipe.grid_epochs == 0 {
        float = net.clone();
        freezer.freeze(&mut net, 1.0);
    }
    Trained { float: in_unit(float, unit), tuned: in_unit(net, unit) }
}

fn add(sum: &mut Network, other: &Network) {
    for (mine, theirs) in sum.slices_mut().flatten().zip(other.parameters()) {
        *mine += theirs;
    }
}

/// Gradient and errors of one chunk.
fn descend<const C: usize>(
    net: &Network,
    windows: impl Iterator<Item = Window<C>>,
    unit: f32,
    weight: f32,
) -> Chunk {
    let mut sums = Chunk { gradient: Network::zero(net.shape().clone()), squared: 0.0, absolute: 0.0 };
    let mut passes = Passes::new(net.shape());
    for window in windows {
        let columns: &[f32] = window.columns.as_flattened();
        let output = passes.forward(net, columns);
        let error = residual(output, window.target / unit);
        sums.squared += f64::from(error) * f64::from(error);
        sums.absolute += f64::from(error).abs();
        if error != 0.0 {
            passes.backward(net, weight * error, &mut sums.gradient);
        }
    }
    sums
}

/// Multiplies the head, so that the output is in the target's own unit.
fn in_unit(mut net: Network, unit: f32) -> Network {
    let convolutions = 2 * net.shape().convolutions.len();
    for weight in net.slices_mut().skip(convolutions).flatten() {
        *weight *= unit;
    }
    net
}
