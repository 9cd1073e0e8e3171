//! The network in f32: weights, evaluation of a window, gradients.
//!
//! Weights are stored tap by tap over the 16 output channels, as the kernels want them; the two hidden convolutions also
//! have a copy channel by channel for the way back.

use crate::draw::Draw;
use crate::kernels::{collect, convolve, spread};
use crate::shapes::{HEAD_WEIGHTS, HIDDEN_TAPS};
use inference::model::{CHANNELS, HEAD_COLUMNS, KERNEL, WINDOW};

/// Columns after the first, second and third convolution of a window.
const AFTER: [usize; 3] = [WINDOW - 2, WINDOW - 4, WINDOW - 6];
const _: () = assert!(AFTER[2] == HEAD_COLUMNS && KERNEL == 3);

/// Weights of one convolution by tap, then output channel.
pub type Taps<const T: usize> = [[f32; CHANNELS]; T];

/// Weights (or gradients, or moments) of one network; `T` = 3 times the inputs per column.
#[derive(Clone, Debug, PartialEq)]
pub struct Net<const T: usize> {
    /// First convolution.
    pub first: Taps<T>,
    /// Its biases.
    pub first_bias: [f32; CHANNELS],
    /// Second convolution.
    pub second: Taps<HIDDEN_TAPS>,
    /// Its biases.
    pub second_bias: [f32; CHANNELS],
    /// Third convolution.
    pub third: Taps<HIDDEN_TAPS>,
    /// Its biases.
    pub third_bias: [f32; CHANNELS],
    /// Head, oldest column first.
    pub head: [f32; HEAD_WEIGHTS],
    /// Its bias.
    pub head_bias: [f32; 1],
}

impl<const T: usize> Net<T> {
    /// Number of weights and biases.
    pub const PARAMETERS: usize = CHANNELS * (T + 2 * HIDDEN_TAPS + 3) + HEAD_WEIGHTS + 1;

    /// All zeros.
    pub fn zero() -> Self {
        Self {
            first: [[0.0; CHANNELS]; T],
            first_bias: [0.0; CHANNELS],
            second: [[0.0; CHANNELS]; HIDDEN_TAPS],
            second_bias: [0.0; CHANNELS],
            third: [[0.0; CHANNELS]; HIDDEN_TAPS],
            third_bias: [0.0; CHANNELS],
            head: [0.0; HEAD_WEIGHTS],
            head_bias: [0.0],
        }
    }

    /// Seeded start (He's variance for the newest column, a tenth of its deviation for the older ones).
    pub fn start(draw: &mut Draw) -> Self {
        let mut net = Self::zero();
        fn fill(rows: &mut [[f32; CHANNELS]], draw: &mut Draw) {
            let newest = rows.len() / KERNEL;
            let deviation = libm::sqrt(2.0 / newest as f64);
            let older = rows.len() - newest;
            for (index, row) in rows.iter_mut().enumerate() {
                for weight in row {
                    let shrink = if index < older { 0.1 } else { 1.0 };
                    *weight = (deviation * shrink * draw.normal()) as f32;
                }
            }
        }
        fill(&mut net.first, draw);
        fill(&mut net.second, draw);
        fill(&mut net.third, draw);
        for bias in net.first_bias.iter_mut() {
            *bias = (0.3 * draw.normal()) as f32;
        }
        for weight in net.head.iter_mut().rev().take(CHANNELS) {
            *weight = (libm::sqrt(1.0 / CHANNELS as f64) * draw.normal()) as f32;
        }
        net
    }

    /// Every parameter, in the order of the checkpoint file.
    pub fn slices(&self) -> [&[f32]; 8] {
        [
            self.first.as_flattened(),
            &self.first_bias,
            self.second.as_flattened(),
            &self.second_bias,
            self.third.as_flattened(),
            &self.third_bias,
            &self.head,
            &self.head_bias,
        ]
    }

    /// Every parameter, to be changed.
    pub fn slices_mut(&mut self) -> [&mut [f32]; 8] {
        [
            self.first.as_flattened_mut(),
            &mut self.first_bias,
            self.second.as_flattened_mut(),
            &mut self.second_bias,
            self.third.as_flattened_mut(),
            &mut self.third_bias,
            &mut self.head,
            &mut self.head_bias,
        ]
    }

    /// Adds another one, parameter by parameter.
    pub fn add(&mut self, other: &Self) {
        for (mine, theirs) in self.slices_mut().into_iter().zip(other.slices()) {
            for (a, b) in mine.iter_mut().zip(theirs) {
                *a += b;
            }
        }
    }

    /// Evaluates a window of `WINDOW` columns, flattened, oldest first.
    pub fn window(&self, columns: &[f32]) -> f32 {
        self.forward(columns, &mut Trace::default())
    }

    /// Evaluates a window and keeps the activations.
    pub fn forward(&self, columns: &[f32], trace: &mut Trace) -> f32 {
        convolve(columns, T / KERNEL, &self.first, &self.first_bias, &mut trace.first);
        convolve(trace.first.as_flattened(), CHANNELS, &self.second, &self.second_bias, &mut trace.second);
        convolve(trace.second.as_flattened(), CHANNELS, &self.third, &self.third_bias, &mut trace.third);
        let mut sum = self.head_bias[0];
        for (x, w) in trace.third.as_flattened().iter().zip(&self.head) {
            sum += x * w;
        }
        sum
    }

