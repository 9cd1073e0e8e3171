//! Stored numbers of a channel in the records of its group.

use super::blocks::{Channel, Flaw, Group};
use half::f16;

/// Flags of a channel: no value is valid, and a bit marks those that are invalid.
pub(super) const ALL_INVALID: u32 = 1;
pub(super) const HAS_MARK: u32 = 2;

/// Layout of a stored number.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Unsigned,
    Signed,
    Float,
}

/// Place and kind of a channel's number in a record.
pub(super) struct Field {
    kind: Kind,
    is_big: bool,
    start: usize,
    bytes: usize,
    shift: u32,
    bits: u32,
    /// Byte and bit of the mark of an invalid value.
    mark: Option<(usize, u8)>,
    is_all_invalid: bool,
}

impl Field {
    /// Field of a channel; the error says what the channel contains.
    pub(super) fn new(group: &Group, channel: &Channel) -> Result<Self, Flaw> {
        let (kind, is_big) = match channel.data_type {
            0 | 1 => (Kind::Unsigned, channel.data_type == 1),
            2 | 3 => (Kind::Signed, channel.data_type == 3),
            4 | 5 => (Kind::Float, channel.data_type == 5),
            6..=9 => return Err("texts".into()),
            _ => return Err("content that is no number".into()),
        };
        let (shift, bits) = (channel.bit_offset, channel.bits);
        let is_float = matches!(bits, 16 | 32 | 64) && shift == 0;
        if bits == 0 || bits > 64 || shift > 7 || kind == Kind::Float && !is_float {
            return Err(format!("numbers of {bits} bits"));
        }
        let (start, bytes) = (channel.byte_offset, (shift + bits).div_ceil(8) as usize);
        let mark = (channel.flags & HAS_MARK != 0)
            .then_some((group.value_bytes.saturating_add(channel.mark_bit / 8), 1 << (channel.mark_bit % 8)));
        if start.checked_add(bytes).is_none_or(|end| end > group.value_bytes) {
            return Err("values beyond the end of their records".into());
        }
        if mark.is_some_and(|(byte, _)| byte >= group.record_bytes()) {
            return Err("marks of invalid values beyond the end of their records".into());
        }
        let is_all_invalid = channel.flags & ALL_INVALID != 0;
        Ok(Self { kind, is_big, start, bytes, shift, bits, mark, is_all_invalid })
    }

    /// Returns whether the stored numbers are integers.
    pub(super) fn is_integer(&self) -> bool {
        self.kind != Kind::Float
    }

    /// Number in a record; `None` if it is invalid or cut off.
    pub(super) fn number(&self, record: &[u8]) -> Option<f64> {
        let is_marked = |(byte, bit): (usize, u8)| record.get(byte).is_some_and(|found| found & bit != 0);
        if self.is_all_invalid || self.mark.is_some_and(is_marked) {
            return None;
        }
        let stored = record.get(self.start..self.start + self.bytes)?;
        let join = |sum: u128, byte: &u8| (sum << 8) | u128::from(*byte);
        let word = if self.is_big { stored.iter().fold(0, join) } else { stored.iter().rev().fold(0, join) };
        let empty = 64 - self.bits;
        // The bits of the number, at the upper end of a word.
        let word = ((word >> self.shift) as u64) << empty;
        Some(match self.kind {
            Kind::Unsigned => (word >> empty) as f64,
            Kind::Signed => (word.cast_signed() >> empty) as f64,
            Kind::Float => match self.bits {
                16 => f16::from_bits((word >> empty) as u16).to_f64(),
                32 => f64::from(f32::from_bits((word >> empty) as u32)),
                _ => f64::from_bits(word),
            },
        })
    }
}
