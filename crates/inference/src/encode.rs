//! Writing a model image: the counterpart of [`crate::Model::load`], for the tool that trains and quantises.
//!
//! Lives here so that the format has one home. The controller does not call it.

use crate::header::Header;
use crate::layout::{
    BLOCK, BLOCKS, CHANNELS, COLLISION_TAPS, CONVOLUTIONS, CRC_LENGTH, FRICTION_TAPS, HEAD_WEIGHTS,
    HEADER_LENGTH, HIDDEN_TAPS, IMAGE_LENGTH, check_sum,
};

/// One quantised convolution, weights `[output][tap x input]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConvolutionParts<const TAPS: usize> {
    /// Biases at the accumulator's scale.
    pub biases: [i32; CHANNELS],
    /// Requantisation factors times 2^32, above 0.
    pub multipliers: [i32; CHANNELS],
    /// Weights, oldest column first.
    pub weights: [[i8; TAPS]; CHANNELS],
}

/// One quantised head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadParts {
    /// What one count of the accumulator is worth.
    pub scale: f32,
    /// Bias at the accumulator's scale.
    pub bias: i32,
    /// Weights, oldest column first.
    pub weights: [i8; HEAD_WEIGHTS],
}

/// One quantised network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetworkParts<const TAPS: usize> {
    /// First convolution.
    pub first: ConvolutionParts<TAPS>,
    /// Second convolution.
    pub second: ConvolutionParts<HIDDEN_TAPS>,
    /// Third convolution.
    pub third: ConvolutionParts<HIDDEN_TAPS>,
    /// Dense head.
    pub head: HeadParts,
}

struct Writer<'a> {
    rest: &'a mut [u8],
}

impl Writer<'_> {
    /// Writes what still fits; the lengths are fixed by the types, so everything does.
    fn put(&mut self, bytes: impl IntoIterator<Item = u8>) {
        let rest = core::mem::take(&mut self.rest);
        let mut slots = rest.iter_mut();
        for byte in bytes {
            if let Some(slot) = slots.next() {
                *slot = byte;
            }
        }
        self.rest = slots.into_slice();
    }

    fn convolution<const TAPS: usize>(&mut self, parts: &ConvolutionParts<TAPS>) {
        self.put(parts.biases.into_iter().flat_map(i32::to_le_bytes));
        self.put(parts.multipliers.into_iter().flat_map(i32::to_le_bytes));
        for block in 0..BLOCKS {
            for tap in 0..TAPS {
                let outputs = parts.weights.iter().skip(block * BLOCK).take(BLOCK);
                self.put(outputs.filter_map(|row| row.get(tap)).map(|&weight| weight as u8));
            }
        }
    }

    fn network<const TAPS: usize>(&mut self, parts: &NetworkParts<TAPS>) {
        self.convolution(&parts.first);
        self.convolution(&parts.second);
        self.convolution(&parts.third);
        self.put(parts.head.scale.to_le_bytes());
        self.put(parts.head.bias.to_le_bytes());
        self.put(parts.head.weights.into_iter().map(|weight| weight as u8));
    }
}

/// Writes a whole image and its check sum into `out`. The header's `crc` is not used.
///
/// Nothing is checked here: load the image afterwards.
pub fn write(
    header: &Header,
    collision: &NetworkParts<COLLISION_TAPS>,
    friction: &NetworkParts<FRICTION_TAPS>,
    out: &mut [u8; IMAGE_LENGTH],
) {
    let mut head = [0; HEADER_LENGTH];
    header.write(IMAGE_LENGTH, &mut head);
    let mut writer = Writer { rest: out };
    writer.put(head);
    writer.network(collision);
    writer.network(friction);
    seal(out);
}

/// Puts the check sum of everything before it at the end of an image.
pub fn seal(image: &mut [u8; IMAGE_LENGTH]) {
    if let Some((body, sum)) = image.split_last_chunk_mut::<CRC_LENGTH>() {
        *sum = check_sum(body).to_le_bytes();
    }
}

const _: () = assert!(CONVOLUTIONS == 3 && BLOCK * BLOCKS == CHANNELS);
