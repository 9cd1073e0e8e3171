//! TDMS files of LabVIEW, DIAdem and FlexLogger, with the streams of measuring cards (DAQmx).
//!
//! Channels of numbers and times are listed with their unit, by name or, where two groups have the
//! same name, as `group/channel`. Linear and polynomial scales are applied. A channel that is a
//! waveform gets a column of times, `wf_time`. Every other content keeps its name and is refused
//! when a column asks for it: texts, complex numbers, scales of thermocouples and the like.
//!
//! This is own code because the published reader takes interleaved data for contiguous ones, and
//! knows neither the other byte order nor scales nor the streams of measuring cards. Layout: "TDMS
//! File Format Internal Structure", National Instruments; of the streams: npTDMS, which reads the
//! same files. A file is a sequence of segments: lead-in, list of objects, chunks of data. An
//! object that a segment does not describe keeps its place in the chunks.

mod bytes;
mod scale;
mod segment;

use super::file::{LogFile, MAX_NAMES, MAX_ROWS, MAX_VALUES, refused, unique_names};
use crate::log::LogError;
use bytes::Kind;
use scale::Scales;
use std::collections::HashMap;

/// First bytes of a file.
pub(in crate::log::files) const TDMS: &[u8] = b"TDSm";
const COMPLETE: &str = "a complete TDMS file";
/// Seconds between two samples of a waveform, and time of the first one.
const INCREMENT: &str = "wf_increment";
const OFFSET: &str = "wf_start_offset";
/// Name of the column of times.
const TIMES: &str = "wf_time";

/// Reason to stop parsing a file.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Flaw {
    Damage,
    TooLarge,
}

/// Property of an object, as far as it is used.
#[derive(Clone, Debug, PartialEq)]
enum Property {
    Number(f64),
    Text(String),
    Other,
}

type Properties = HashMap<String, Property>;

/// Values at equal distances in the file, repeated in every chunk of a segment.
#[derive(Clone, Copy, Debug)]
struct Piece {
    kind: Kind,
    is_big: bool,
    /// Place of the first value, bytes from the start of the file.
    start: usize,
    /// Values in each chunk, and bytes from one to the next.
    count: usize,
    stride: usize,
    /// Number of chunks, and bytes from one to the next.
    chunks: usize,
    chunk_bytes: usize,
}

/// Object of a file: the file itself, a group or a channel.
#[derive(Debug, Default)]
struct Object {
    path: Vec<String>,
    properties: Properties,
    pieces: Vec<Piece>,
    /// Content that cannot be read as numbers.
    refusal: Option<&'static str>,
}

impl Object {
    fn len(&self) -> usize {
        self.pieces.iter().map(|piece| piece.count * piece.chunks).sum()
    }

    fn number(&self, name: &str) -> Option<f64> {
        if let Some(Property::Number(value)) = self.properties.get(name) { Some(*value) } else { None }
    }
}

/// Column of a file.
enum Column {
    Channel(usize),
    Times { increment_s: f64, offset_s: f64, count: usize },
}

/// Channels of a file.
pub(in crate::log::files) struct Tdms {
    bytes: Vec<u8>,
    objects: Vec<Object>,
    columns: Vec<Column>,
    names: Vec<String>,
    groups: Vec<String>,
}

impl Tdms {
    pub(in crate::log::files) fn open(file: &str, bytes: Vec<u8>) -> Result<Self, LogError> {
        let objects = segment::objects(&bytes).map_err(|(flaw, at)| match flaw {
            Flaw::Damage => LogError::content(file, format!("damage in the segment at byte {at}"), COMPLETE),
            Flaw::TooLarge => LogError::content(
                file,
                "more than can be held",
                format!("at most {MAX_VALUES} numbers and {MAX_NAMES} objects; divide the log into several"),
            ),
        })?;
        let mut out = Self { bytes, objects, columns: Vec::new(), names: Vec::new(), groups: Vec::new() };
        out.list();
        if out.columns.is_empty() {
            return Err(LogError::content(file, "no channels", "a channel for each signal"));
        }
        Ok(out)
    }

