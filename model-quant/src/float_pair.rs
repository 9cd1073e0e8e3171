//! The float networks with the stepping interface of [`inference::Pair`]: the same chain before quantisation.

use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::features::FloatFeatures;
use crate::net::{Net, Taps};
use crate::shapes::{COLLISION_TAPS, FRICTION_TAPS, HEAD_WEIGHTS, HIDDEN_TAPS};
use inference::model::CHANNELS;
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
pub type Rounding = [Option<Grid>; 4];

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

    fn step<const C: usize>(&mut self, net: &Net<T>, mut column: [f32; C], rounding: &Rounding) -> f32 {
        let [features, first, second, third] = rounding;
        let rounded = |mut values: [f32; CHANNELS], grid: &Option<Grid>| {
            if let Some(grid) = grid {
                grid.round(&mut values);
            }
            values
        };
        if let Some(grid) = features {
            grid.round(&mut column);
        }
        push(&mut self.inputs, &column);
        push(&mut self.first, &rounded(convolve(&self.inputs, &net.first, &net.first_bias), first));
        push(&mut self.second, &rounded(convolve(&self.first, &net.second, &net.second_bias), second));
        push(&mut self.third, &rounded(convolve(&self.second, &net.third, &net.third_bias), third));
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
    features: FloatFeatures,
    collision_net: Net<COLLISION_TAPS>,
    friction_net: Net<FRICTION_TAPS>,
    rounding: [Rounding; 2],
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
        let header = Header { training_id, ..checkpoint.header() };
        let nets = (checkpoint.collision.float.clone(), checkpoint.friction.float.clone());
        Self::with(header, nets, [[None; 4]; 2])
    }

    /// Any two networks, with some of their activations rounded.
    pub fn with(
        header: Header,
        (collision_net, friction_net): (Net<COLLISION_TAPS>, Net<FRICTION_TAPS>),
        rounding: [Rounding; 2],
    ) -> Self {
        Self {
            header,
            features: FloatFeatures::of(&header),
            collision_net,
            friction_net,
            rounding,
            collision: Stream::new(),
            friction: Stream::new(),
            seen: 0,
        }
    }

    /// Ranges and identity, as in the image.
    pub fn header(&self) -> Header {
        self.header
    }

    /// Forgets the history.
    pub fn reset(&mut self) {
        self.collision = Stream::new();
        self.friction = Stream::new();
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
        let column = self.features.collision(state);
        let output = self.collision.step(&self.collision_net, column.inputs, collision_rounding);
        let root = output.max(0.0) * column.root_force_factor;
        let normal_force_n = root * root;
        let inputs = self.features.friction(root, state.sliding_speed_m_s);
        let coefficient = self.friction.step(&self.friction_net, inputs, friction_rounding).max(0.0);
        let friction_force_n = match state.sliding_speed_m_s {
            speed if speed > 0.0 => -coefficient * normal_force_n,
            speed if speed < 0.0 => coefficient * normal_force_n,
            _ => 0.0,
        };
        self.seen = self.seen.saturating_add(1);
        let flags = column.flags
            | Flags::OUTSIDE_FORCE.when(normal_force_n > self.features.normal_force_n.high)
            | Flags::WARMING_UP.when(self.seen < WINDOW);
        FloatEstimate { normal_force_n, friction_force_n, flags }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::{Draw, Purpose};
    use inference::features::FRICTION_INPUTS;

    #[test]
    fn a_warm_stream_equals_the_window_that_was_trained() {
        let mut draw = Draw::new(8, Purpose::Weights, 0);
        let net = Net::<FRICTION_TAPS>::start(&mut draw);
        let columns: Vec<[f32; FRICTION_INPUTS]> =
            (0..40).map(|_| core::array::from_fn(|_| draw.uniform(-1.0, 1.0) as f32)).collect();
        let mut stream = Stream::new();
        for (index, column) in columns.iter().enumerate() {
            let output = stream.step(&net, *column, &[None; 4]);
            if index + 1 >= WINDOW {
                let window = columns[index + 1 - WINDOW..=index].as_flattened();
                assert_eq!(output.to_bits(), net.window(window).to_bits(), "column {index}");
            }
        }
    }
}
