//! Float networks with the stepping interface of [`inference::Pair`]: the estimation chain before
//! quantisation.

use crate::data::features::FloatFeatures;
use crate::network::checkpoint::{Checkpoint, CheckpointError};
use crate::network::shipped::shipped_checkpoint;
use crate::network::{LAYERS, Network, Shape, rectify};
use inference::{BearingMaterial, ContactState, Flags, Header, WINDOW};

/// Estimate of the float networks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FloatEstimate {
    /// Normal force in N, never below 0, exactly 0 without contact.
    pub normal_force_n: f32,
    /// Friction force in N along the sliding direction: opposed to the sliding speed.
    pub friction_force_n: f32,
    /// Flags of this estimate.
    pub flags: Flags,
}

/// Grid that features or activations are rounded to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ActivationGrid {
    /// Distance of two grid points.
    pub step: f32,
    /// Largest grid index; values beyond are clamped.
    pub max_level: f32,
}

impl ActivationGrid {
    fn round(self, values: &mut [f32]) {
        for value in values {
            *value = libm::roundf(*value / self.step).clamp(-self.max_level, self.max_level) * self.step;
        }
    }
}

/// Grids for the features and for the outputs of the three convolutions, to measure the error of
/// each quantisation step; None leaves a value unrounded.
pub(crate) type Rounding = [Option<ActivationGrid>; LAYERS];

/// History of one float network without padding; zero before the start, as on the controller.
#[derive(Clone, Debug)]
struct Stream {
    /// Input columns that each layer takes, oldest first.
    windows: Vec<Vec<f32>>,
    /// Newest output column of a layer, and a buffer for the next one.
    columns: [Vec<f32>; 2],
}

impl Stream {
    fn new(shape: &Shape) -> Self {
        let windows = shape.layers().iter().map(|layer| vec![0.0; layer.taps()]).collect();
        Self { windows, columns: [Vec::new(), Vec::new()] }
    }

    fn reset(&mut self) {
        for window in &mut self.windows {
            window.fill(0.0);
        }
    }

    fn step(&mut self, network: &Network, column: &[f32], rounding: &Rounding) -> f32 {
        let [newest, next] = &mut self.columns;
        newest.clear();
        newest.extend(column);
        let head = self.windows.len().saturating_sub(1);
        for (index, (layer, window)) in network.layers().iter().zip(&mut self.windows).enumerate() {
            if let Some(grid) = rounding.get(index).copied().flatten() {
                grid.round(newest);
            }
            push(window, newest);
            next.clear();
            next.resize(layer.biases.len(), 0.0);
            layer.sums(window, next);
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
    features: FloatFeatures,
    networks: [Network; 2],
    rounding: [Rounding; 2],
    streams: [Stream; 2],
    /// Samples since the start or the last reset.
    samples: usize,
}

impl FloatPair {
    /// Loads the shipped networks of a bearing.
    pub fn new(bearing: BearingMaterial) -> Result<Self, CheckpointError> {
        Ok(Self::from_checkpoint(&Checkpoint::from_bytes(shipped_checkpoint(bearing))?))
    }

    /// Takes the float weights of a checkpoint.
    pub(crate) fn from_checkpoint(checkpoint: &Checkpoint) -> Self {
        let networks = [checkpoint.collision.float.clone(), checkpoint.friction.float.clone()];
        Self::with_rounding(checkpoint.header(), networks, [[None; LAYERS]; 2])
    }

    /// Takes any two networks without padding, collision first, and rounds some of their
    /// activations.
    pub(crate) fn with_rounding(header: Header, networks: [Network; 2], rounding: [Rounding; 2]) -> Self {
        let streams = [0, 1].map(|which: usize| Stream::new(networks[which].shape()));
        Self { features: FloatFeatures::from_header(&header), networks, rounding, streams, samples: 0 }
    }

    /// Clears the history.
    pub fn reset(&mut self) {
        for stream in &mut self.streams {
            stream.reset();
        }
        self.samples = 0;
    }

    /// Takes one sample and estimates its forces. A sample with a non-finite value gives 0 and
    /// clears the history.
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
        self.samples = self.samples.saturating_add(1);
        let flags = column.flags
            | Flags::OUTSIDE_FORCE.when(normal_force_n > self.features.normal_force_n.high)
            | Flags::IMPLAUSIBLE_FRICTION.when(coefficient >= 1.0)
            | Flags::WARMING_UP.when(self.samples < WINDOW);
        FloatEstimate { normal_force_n, friction_force_n, flags }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::draw::{Draw, Purpose};
    use crate::network::NetworkKind;
    use inference::features::FRICTION_INPUTS;

    #[test]
    fn a_warm_stream_gives_the_output_of_the_window() {
        let mut draw = Draw::new(8, Purpose::Weights, 0);
        let net = Network::start(NetworkKind::Friction.shape(), &mut draw);
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
