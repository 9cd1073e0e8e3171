//! One network being trained: batches of windows in, parameters moved.
//!
//! A batch is cut into chunks of a fixed size; each chunk fills a gradient of its own, and the gradients are added in the
//! order of the chunks: the same bytes on any number of threads.

use super::exact::{Exact, Grids};
use super::lanes::{InstructionSet, Lanes, Machine, Operation};
use super::layout::Layout;
use super::optimiser::Adam;
use super::passes::{GROUP, Passes, Turned, backward};
use super::room::Room;
use crate::mode::Mode;
use crate::network::{Network, Shape};
use crate::parameters::Activations;
use rayon::prelude::*;

/// Windows whose gradients are added up by one task.
pub const CHUNK: usize = 64;

/// What counts as an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// Any difference from the target.
    Difference,
    /// The same, but below a target of 0 every output is right: it is clamped there.
    Clamped,
}

impl Loss {
    #[inline(always)]
    fn residual(self, output: f32, target: f32) -> f32 {
        if self == Self::Clamped && target <= 0.0 { output.max(0.0) } else { output - target }
    }
}

/// Windows and their targets, flattened.
#[derive(Clone, Debug, Default)]
pub struct Windows {
    /// Columns of every window, oldest first.
    pub columns: Vec<f32>,
    /// Targets of every window.
    pub targets: Vec<f32>,
}

/// Sums of squared and of absolute errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Sum of the squares.
    pub squared: f64,
    /// Sum of the magnitudes.
    pub absolute: f64,
}

impl Errors {
    fn add(&mut self, other: Self) {
        self.squared += other.squared;
        self.absolute += other.absolute;
    }
}

/// A network with its optimiser.
#[derive(Clone, Debug)]
pub struct Trainer {
    pub(super) layout: Layout,
    pub(super) parameters: Vec<f32>,
    pub(super) adam: Adam,
    pub(super) free: Option<Vec<f32>>,
    /// With these the way forward is in whole numbers.
    grids: Option<Grids>,
    pub(super) machine: Machine,
    loss: Loss,
}

impl Trainer {
    /// Starts from a network.
    pub fn new(network: &Network, set: InstructionSet, loss: Loss) -> Self {
        let layout = Layout::new(network.shape());
        let parameters = layout.pack(network);
        let (adam, machine) = (Adam::new(layout.length), set.machine());
        Self { adam, layout, parameters, free: None, grids: None, machine, loss }
    }

    /// The network as it is now.
    pub fn network(&self) -> Network {
        self.layout.unpack(&self.parameters)
    }

    /// Its shape.
    pub fn shape(&self) -> &Shape {
        &self.layout.shape
    }

    /// Puts other parameters in place; the optimiser goes on.
    pub fn replace(&mut self, network: &Network) {
        self.parameters = self.layout.pack(network);
    }

    /// Lets only the parameters move for which this network is not 0; forgets the moments.
    pub fn restart(&mut self, free: Option<&Network>) {
        self.adam = Adam::new(self.layout.length);
        self.hold(free);
    }

    /// Lets only the parameters move for which this network is not 0.
    pub fn hold(&mut self, free: Option<&Network>) {
        self.free = free.map(|free| self.layout.pack(free));
    }

    /// Goes forward in the controller's whole numbers from now on: weights in these steps, activations as they are largest
    /// over some windows.
    pub fn go_exact(&mut self, grid: &Network, windows: &Windows) {
        let network = self.network();
        let size = self.shape().columns * self.shape().inputs;
        let convolutions = self.layout.convolutions.len();
        let largest = (windows.columns.par_chunks(size))
            .map(|window| {
                let layers = network.activations(window).into_iter().take(convolutions);
                layers.map(|layer| layer.into_iter().fold(0.0f32, f32::max)).collect::<Vec<f32>>()
            })
            .reduce(|| vec![0.0; convolutions], |a, b| a.iter().zip(&b).map(|(a, b)| a.max(*b)).collect());
        let activations = largest.into_iter().map(|largest| Activations::up_to(largest, Mode::W8a16));
        self.grids = Some(Grids { weights: self.layout.pack(grid), activations: activations.collect() });
    }

    fn exact(&self) -> Option<Exact> {
        self.grids.as_ref().map(|grids| Exact::of(&self.layout, &self.parameters, grids))
    }

    /// One step on the mean squared error of a batch of `count` windows, made by `make` chunk by chunk. Targets are divided
    /// by `unit`.
    pub fn step(
        &mut self,
        count: usize,
        unit: f32,
        rate: f64,
        make: impl Fn(usize, core::ops::Range<usize>) -> Windows + Sync,
    ) -> Errors {
        let (gradient, errors) = self.gradient(count, unit, make);
        self.adam.step(&mut self.parameters, &gradient, self.free.as_deref(), rate);
        errors
    }

