//! MDF files of version 4 (`.mf4`; CANape, INCA, asammdf, CSS loggers), plain or compressed.
//!
//! Channels of numbers are listed with their unit, by name or, where two groups have the same name,
//! as `group/channel`; a group is called by its name, else by its number from 0. Conversions are
//! applied, and samples that are marked as invalid are missing values. A channel that is only
//! counted (a virtual one) has the values of its conversion. The times of a channel are those of
//! its group. Texts, arrays and other contents are refused when a column asks for them, files of
//! version 3 at once.
//!
//! This is own code because the published reader returns the stored number in place of the reading
//! where it does not know a formula or divides by zero, and does not list arrays and parts of
//! structures. Layout: ASAM MDF 4.1.

mod blocks;
mod conversion;
mod records;
mod values;

use super::file::{LogFile, MAX_NAMES, MAX_ROWS, refused, unique_names};
use crate::log::LogError;
use blocks::{Channel, Flaw, Group};
use conversion::Conversion;
use std::cell::RefCell;
use values::Field;

/// First bytes of a file.
pub(super) const MDF: &[u8] = b"MDF     ";
/// First bytes of a file whose writer was stopped.
pub(super) const UNFINISHED: &[u8] = b"UnFinMF ";
/// First digit of the version, in the file's first bytes.
const VERSION_AT: usize = 8;

/// Kinds of channels: of variable length, times or the like, the same without stored values, data
/// without stored values.
const VARIABLE: u8 = 1;
const MASTER: u8 = 2;
const VIRTUAL_MASTER: u8 = 3;
const VIRTUAL: u8 = 6;
/// Last kind of channel that is known.
const LAST: u8 = 6;
/// Mark of a channel of times among those that others are read over.
const TIME: u8 = 1;

const READABLE: &str = "complete MDF of version 4; asammdf converts other files";

/// Channels of a file.
pub(super) struct Mdf {
    bytes: Vec<u8>,
    groups: Vec<Group>,
    /// Group and channel of each column.
    places: Vec<(usize, usize)>,
    names: Vec<String>,
    units: Vec<String>,
    /// Column with the times of each group.
    times: Vec<Option<usize>>,
    /// Group whose records were read last.
    records: RefCell<Option<(usize, Vec<u8>)>>,
}

impl Mdf {
    pub(super) fn open(file: &str, bytes: Vec<u8>) -> Result<Self, LogError> {
        let refuse = |found: String| LogError::content(file, found, READABLE);
        if bytes.starts_with(UNFINISHED) {
            return Err(refuse("an MDF file that its writer did not finish".into()));
        }
        if bytes.get(VERSION_AT) != Some(&b'4') {
            let version = bytes.get(VERSION_AT..).unwrap_or_default();
            let version = String::from_utf8_lossy(version.get(..4).unwrap_or_default()).into_owned();
            return Err(refuse(format!("MDF of version {}", version.trim())));
        }
        let groups = blocks::groups(&bytes, MAX_NAMES).map_err(refuse)?;
        let (mut places, mut columns, mut units) = (Vec::new(), Vec::new(), Vec::new());
        let mut times = vec![None; groups.len()];
        for (number, group) in groups.iter().enumerate() {
            for (position, channel) in group.channels.iter().enumerate() {
                if is_time(channel)
                    && let Some(time @ None) = times.get_mut(number)
                {
                    *time = Some(places.len());
                }
                places.push((number, position));
                columns.push((group.name.clone(), channel.name.clone()));
                units.push(unit(&bytes, channel));
            }
        }
        if columns.is_empty() {
            return Err(LogError::content(file, "no channels", "a channel for each signal"));
        }
        let names = unique_names(&columns);
        Ok(Self { bytes, groups, places, names, units, times, records: RefCell::default() })
    }

    fn channel(&self, index: usize) -> Option<(usize, &Group, &Channel)> {
        let (number, position) = *self.places.get(index)?;
        let group = self.groups.get(number)?;
        Some((number, group, group.channels.get(position)?))
    }

    /// Numbers of a channel.
    fn numbers(&self, index: usize) -> Result<Vec<f64>, Flaw> {
        let (number, group, channel) = self.channel(index).ok_or("no such column")?;
        if group.count > MAX_ROWS as u64 {
            return Err(format!("more than {MAX_ROWS} rows"));
        }
        if channel.kind == VARIABLE || channel.kind > LAST {
            return Err("contents of variable length".into());
        }
        if let Some(refusal) = channel.refusal {
            return Err(refusal.into());
        }
        let conversion = Conversion::read(&self.bytes, channel.conversion)?;
        if !conversion.has_numbers() {
            return Err("texts".into());
        }
        if [VIRTUAL_MASTER, VIRTUAL].contains(&channel.kind) {
            return match channel.flags & (values::ALL_INVALID | values::HAS_MARK) {
                0 => Ok((0..group.count).map(|row| conversion.value(row as f64, true)).collect()),
                _ => Err("marks of invalid values without stored values".into()),
            };
        }
        let field = Field::new(group, channel)?;
        let mut cached = self.records.borrow_mut();
        if cached.as_ref().is_none_or(|(known, _)| *known != number) {
            *cached = Some((number, records::records(&self.bytes, group)?));
        }
        let records = cached.as_ref().map_or(&[][..], |(_, records)| records);
        let value = |record: &[u8]| {
            field.number(record).map_or(f64::NAN, |stored| conversion.value(stored, field.is_integer()))
        };
        Ok(records.chunks_exact(group.record_bytes().max(1)).map(value).collect())
    }
}

fn is_time(channel: &Channel) -> bool {
    [MASTER, VIRTUAL_MASTER].contains(&channel.kind) && channel.synchronises == TIME
}

/// Unit of a channel, else of its conversion; times are in seconds.
fn unit(bytes: &[u8], channel: &Channel) -> String {
    if !channel.unit.is_empty() {
        return channel.unit.clone();
    }
    let unit = conversion::unit(bytes, channel.conversion);
    if unit.is_empty() && is_time(channel) { "s".into() } else { unit }
}

impl LogFile for Mdf {
    fn format(&self) -> &'static str {
        "MDF"
    }

    fn names(&self) -> &[String] {
        &self.names
    }

    fn group(&self, index: usize) -> &str {
        self.channel(index).map_or("", |(_, group, _)| &group.name)
    }

    fn time_of(&self, index: usize) -> Option<usize> {
        let (number, ..) = self.places.get(index)?;
        self.times.get(*number).copied().flatten()
    }

    fn unit(&self, index: usize) -> &str {
        self.units.get(index).map_or("", String::as_str)
    }

    fn values(&self, file: &str, index: usize, wanted: &str, _: bool) -> Result<Vec<f64>, LogError> {
        let name = self.names.get(index).map_or("", String::as_str);
        self.numbers(index)
            .map_err(|found| refused(file, (name, wanted), found, "numbers in complete records"))
    }
}
