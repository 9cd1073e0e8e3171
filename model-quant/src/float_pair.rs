//! The float networks with the stepping interface of [`inference::Pair`]: the same chain before quantisation.

use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::net::{Net, Taps};
use inference::layout::{
    CHANNELS, COLLISION_INPUTS, COLLISION_TAPS, FRICTION_INPUTS, FRICTION_TAPS, HEAD_WEIGHTS, HIDDEN_TAPS,
    WINDOW,
};
use inference::{Bearing, ContactState, Estimate, Flags, Header};
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

/// History of one float network; zero before the start, as on the controller.
#[derive(Clone, Debug)]
struct Stream<const T: usize> {
    inputs: [f32; T],
    first: [f32; HIDDEN_TAPS],
    second: [f32; HIDDEN_TAPS],
    third: [f32; HEAD_WEIGHTS],
}

impl<const T: usize> Stream<T> {
    fn new() -> Self {
        Self {
            inputs: [0.0; T],
            first: [0.0; HIDDEN_TAPS],
            second: [0.0; HIDDEN_TAPS],
            third: [0.0; HEAD_WEIGHTS],
        }
    }

    fn step(&mut self, net: &Net<T>, column: &[f32]) -> f32 {
        push(&mut self.inputs, column);
        push(&mut self.first, &convolve(&self.inputs, &net.first, &net.first_bias));
        push(&mut self.second, &convolve(&self.first, &net.second, &net.second_bias));
        push(&mut self.third, &convolve(&self.second, &net.third, &net.third_bias));
        self.third.iter().zip(&net.head).fold(net.head_bias[0], |sum, (x, w)| sum + x * w)
    }
}

fn push(columns: &mut [f32], newest: &[f32]) {
    columns.rotate_left(newest.len());
    let start = columns.len() - newest.len();
    columns[start..].copy_from_slice(newest);
}

fn convolve<const T: usize>(inputs: &[f32; T], weights: &Taps<T>, bias: &[f32; CHANNELS]) -> [f32; CHANNELS] {
    let mut sums = *bias;
    for (x, row) in inputs.iter().zip(weights) {
        for (sum, w) in sums.iter_mut().zip(row) {
            *sum += x * w;
        }
    }
    sums.map(|sum| if sum > 0.0 { sum } else { 0.0 })
}

/// Both float networks of a bearing, one sample at a time.
#[derive(Clone, Debug)]
pub struct FloatPair {
    header: Header,
    collision_net: Net<COLLISION_TAPS>,
    friction_net: Net<FRICTION_TAPS>,
    collision: Stream<COLLISION_TAPS>,
    friction: Stream<FRICTION_TAPS>,
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
        Self {
            header: Header { training_id, ..checkpoint.header() },
            collision_net: checkpoint.collision.float.clone(),
            friction_net: checkpoint.friction.float.clone(),
            collision: Stream::new(),
            friction: Stream::new(),
            seen: 0,
        }
    }

    /// Ranges and identity, as in the image; the check sum is 0.
    pub fn header(&self) -> Header {
        self.header
    }

    /// Forgets the history.
    pub fn reset(&mut self) {
        self.collision = Stream::new();
        self.friction = Stream::new();
        self.seen = 0;
    }

    /// Takes one sample and estimates its forces.
    pub fn step(&mut self, state: &ContactState) -> Estimate {
        if !state.is_finite() {
            self.reset();
            return Estimate { flags: Flags::NON_FINITE | Flags::WARMING_UP, ..Estimate::default() };
        }
        let column = self.header.collision_column(state);
        let inputs: [f32; COLLISION_INPUTS] = column.inputs;
        let root = self.collision.step(&self.collision_net, &inputs).max(0.0) * column.root_force_factor;
        let normal_force_n = root * root;
        let inputs: [f32; FRICTION_INPUTS] = self.header.friction_column(root, state.sliding_speed_m_s);
        let coefficient = self.friction.step(&self.friction_net, &inputs).max(0.0);
        let friction_force_n = match state.sliding_speed_m_s {
            speed if speed > 0.0 => -coefficient * normal_force_n,
            speed if speed < 0.0 => coefficient * normal_force_n,
            _ => 0.0,
        };
        self.seen = self.seen.saturating_add(1);
        let flags = column.flags
            | Flags::OUTSIDE_FORCE.when(normal_force_n > self.header.normal_force_n.high)
            | Flags::WARMING_UP.when(self.seen < WINDOW);
        Estimate { normal_force_n, friction_force_n, flags, saturated: 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::{Draw, Purpose};

    #[test]
    fn a_warm_stream_equals_the_window_that_was_trained() {
        let mut draw = Draw::new(8, Purpose::Weights, 0);
        let net = Net::<FRICTION_TAPS>::start(&mut draw);
        let columns: Vec<[f32; FRICTION_INPUTS]> =
            (0..40).map(|_| core::array::from_fn(|_| draw.uniform(-1.0, 1.0) as f32)).collect();
        let mut stream = Stream::new();
        for (index, column) in columns.iter().enumerate() {
            let output = stream.step(&net, column);
            if index + 1 >= WINDOW {
                let window = columns[index + 1 - WINDOW..=index].as_flattened();
                assert_eq!(output.to_bits(), net.window(window).to_bits(), "column {index}");
            }
        }
    }
}
