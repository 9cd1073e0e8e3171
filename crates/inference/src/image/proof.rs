//! Proof from the actual weights that no sum of a network can overflow.
//!
//! For every output, `|bias| + sum |weight| * 2^(input bits - 1)` must be below 2^31. The proof is
//! a constant function: it runs when an image is loaded and, for the shipped images, already when
//! the crate is compiled.
//!
//! The bound holds for every order of the additions and every partial sum, for all inputs from
//! -2^15 or -2^7 on. Weights that pad a group count, although kernels multiply them by 0 only. So
//! an image may be refused because of them, but never wrongly accepted.

use super::SHAPE_LENGTH;
use super::shape::{LayerKind, LayerShape, WeightForm};
use crate::kernel::BLOCK;

/// Reason why a network could not be proven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unproven {
    /// The bytes are not a complete sequence of layers.
    Malformed {
        /// Position of the layer, counted over all networks.
        layer: u8,
    },
    /// A sum can overflow.
    Overflow {
        /// Position of the layer, counted over all networks.
        layer: u8,
        /// Output channel.
        output: u16,
        /// Largest magnitude that the sum can reach.
        largest: i64,
    },
    /// A multiplier is not above 0 or a shift is out of range.
    Scale {
        /// Position of the layer, counted over all networks.
        layer: u8,
    },
}

/// Range of a head's shift for which the arithmetic of the estimate is valid.
pub(crate) const SHIFT_RANGE: core::ops::RangeInclusive<u32> = 25..=78;

/// Proves every layer of a sequence.
pub const fn prove(networks: &[u8]) -> Result<(), Unproven> {
    let mut remaining = networks;
    let mut layer = 0u8;
    while let Some((shape, after)) = remaining.split_first_chunk::<SHAPE_LENGTH>() {
        let Some(shape) = LayerShape::from_bytes(shape) else { return Err(Unproven::Malformed { layer }) };
        let Some((body, after)) = after.split_at_checked(shape.length().wrapping_sub(SHAPE_LENGTH)) else {
            return Err(Unproven::Malformed { layer });
        };
        if let Err(error) = prove_layer(layer, &shape, body) {
            return Err(error);
        }
        remaining = after;
        layer = layer.saturating_add(1);
    }
    if remaining.is_empty() { Ok(()) } else { Err(Unproven::Malformed { layer }) }
}

const fn prove_layer(layer: u8, shape: &LayerShape, mut body: &[u8]) -> Result<(), Unproven> {
    let malformed = Err(Unproven::Malformed { layer });
    let outputs = shape.outputs as usize;
    let is_head = matches!(shape.kind, LayerKind::Head);
    let mut head_biases: &[u8] = &[];
    if is_head {
        let (Some(multiplier), Some(shift)) = (word(&mut body), word(&mut body)) else { return malformed };
        let shift = u32::from_le_bytes(shift);
        let in_range = shift >= *SHIFT_RANGE.start() && shift <= *SHIFT_RANGE.end();
        if i32::from_le_bytes(multiplier) <= 0 || !in_range {
            return Err(Unproven::Scale { layer });
        }
        (head_biases, body) = match body.split_at_checked(outputs.wrapping_mul(4)) {
            Some(parts) => parts,
            None => return malformed,
        };
    }
    let mut output = 0;
    while output < outputs {
        let side_by_side = if outputs.wrapping_sub(output) >= BLOCK { BLOCK } else { 1 };
        let mut sums = [0i64; BLOCK];
        let mut lane = 0;
        while lane < side_by_side {
            let bias = word(if is_head { &mut head_biases } else { &mut body });
            let Some(bias) = bias else { return malformed };
            set(&mut sums, lane, i32::from_le_bytes(bias).unsigned_abs() as i64);
            lane = lane.wrapping_add(1);
        }
        let mut group = 0;
        while group < shape.groups().wrapping_mul(side_by_side) {
            let Some(bytes) = word(&mut body) else { return malformed };
            let lane = group % side_by_side;
            let grown = get(&sums, lane)
                .wrapping_add(magnitude(shape.form, bytes) << (shape.input_bits.wrapping_sub(1) & 15));
            set(&mut sums, lane, grown);
            group = group.wrapping_add(1);
        }
        let mut lane = 0;
        while lane < side_by_side {
            let largest = get(&sums, lane);
            if largest > i32::MAX as i64 {
                return Err(Unproven::Overflow { layer, output: output.wrapping_add(lane) as u16, largest });
            }
            if !is_head {
                let Some(multiplier) = word(&mut body) else { return malformed };
                if i32::from_le_bytes(multiplier) <= 0 {
                    return Err(Unproven::Scale { layer });
                }
            }
            lane = lane.wrapping_add(1);
        }
        output = output.wrapping_add(side_by_side);
    }
    if body.is_empty() { Ok(()) } else { malformed }
}

/// Reads the next four bytes.
const fn word(bytes: &mut &[u8]) -> Option<[u8; 4]> {
    match bytes.split_first_chunk() {
        Some((word, after)) => {
            *bytes = after;
            Some(*word)
        }
        None => None,
    }
}

/// Returns one of four sums; 0 for an invalid lane, which does not occur.
const fn get(sums: &[i64; BLOCK], lane: usize) -> i64 {
    if lane < BLOCK { sums[lane] } else { 0 }
}

const fn set(sums: &mut [i64; BLOCK], lane: usize, value: i64) {
    if lane < BLOCK {
        sums[lane] = value;
    }
}

/// Returns the sum of the magnitudes of a group of weights.
const fn magnitude(form: WeightForm, [a, b, c, d]: [u8; 4]) -> i64 {
    match form {
        WeightForm::Packed => {
            let low = ((a as i8).unsigned_abs() as i64).wrapping_add((b as i8).unsigned_abs() as i64);
            let high = ((c as i8).unsigned_abs() as i64).wrapping_add((d as i8).unsigned_abs() as i64);
            low.wrapping_add(high)
        }
        WeightForm::Wide => {
            let (low, high) = (i16::from_le_bytes([a, b]), i16::from_le_bytes([c, d]));
            (low.unsigned_abs() as i64).wrapping_add(high.unsigned_abs() as i64)
        }
    }
}
