//! The float networks with the stepping interface of [`inference::Pair`]: the same chain before quantisation.

use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::features::FloatFeatures;
use crate::network::{Network, Shape, rectify};
use crate::shapes::LAYERS;
use inference::{Bearing, ContactState, Flags, Header, WINDOW};
use std::path::Path;

/// Why a float pair could not be loaded.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The file cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// The file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is no checkpoint.
    #[error("{path}: {source}")]
    Checkpoint {
        /// The file.
        path: String,
        /// What is wrong with it.
        source: CheckpointError,
    },
}

/// Reads a checkpoint and its bytes from a file.
pub fn read_checkpoint(path: &Path) -> Result<(Checkpoint, Vec<u8>), LoadError> {
    let name = || path.display().to_string();
    let bytes = std::fs::read(path).map_err(|source| LoadError::Read { path: name(), source })?;
    let checkpoint =
        Checkpoint::from_bytes(&bytes).map_err(|source| LoadError::Checkpoint { path: name(), source })?;
    Ok((checkpoint, bytes))
}

/// The bytes of the checked-in checkpoint of a bearing.
pub fn shipped(bearing: Bearing) -> &'static [u8] {
    match bearing {
        Bearing::Babbitt => include_bytes!("../models/babbitt.float"),
        Bearing::Plastic => include_bytes!("../models/plastic.float"),
    }
}

/// What the float networks estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FloatEstimate {
    /// Normal force in N, never below 0, exactly 0 without contact.
    pub normal_force_n: f32,
    /// Friction force in N along the sliding direction: opposed to the sliding speed.
    pub friction_force_n: f32,
    /// Remarks on this estimate.
    pub flags: Flags,
}

/// Whole steps that values are rounded to, and the most of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// One step.
    pub step: f32,
    /// Largest number of steps.
    pub most: f32,
}

impl Grid {
    fn round(self, values: &mut [f32]) {
        for value in values {
            *value = libm::roundf(*value / self.step).clamp(-self.most, self.most) * self.step;
        }
    }
}

/// Which values on the way through a float network are rounded, to see what each costs: features, then the outputs of the
/// three convolutions. Normally none.
pub type Rounding = [Option<Grid>; LAYERS];

/// History of one float network without padding; zero before the start, as on the controller.
#[derive(Clone, Debug)]
struct Stream {
    /// The columns that each layer sees, oldest first.
    seen: Vec<Vec<f32>>,
    /// Newest column behind a layer, and the one before it.
    columns: [Vec<f32>; 2],
}

impl Stream {
    fn new(shape: &Shape) -> Self {
        let seen = shape.layers().iter().map(|layer| vec![0.0; layer.taps()]).collect();
        Self { seen, columns: [Vec::new(), Vec::new()] }
    }

    fn reset(&mut self) {
        for seen in &mut self.seen {
            seen.fill(0.0);
        }
    }

    fn step(&mut self, network: &Network, column: &[f32], rounding: &Rounding) -> f32 {
        let [newest, next] = &mut self.columns;
        newest.clear();
        newest.extend(column);
        let head = self.seen.len().saturating_sub(1);
        for (index, (layer, seen)) in network.layers().iter().zip(&mut self.seen).enumerate() {
            if let Some(grid) = rounding.get(index).copied().flatten() {
                grid.round(newest);
            }
            push(seen, newest);
            next.clear();
            next.resize(layer.biases.len(), 0.0);
            layer.sums(seen, next);
            if index < head {
                rectify(next);
            }
            core::mem::swap(newest, next);
        }
        newest.first().copied().unwrap_or_default()
    }
}

fn push(columns: &mut [f32], newest: &[f32]) {
    let start = columns.len().saturating_sub(newest.len());
    columns.copy_within(newest.len().min(start)..start + newest.len().min(columns.len()), 0);
    for (slot, value) in columns.iter_mut().skip(start).zip(newest) {
        *slot = *value;
    }
}

/// Both float networks of a bearing, one sample at a time.
#[derive(Clone, Debug)]
pub struct FloatPair {
    header: Header,
    features: FloatFeatures,
    networks: [Network; 2],
    rounding: [Rounding; 2],
    streams: [Stream; 2],
    seen: usize,
}