    /// Gradient of the mean squared error, in the layout's order, and the sums of the errors.
    pub(super) fn gradient(
        &self,
        count: usize,
        unit: f32,
        make: impl Fn(usize, core::ops::Range<usize>) -> Windows + Sync,
    ) -> (Vec<f32>, Errors) {
        let exact = self.exact();
        let parameters = exact.as_ref().map_or(&self.parameters, |exact| &exact.rounded);
        let turned = Turned::of(&self.layout, parameters);
        let weight = 2.0 / (count * self.layout.shape.outputs).max(1) as f32;
        let chunks: Vec<(Vec<f32>, Errors)> = (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let windows = make(chunk, chunk * CHUNK..((chunk + 1) * CHUNK).min(count));
                let (trainer, exact) = (self, exact.as_ref());
                let (windows, turned) = (&windows, &turned);
                self.machine.run(Descend { trainer, exact, parameters, windows, turned, unit, weight })
            })
            .collect();
        let mut chunks = chunks.into_iter();
        let Some((mut gradient, mut errors)) = chunks.next() else {
            return (vec![0.0; self.layout.length], Errors::default());
        };
        for (part, more) in chunks {
            for (sum, value) in gradient.iter_mut().zip(part) {
                *sum += value;
            }
            errors.add(more);
        }
        (gradient, errors)
    }

    /// Errors over windows, without learning.
    pub fn errors(&self, windows: &Windows, unit: f32) -> Errors {
        let size = (self.layout.shape.columns * self.layout.shape.inputs, self.layout.shape.outputs);
        let exact = self.exact();
        let chunks =
            windows.columns.par_chunks(CHUNK * size.0).zip(windows.targets.par_chunks(CHUNK * size.1));
        let sums: Vec<Errors> = chunks
            .map(|(columns, targets)| {
                let (trainer, exact) = (self, exact.as_ref());
                self.machine.run(Measure { trainer, exact, columns, targets, unit })
            })
            .collect();
        let mut errors = Errors::default();
        sums.into_iter().for_each(|more| errors.add(more));
        errors
    }
}

/// Gradient and errors of one chunk.
struct Descend<'a> {
    trainer: &'a Trainer,
    exact: Option<&'a Exact>,
    parameters: &'a [f32],
    windows: &'a Windows,
    turned: &'a Turned,
    unit: f32,
    weight: f32,
}

impl Operation for Descend<'_> {
    type Output = (Vec<f32>, Errors);

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Self::Output {
        let (Trainer { layout, loss, .. }, parameters) = (self.trainer, self.parameters);
        let mut gradient = vec![0.0; layout.length];
        let (mut passes, mut errors) = (Passes::new(layout), Errors::default());
        let windows = self.windows.columns.chunks(GROUP * layout.window());
        let targets = self.windows.targets.chunks(GROUP * layout.shape.outputs);
        for (windows, targets) in windows.zip(targets) {
            let rooms = forward(lanes, (layout, self.exact), parameters, windows, &mut passes);
            rooms.iter_mut().for_each(|room| room.goes_back = false);
            for (room, targets) in rooms.iter_mut().zip(targets.chunks_exact(layout.shape.outputs)) {
                let slopes = room.output_slopes.iter_mut().zip(&room.outputs);
                for ((slope, output), target) in slopes.zip(targets) {
                    let error = loss.residual(*output, target / self.unit);
                    errors.squared += f64::from(error) * f64::from(error);
                    errors.absolute += f64::from(error).abs();
                    *slope = self.weight * error;
                    room.goes_back |= error != 0.0;
                }
            }
            backward(lanes, (layout, self.turned), parameters, rooms, &mut gradient);
        }
        (gradient, errors)
    }
}

/// Errors of one chunk.
struct Measure<'a> {
    trainer: &'a Trainer,
    exact: Option<&'a Exact>,
    columns: &'a [f32],
    targets: &'a [f32],
    unit: f32,
}

impl Operation for Measure<'_> {
    type Output = Errors;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Errors {
        let Trainer { layout, parameters, loss, .. } = self.trainer;
        let (mut passes, mut errors) = (Passes::new(layout), Errors::default());
        let windows = self.columns.chunks(GROUP * layout.window());
        for (windows, targets) in windows.zip(self.targets.chunks(GROUP * layout.shape.outputs)) {
            let rooms = forward(lanes, (layout, self.exact), parameters, windows, &mut passes);
            for (room, targets) in rooms.iter().zip(targets.chunks_exact(layout.shape.outputs)) {
                for (output, target) in room.outputs.iter().zip(targets) {
                    let error = f64::from(loss.residual(*output, target / self.unit));
                    errors.squared += error * error;
                    errors.absolute += error.abs();
                }
            }
        }
        errors
    }
}

#[inline(always)]
fn forward<'a, L: Lanes>(
    lanes: L,
    (layout, exact): (&Layout, Option<&Exact>),
    parameters: &[f32],
    windows: &[f32],
    passes: &'a mut Passes,
) -> &'a mut [Room] {
    match exact {
        Some(exact) => passes.forward_exact(layout, exact, windows),
        None => passes.forward(lanes, layout, parameters, windows),
    }
}