    /// Adds the gradient of `slope * output` to `gradient`, after [`Net::forward`] on the same window.
    pub fn backward(
        &self,
        transposed: &Transposed,
        columns: &[f32],
        trace: &Trace,
        slope: f32,
        gradient: &mut Self,
    ) {
        gradient.head_bias[0] += slope;
        for (g, x) in gradient.head.iter_mut().zip(trace.third.as_flattened()) {
            *g += slope * x;
        }
        let mut third = [[0.0; CHANNELS]; AFTER[2]];
        for ((d, x), w) in third.as_flattened_mut().iter_mut().zip(trace.third.as_flattened()).zip(&self.head)
        {
            *d = if *x > 0.0 { slope * w } else { 0.0 };
        }
        collect(trace.second.as_flattened(), CHANNELS, &third, &mut gradient.third, &mut gradient.third_bias);
        let mut second = [[0.0; CHANNELS]; AFTER[1]];
        spread(&third, &transposed.third, &trace.second, &mut second);
        collect(
            trace.first.as_flattened(),
            CHANNELS,
            &second,
            &mut gradient.second,
            &mut gradient.second_bias,
        );
        let mut first = [[0.0; CHANNELS]; AFTER[0]];
        spread(&second, &transposed.second, &trace.first, &mut first);
        collect(columns, T / KERNEL, &first, &mut gradient.first, &mut gradient.first_bias);
    }
}

/// The hidden convolutions by output channel, then tap.
#[derive(Clone, Debug)]
pub struct Transposed {
    second: [[f32; HIDDEN_TAPS]; CHANNELS],
    third: [[f32; HIDDEN_TAPS]; CHANNELS],
}

impl Transposed {
    /// Transposes the hidden convolutions of a network.
    pub fn of<const T: usize>(net: &Net<T>) -> Self {
        let turn = |taps: &Taps<HIDDEN_TAPS>| {
            core::array::from_fn(|output| core::array::from_fn(|tap| taps[tap][output]))
        };
        Self { second: turn(&net.second), third: turn(&net.third) }
    }
}

/// Activations of one window, after ReLU.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// After the first convolution.
    pub first: [[f32; CHANNELS]; AFTER[0]],
    /// After the second.
    pub second: [[f32; CHANNELS]; AFTER[1]],
    /// After the third.
    pub third: [[f32; CHANNELS]; AFTER[2]],
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::Purpose;

    /// The same network in f64, written plainly, for finite differences.
    fn exact(net: &[f64], columns: &[f32], inputs: usize) -> f64 {
        let mut at = 0;
        let mut values: Vec<f64> = columns.iter().map(|&x| f64::from(x)).collect();
        let mut stride = inputs;
        for _ in 0..3 {
            let taps = KERNEL * stride;
            let bias = at + taps * CHANNELS;
            let positions = values.len() / stride - 2;
            let mut next = Vec::new();
            for p in 0..positions {
                for o in 0..CHANNELS {
                    let sum: f64 =
                        (0..taps).map(|j| net[at + j * CHANNELS + o] * values[p * stride + j]).sum();
                    next.push((sum + net[bias + o]).max(0.0));
                }
            }
            at = bias + CHANNELS;
            values = next;
            stride = CHANNELS;
        }
        let dot: f64 = values.iter().enumerate().map(|(j, x)| x * net[at + j]).sum();
        dot + net[at + HEAD_WEIGHTS]
    }

    #[test]
    fn gradient_matches_finite_differences() {
        const INPUTS: usize = 4;
        let mut draw = Draw::new(3, Purpose::Weights, 0);
        let net = Net::<{ 3 * INPUTS }>::start(&mut draw);
        let columns: Vec<f32> = (0..WINDOW * INPUTS).map(|_| draw.uniform(-1.0, 1.0) as f32).collect();
        let mut trace = Trace::default();
        let output = net.forward(&columns, &mut trace);
        let mut gradient = Net::zero();
        net.backward(&Transposed::of(&net), &columns, &trace, 1.0, &mut gradient);
        let flat: Vec<f64> = net.slices().concat().iter().map(|&w| f64::from(w)).collect();
        assert!((exact(&flat, &columns, INPUTS) - f64::from(output)).abs() < 1e-5);
        let gradient = gradient.slices().concat();
        assert_eq!(gradient.len(), Net::<{ 3 * INPUTS }>::PARAMETERS);
        let mut largest = 0.0_f64;
        for (index, &found) in gradient.iter().enumerate() {
            let mut moved = flat.clone();
            moved[index] += 1e-7;
            let above = exact(&moved, &columns, INPUTS);
            moved[index] -= 2e-7;
            let expected = (above - exact(&moved, &columns, INPUTS)) / 2e-7;
            largest = largest.max(expected.abs());
            assert!(
                (expected - f64::from(found)).abs() < 1e-4 * (1.0 + expected.abs()),
                "parameter {index}: found {found}, expected {expected}"
            );
        }
        assert!(largest > 0.1, "the gradient is not trivial");
    }
}