    /// Lists the columns: channels with content, and times of waveforms, each once.
    fn list(&mut self) {
        let mut places = Vec::new();
        let mut known: HashMap<(&str, u64, u64), usize> = HashMap::new();
        for (index, object) in self.objects.iter().enumerate() {
            let [group, channel] = object.path.as_slice() else { continue };
            let count = object.len();
            if count == 0 && object.refusal.is_none() {
                continue;
            }
            places.push((group.clone(), channel.clone()));
            self.columns.push(Column::Channel(index));
            let increment_s = object.number(INCREMENT).filter(|increment_s| *increment_s > 0.0);
            let Some(increment_s) = increment_s.filter(|_| object.refusal.is_none()) else { continue };
            let offset_s = object.number(OFFSET).unwrap_or(0.0);
            let found = known.get(&(group.as_str(), increment_s.to_bits(), offset_s.to_bits()));
            match found.and_then(|place| self.columns.get_mut(*place)) {
                Some(Column::Times { count: known, .. }) => *known = count.max(*known),
                _ => {
                    known.insert((group, increment_s.to_bits(), offset_s.to_bits()), self.columns.len());
                    places.push((group.clone(), TIMES.into()));
                    self.columns.push(Column::Times { increment_s, offset_s, count });
                }
            }
        }
        self.names = unique_names(&places);
        self.groups = places.into_iter().map(|(group, _)| group).collect();
    }

    /// Scales of a channel: its own, else those of its group, else those of the file.
    fn scales(&self, channel: &Object) -> Result<Scales, String> {
        let of = |depth: usize| {
            let path = channel.path.get(..depth)?;
            let object = self.objects.iter().find(|object| object.path == path)?;
            Scales::of(&object.properties)
        };
        let own = Scales::of(&channel.properties);
        own.or_else(|| of(1)).or_else(|| of(0)).unwrap_or_else(|| Ok(Scales::default()))
    }

    fn after(&self, at: usize) -> &[u8] {
        self.bytes.get(at..).unwrap_or_default()
    }

    /// Numbers of a channel; time stamps are in s since the first one.
    fn numbers(&self, channel: &Object) -> Result<Vec<f64>, String> {
        if let Some(refusal) = channel.refusal {
            return Err(refusal.into());
        }
        if channel.len() > MAX_ROWS {
            return Err(format!("more than {MAX_ROWS} values"));
        }
        let scales = self.scales(channel)?;
        let first = |piece: &Piece| piece.kind.stamp(self.after(piece.start), piece.is_big);
        let origin = channel.pieces.first().map_or(0, first);
        let mut out = Vec::with_capacity(channel.len());
        for piece in &channel.pieces {
            for chunk in 0..piece.chunks {
                for index in 0..piece.count {
                    let at = piece.start + chunk * piece.chunk_bytes + index * piece.stride;
                    let stored = piece.kind.number(self.after(at), piece.is_big, origin);
                    out.push(scales.value(stored.ok_or("content that is no number")?));
                }
            }
        }
        Ok(out)
    }
}

impl LogFile for Tdms {
    fn format(&self) -> &'static str {
        "TDMS"
    }

    fn names(&self) -> &[String] {
        &self.names
    }

    fn group(&self, index: usize) -> &str {
        self.groups.get(index).map_or("", String::as_str)
    }

    fn unit(&self, index: usize) -> &str {
        match self.columns.get(index) {
            Some(Column::Times { .. }) => "s",
            Some(Column::Channel(channel)) => {
                let unit = self.objects.get(*channel).and_then(|o| o.properties.get("unit_string"));
                if let Some(Property::Text(unit)) = unit { unit } else { "" }
            }
            None => "",
        }
    }

    fn values(&self, file: &str, index: usize, wanted: &str, _: bool) -> Result<Vec<f64>, LogError> {
        let name = self.names.get(index).map_or("", String::as_str);
        let refuse = |found: String| refused(file, (name, wanted), found, "numbers with a linear scale");
        match self.columns.get(index) {
            Some(Column::Times { increment_s, offset_s, count }) => {
                Ok((0..*count).map(|i| offset_s + i as f64 * increment_s).collect())
            }
            Some(Column::Channel(channel)) => {
                let channel = self.objects.get(*channel).ok_or_else(|| refuse("no channel".into()))?;
                self.numbers(channel).map_err(refuse)
            }
            None => Err(refuse(format!("only {} columns", self.columns.len()))),
        }
    }
}
