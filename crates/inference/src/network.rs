//! A network as stored, and the same network as a stream of columns.

use crate::error::{ImageError, LayerName};
use crate::layer::{Convolution, Head};
use crate::layout::{CHANNELS, HEAD_COLUMNS, HIDDEN_TAPS, KERNEL};
use crate::read::Reader;

/// Three convolutions and a head; `TAPS` = 3 times the inputs per column.
#[derive(Clone, Copy, Debug)]
pub struct Network<'a, const TAPS: usize> {
    /// First convolution, on the features.
    pub first: Convolution<'a, TAPS>,
    /// Second convolution.
    pub second: Convolution<'a, HIDDEN_TAPS>,
    /// Third convolution.
    pub third: Convolution<'a, HIDDEN_TAPS>,
    /// Dense head.
    pub head: Head<'a>,
}

impl<'a, const TAPS: usize> Network<'a, TAPS> {
    /// Takes a network from an image; `names` are its layers' names in messages.
    pub(crate) fn read(
        reader: &mut Reader<'a>,
        convolution: fn(u8) -> LayerName,
        head: LayerName,
    ) -> Result<Self, ImageError> {
        Ok(Self {
            first: Convolution::read(reader, convolution(0))?,
            second: Convolution::read(reader, convolution(1))?,
            third: Convolution::read(reader, convolution(2))?,
            head: Head::read(reader, head)?,
        })
    }
}

/// The history that a stream keeps: for each layer the columns it looks at, oldest first, newest last.
///
/// A fresh history is zero everywhere: the causal zero padding of every layer.
#[derive(Clone, Copy, Debug)]
pub struct Stream<const TAPS: usize> {
    inputs: [i16; TAPS],
    first: [i16; HIDDEN_TAPS],
    second: [i16; HIDDEN_TAPS],
    third: [[i16; CHANNELS]; HEAD_COLUMNS],
}

impl<const TAPS: usize> Default for Stream<TAPS> {
    fn default() -> Self {
        Self {
            inputs: [0; TAPS],
            first: [0; HIDDEN_TAPS],
            second: [0; HIDDEN_TAPS],
            third: [[0; CHANNELS]; HEAD_COLUMNS],
        }
    }
}

impl<const TAPS: usize> Stream<TAPS> {
    /// Takes one column of `C` = `TAPS / 3` inputs and gives the head's accumulator and the clipped activations.
    #[inline]
    pub fn step<const C: usize>(&mut self, network: &Network<'_, TAPS>, column: &[i16; C]) -> (i32, u16) {
        const { assert!(TAPS == KERNEL * C) };
        let mut outputs = [0; CHANNELS];
        push(&mut self.inputs, column);
        let mut clipped = network.first.apply(&self.inputs, &mut outputs);
        push(&mut self.first, &outputs);
        clipped = clipped.wrapping_add(network.second.apply(&self.first, &mut outputs));
        push(&mut self.second, &outputs);
        clipped = clipped.wrapping_add(network.third.apply(&self.second, &mut outputs));
        let [older, newest] = &mut self.third;
        *older = *newest;
        *newest = outputs;
        (network.head.apply(&self.third), clipped)
    }
}

/// Drops the oldest of three columns and appends the newest.
#[inline]
fn push<const C: usize, const TAPS: usize>(columns: &mut [i16; TAPS], newest: &[i16; C]) {
    if let ([oldest, middle, last], []) = columns.as_chunks_mut::<C>() {
        *oldest = *middle;
        *middle = *last;
        *last = *newest;
    }
}

const _: () = assert!(HIDDEN_TAPS == KERNEL * CHANNELS && KERNEL == 3 && HEAD_COLUMNS == 2);
