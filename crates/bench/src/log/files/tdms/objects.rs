//! Objects of a TDMS file: properties, places of the values, times of waveforms.

use super::bytes::{Kind, seconds};
use std::collections::HashMap;

/// Seconds between two samples of a waveform, time of the first one since the start, and start.
pub(super) const INCREMENT: &str = "wf_increment";
pub(super) const OFFSET: &str = "wf_start_offset";
pub(super) const START: &str = "wf_start_time";
/// Unit of the increments, if they are not seconds.
pub(super) const UNIT: &str = "wf_xunit_string";
/// Units of time with their number in a second.
pub(super) const UNITS: [(&str, f64); 5] =
    [("s", 1.0), ("ms", 1e3), ("us", 1e6), ("\u{b5}s", 1e6), ("ns", 1e9)];

/// Property of an object, as far as it is used.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Property {
    Number(f64),
    /// Time since 1904 in 2^-64 s.
    Stamp(u128),
    Text(String),
    Other,
}

pub(super) type Properties = HashMap<String, Property>;

/// Values at equal distances in the file, repeated in every chunk of a segment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) kind: Kind,
    pub(super) is_big: bool,
    /// Place of the first value, bytes from the start of the file.
    pub(super) start: usize,
    /// Values in each chunk, and bytes from one to the next.
    pub(super) count: usize,
    pub(super) stride: usize,
    /// Number of chunks, and bytes from one to the next.
    pub(super) chunks: usize,
    pub(super) chunk_bytes: usize,
}

impl Piece {
    /// Appends values that follow at the same distances, so that a file of many short segments
    /// needs little memory; returns `false` for others.
    pub(super) fn continues(&mut self, next: &Self) -> bool {
        let distance = next.start.saturating_sub(self.start);
        let is_alike = (self.kind, self.is_big, self.count, self.stride)
            == (next.kind, next.is_big, next.count, next.stride);
        let is_even = match self.chunks {
            1 => distance > 0,
            chunks => self.chunk_bytes.checked_mul(chunks) == Some(distance),
        };
        if !is_alike || !is_even || next.chunks != 1 {
            return false;
        }
        if self.chunks == 1 {
            self.chunk_bytes = distance;
        }
        self.chunks += 1;
        true
    }
}

/// Object of a file: the file itself, a group or a channel.
#[derive(Debug, Default)]
pub(super) struct Object {
    pub(super) path: Vec<String>,
    pub(super) properties: Properties,
    pub(super) pieces: Vec<Piece>,
    /// Number of values in all pieces.
    pub(super) count: usize,
    /// Content that cannot be read as numbers.
    pub(super) refusal: Option<&'static str>,
    /// True if a waveform begins anew or changes its increment.
    pub(super) has_changed_times: bool,
}

impl Object {
    pub(super) fn number(&self, name: &str) -> Option<f64> {
        if let Some(Property::Number(value)) = self.properties.get(name) { Some(*value) } else { None }
    }

    pub(super) fn text(&self, name: &str) -> &str {
        if let Some(Property::Text(text)) = self.properties.get(name) { text } else { "" }
    }

    /// Start of a waveform; `None` if it is not set.
    pub(super) fn start(&self) -> Option<u128> {
        match self.properties.get(START) {
            Some(Property::Stamp(start)) if *start != 0 => Some(*start),
            _ => None,
        }
    }

    /// Sets a property. A waveform may state its start again in a later segment; a start that does
    /// not continue it, and another increment, end the times of the channel.
    pub(super) fn set(&mut self, name: String, value: Property) {
        if !self.pieces.is_empty() && self.number(INCREMENT).is_some() {
            let continues = match (name.as_str(), &value, self.start()) {
                (INCREMENT, value, _) => self.properties.get(INCREMENT) == Some(value),
                (START, Property::Stamp(new), Some(old)) if *new == old => true,
                (START, Property::Stamp(new), Some(old)) => {
                    let increment_s = self.number(INCREMENT).unwrap_or(0.0);
                    let expected_s = increment_s * self.count as f64;
                    if (seconds(*new, old) - expected_s).abs() <= 0.5 * increment_s {
                        return;
                    }
                    false
                }
                (START, ..) => false,
                _ => true,
            };
            self.has_changed_times |= !continues;
        }
        self.properties.insert(name, value);
    }

    /// Times of the samples of a waveform since an origin.
    pub(super) fn times(&self, origin: u128) -> Option<Times> {
        let increment = self.number(INCREMENT).filter(|increment| *increment > 0.0)?;
        let unit = if self.text(UNIT).is_empty() { "s" } else { self.text(UNIT) };
        // A start is no part of another axis, such as the frequencies of a spectrum.
        let per_second = UNITS.iter().find(|(name, _)| *name == unit).map_or(0.0, |(_, factor)| *factor);
        let start = self.start().map_or(0.0, |start| per_second * seconds(start, origin));
        let offset = start + self.number(OFFSET).unwrap_or(0.0);
        Some(Times { increment, offset, count: self.count, unit: unit.into() })
    }
}

/// Times of a waveform.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Times {
    pub(super) increment: f64,
    pub(super) offset: f64,
    pub(super) count: usize,
    pub(super) unit: String,
}

impl Times {
    /// First time in units of a thousandth of an increment, less than which no two waveforms are
    /// taken to be apart: a measuring card states starts that differ by a rounding.
    pub(super) fn first_mark(&self) -> i64 {
        (1000.0 * self.offset / self.increment).round() as i64
    }
}