impl FloatPair {
    /// The checked-in networks of a bearing.
    pub fn new(bearing: Bearing) -> Result<Self, CheckpointError> {
        let bytes = shipped(bearing);
        Ok(Self::of(&Checkpoint::from_bytes(bytes)?, Checkpoint::training_id(bytes)))
    }

    /// The networks of a checkpoint file.
    pub fn load(path: &Path) -> Result<Self, LoadError> {
        let (checkpoint, bytes) = read_checkpoint(path)?;
        Ok(Self::of(&checkpoint, Checkpoint::training_id(&bytes)))
    }

    /// The free weights of a checkpoint.
    pub fn of(checkpoint: &Checkpoint, training_id: u64) -> Self {
        let header = Header { training_id, ..checkpoint.header() };
        let networks = [checkpoint.collision.float.clone(), checkpoint.friction.float.clone()];
        Self::with(header, networks, [[None; LAYERS]; 2])
    }

    /// Any two networks (collision first) without padding, with some of their activations rounded.
    pub fn with(header: Header, networks: [Network; 2], rounding: [Rounding; 2]) -> Self {
        let streams = [0, 1].map(|which: usize| Stream::new(networks[which].shape()));
        Self { header, features: FloatFeatures::of(&header), networks, rounding, streams, seen: 0 }
    }

    /// Ranges and identity, as in the image.
    pub fn header(&self) -> Header {
        self.header
    }

    /// Forgets the history.
    pub fn reset(&mut self) {
        for stream in &mut self.streams {
            stream.reset();
        }
        self.seen = 0;
    }

    /// Takes one sample and estimates its forces. One that is not finite gives 0 and starts the history anew.
    pub fn push(&mut self, state: &ContactState) -> FloatEstimate {
        if !state.is_finite() {
            self.reset();
            return FloatEstimate {
                flags: Flags::NON_FINITE | Flags::WARMING_UP,
                ..FloatEstimate::default()
            };
        }
        let [collision_rounding, friction_rounding] = &self.rounding;
        let [collision_net, friction_net] = &self.networks;
        let [collision, friction] = &mut self.streams;
        let column = self.features.collision(state);
        let output = collision.step(collision_net, &column.inputs, collision_rounding);
        let root = output.max(0.0) * column.root_force_factor;
        let normal_force_n = root * root;
        let inputs = self.features.friction(root, state.sliding_speed_m_s);
        let coefficient = friction.step(friction_net, &inputs, friction_rounding).max(0.0);
        let friction_force_n = match state.sliding_speed_m_s {
            speed if speed > 0.0 => -coefficient * normal_force_n,
            speed if speed < 0.0 => coefficient * normal_force_n,
            _ => 0.0,
        };
        self.seen = self.seen.saturating_add(1);
        let flags = column.flags
            | Flags::OUTSIDE_FORCE.when(normal_force_n > self.features.normal_force_n.high)
            | Flags::IMPLAUSIBLE_FRICTION.when(coefficient >= 1.0)
            | Flags::WARMING_UP.when(self.seen < WINDOW);
        FloatEstimate { normal_force_n, friction_force_n, flags }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::{Draw, Purpose};
    use crate::shapes;
    use inference::features::FRICTION_INPUTS;

    #[test]
    fn a_warm_stream_equals_the_window_that_was_trained() {
        let mut draw = Draw::new(8, Purpose::Weights, 0);
        let net = Network::start(shapes::friction(), &mut draw);
        let columns: Vec<[f32; FRICTION_INPUTS]> =
            (0..40).map(|_| core::array::from_fn(|_| draw.uniform(-1.0, 1.0) as f32)).collect();
        let mut stream = Stream::new(net.shape());
        for (index, column) in columns.iter().enumerate() {
            let output = stream.step(&net, column, &[None; LAYERS]);
            if index + 1 >= WINDOW {
                let window = columns[index + 1 - WINDOW..=index].as_flattened();
                assert_eq!(output.to_bits(), net.evaluate(window)[0].to_bits(), "column {index}");
            }
        }
    }
}
