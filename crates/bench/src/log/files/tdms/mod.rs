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
mod objects;
mod scale;
mod segment;

use super::file::{LogFile, MAX_NAMES, MAX_ROWS, MAX_VALUES, refused, unique_names};
use crate::log::LogError;
use bytes::{Flaw, Kind};
use objects::{INCREMENT, Object, Times};
use scale::Scales;
pub(in crate::log::files) use segment::TDMS;
use std::collections::HashMap;

const COMPLETE: &str = "a complete TDMS file";
/// Name of the column of times.
const TIMES: &str = "wf_time";

/// Column of a file.
enum Column {
    Channel(usize),
    Times(Times),
    /// Times that the file does not state, with the reason.
    Unknown(&'static str),
}

/// Channels of a file.
pub(in crate::log::files) struct Tdms {
    bytes: Vec<u8>,
    objects: Vec<Object>,
    columns: Vec<Column>,
    names: Vec<String>,
    groups: Vec<String>,
    /// Column with the times of each column.
    times: Vec<Option<usize>>,
    /// Earliest start of a waveform or first time stamp of a channel.
    origin: u128,
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
        let (names, groups) = (Vec::new(), Vec::new());
        let mut out =
            Self { bytes, objects, columns: Vec::new(), names, groups, times: Vec::new(), origin: 0 };
        out.origin = out.objects.iter().filter_map(|object| out.first_stamp(object)).min().unwrap_or(0);
        out.list();
        if out.columns.is_empty() {
            return Err(LogError::content(file, "no channels", "a channel for each signal"));
        }
        Ok(out)
    }

    /// Earliest time that an object states: start of a waveform, else first stamp of a channel.
    fn first_stamp(&self, object: &Object) -> Option<u128> {
        let piece = object.pieces.first().filter(|piece| piece.kind == Kind::Timestamp);
        let first = piece.map(|piece| piece.kind.stamp(self.after(piece.start), piece.is_big));
        let start = object.start().filter(|_| object.number(INCREMENT).is_some());
        start.or(first)
    }

    /// Lists the columns: channels, and times of waveforms, each once.
    fn list(&mut self) {
        let mut places = Vec::new();
        let has_starts = self.objects.iter().any(|o| o.start().is_some() && o.number(INCREMENT).is_some());
        let mut known: HashMap<(&str, u64, i64, usize), usize> = HashMap::new();
        for (index, object) in self.objects.iter().enumerate() {
            let [group, channel] = object.path.as_slice() else { continue };
            places.push((group.clone(), channel.clone()));
            self.columns.push(Column::Channel(index));
            let times = object.times(self.origin).filter(|times| object.refusal.is_none() && times.count > 0);
            let Some(times) = times else {
                self.times.push(None);
                continue;
            };
            let flaw = match () {
                () if object.has_changed_times => {
                    Some("a waveform that begins anew or changes its increment")
                }
                () if has_starts && object.start().is_none() => {
                    Some("a waveform without a start time, while others of the file have one")
                }
                () => None,
            };
            if let Some(flaw) = flaw {
                self.times.push(None);
                places.push((group.clone(), TIMES.into()));
                self.columns.push(Column::Unknown(flaw));
                self.times.push(None);
                continue;
            }
            let key = (group.as_str(), times.increment.to_bits(), times.first_mark(), times.count);
            let found = known.get(&key).copied();
            let place = found.unwrap_or(self.columns.len());
            self.times.push(Some(place));
            if found.is_none() {
                known.insert(key, place);
                places.push((group.clone(), TIMES.into()));
                self.columns.push(Column::Times(times));
                self.times.push(Some(place));
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
            Scales::from_properties(&object.properties)
        };
        let own = Scales::from_properties(&channel.properties);
        own.or_else(|| of(1)).or_else(|| of(0)).unwrap_or_else(|| Ok(Scales::default()))
    }

    fn after(&self, at: usize) -> &[u8] {
        self.bytes.get(at..).unwrap_or_default()
    }

    /// Numbers of a channel; time stamps are in s since the first one of the file.
    fn numbers(&self, channel: &Object) -> Result<Vec<f64>, String> {
        if let Some(refusal) = channel.refusal {
            return Err(refusal.into());
        }
        if channel.count > MAX_ROWS {
            return Err(format!("more than {MAX_ROWS} values"));
        }
        let scales = self.scales(channel)?;
        let mut out = Vec::with_capacity(channel.count);
        for piece in &channel.pieces {
            for chunk in 0..piece.chunks {
                for index in 0..piece.count {
                    let at = piece.start + chunk * piece.chunk_bytes + index * piece.stride;
                    let stored = piece.kind.number(self.after(at), piece.is_big, self.origin);
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

    fn time_of(&self, index: usize) -> Option<usize> {
        self.times.get(index).copied().flatten()
    }

    fn unit(&self, index: usize) -> &str {
        match self.columns.get(index) {
            Some(Column::Times(times)) => &times.unit,
            Some(Column::Channel(channel)) => match self.objects.get(*channel) {
                Some(object) if object.pieces.first().is_some_and(|p| p.kind == Kind::Timestamp) => "s",
                Some(object) => object.text("unit_string"),
                None => "",
            },
            Some(Column::Unknown(_)) | None => "",
        }
    }

    fn values(&self, file: &str, index: usize, wanted: &str, _: bool) -> Result<Vec<f64>, LogError> {
        let name = self.names.get(index).map_or("", String::as_str);
        let refuse = |found: String| refused(file, (name, wanted), found, "numbers with a linear scale");
        match self.columns.get(index) {
            Some(Column::Times(Times { increment, offset, count, .. })) => {
                Ok((0..*count).map(|i| offset + i as f64 * increment).collect())
            }
            Some(Column::Unknown(flaw)) => Err(refuse((*flaw).into())),
            Some(Column::Channel(channel)) => {
                let channel = self.objects.get(*channel).ok_or_else(|| refuse("no channel".into()))?;
                self.numbers(channel).map_err(refuse)
            }
            None => Err(refuse(format!("only {} columns", self.columns.len()))),
        }
    }
}
