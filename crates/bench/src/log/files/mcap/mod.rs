//! MCAP files (rosbag2, Foxglove and others) with messages of ROS 1 (`ros1`), ROS 2 (`cdr`) or in
//! JSON.
//!
//! Each topic is a group with its own times. Each number of its messages is a column by its path,
//! `/topic.field`; elements of arrays have their index, `/topic.field[0]`, or the name that the
//! message states for them, as `sensor_msgs/JointState` does: `/joints.position[rudder]`. The times
//! are those of the header, or those of recording if a message of the topic states none. Texts,
//! long arrays and topics in other encodings keep their name and are refused when a column asks for
//! them.
//!
//! This is own code because the official library does not decode messages, which are the larger
//! part, unpacks chunks in C, and panics on an attachment that is cut off. Layout: "MCAP Format
//! Specification", version 0; of messages: "ROS 1 serialization" and OMG CDR, version 1. A file is a
//! sequence of records, of which chunks contain others; definitions and channels come before the
//! messages that refer to them.

mod cursor;
mod definition;
mod json;
mod message;
mod records;
mod table;

use super::file::{LogFile, MAX_NAMES, MAX_ROWS, MAX_VALUES, distinct, refused};
use crate::log::LogError;
use definition::{Definition, Dialect};
use message::printable;
use records::{Channel, Chunk, MAX_CHUNK_BYTES, Message, Record, Schema};
use std::collections::HashMap;
use std::rc::Rc;
use table::{Budget, Flaw, Table};

/// First bytes of a file, with the version.
const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// First bytes of a file of any version.
pub(super) const MCAP: &[u8] = b"\x89MCAP";
/// First bytes of a bag of ROS 1.
const ROS_BAG: &[u8] = b"#ROSBAG";
/// First bytes of a database, which rosbag2 wrote before MCAP.
const SQLITE: &[u8] = b"SQLite format 3\0";

/// Maximum size of the definitions and topics of a file.
const MAX_DEFINITION_BYTES: usize = 1 << 24;
/// Maximum size of all unpacked chunks.
const MAX_UNPACKED_BYTES: usize = 1 << 36;
/// Name of the column of times of a topic.
const TIME: &str = "time";

const COMPLETE: &str = "a complete MCAP file; `mcap recover` keeps the messages before a damage";
const READABLE: &str =
    "numbers in messages of ROS 1 (`ros1` with `ros1msg`), ROS 2 (`cdr` with `ros2msg`) or JSON";

/// Refuses a recording of ROS in a format that is not read, with the command that converts it.
pub(super) fn refuse_other(file: &str, bytes: &[u8]) -> Result<(), LogError> {
    let (found, ending) = match () {
        () if bytes.starts_with(ROS_BAG) => ("a bag of ROS 1", "bag"),
        () if bytes.starts_with(SQLITE) => ("an SQLite database, such as a bag of ROS 2", "db3"),
        () => return Ok(()),
    };
    Err(LogError::content(
        file,
        found,
        format!("MCAP; `mcap convert FILE.{ending} FILE.mcap` converts a bag"),
    ))
}

/// Column of a file.
struct Column {
    topic: String,
    /// Values, or the reason why there are none.
    content: Result<Vec<f64>, String>,
    unit: &'static str,
    /// Column with the times.
    time: Option<usize>,
}

/// Topics of a file.
pub(super) struct Mcap {
    names: Vec<String>,
    columns: Vec<Column>,
}

impl Mcap {
    pub(super) fn open(file: &str, bytes: &[u8]) -> Result<Self, LogError> {
        if !bytes.starts_with(MAGIC) {
            return Err(LogError::content(file, "MCAP of an unknown version", "MCAP of version 0"));
        }
        let mut topics = Topics::default();
        topics.file(bytes).map_err(|(flaw, at)| match flaw {
            Flaw::Damage(found) => LogError::content(file, format!("{found} at byte {at}"), COMPLETE),
            Flaw::TooLarge => LogError::content(
                file,
                format!("more than can be held at byte {at}"),
                format!(
                    "at most {MAX_ROWS} messages of a topic, {MAX_VALUES} numbers, {MAX_NAMES} columns, {} MB in a \
                     chunk, {} MB in all and {} MB of definitions; `mcap filter` selects topics and times",
                    MAX_CHUNK_BYTES >> 20,
                    MAX_UNPACKED_BYTES >> 20,
                    MAX_DEFINITION_BYTES >> 20
                ),
            ),
        })?;
        let out = topics.columns();
        if out.columns.is_empty() {
            return Err(LogError::content(file, "no messages", "a topic for each group of signals"));
        }
        Ok(out)
    }
}

/// Decoder of the messages of a channel.
#[derive(Clone)]
enum Decoder {
    Ros(Rc<Definition>),
    Json,
}

/// Messages of one topic with one definition.
struct Topic {
    name: String,
    /// Decoder, or the reason why there is none.
    decoder: Result<Decoder, String>,
    table: Table,
}

/// Definition of a schema, or the reason why there is none.
type Parsed = Result<Rc<Definition>, String>;

/// Topics of a file that is being read.
#[derive(Default)]
struct Topics {
    /// Encoding, text and definition of each schema.
    schemas: HashMap<u16, (String, Vec<u8>, Parsed)>,
    /// Index of the topic of each channel.
    channels: HashMap<u16, usize>,
    /// Index of the topic of all channels with the same content.
    shared: HashMap<Channel, usize>,
    topics: Vec<Topic>,
    budget: Budget,
    definition_bytes: usize,
    unpacked_bytes: usize,
    /// Time of the first message in ns.
    first: Option<i64>,
}

impl Topics {
    /// Reads the records of a file up to the end of its data; a flaw has its place.
    fn file(&mut self, bytes: &[u8]) -> Result<(), (Flaw, usize)> {
        let mut at = MAGIC.len();
        loop {
            let (record, next) = records::record(bytes, at).map_err(|flaw| (flaw, at))?;
            match record {
                Record::DataEnd(checksum) => {
                    let data = bytes.get(..at).unwrap_or_default();
                    let is_intact = records::is_intact(data, checksum);
                    return if is_intact { Ok(()) } else { Err(("a wrong checksum of the data".into(), at)) };
                }
                Record::Chunk(chunk) => self.chunk(&chunk).map_err(|flaw| (in_chunk(flaw), at))?,
                record => self.record(record).map_err(|flaw| (flaw, at))?,
            }
            at = next;
        }
    }

    /// Reads the records of a chunk.
    fn chunk(&mut self, chunk: &Chunk<'_>) -> Result<(), Flaw> {
        self.unpacked_bytes += chunk.size()?;
        if self.unpacked_bytes > MAX_UNPACKED_BYTES {
            return Err(Flaw::TooLarge);
        }
        let (bytes, mut at) = (chunk.records()?, 0);
        while at < bytes.len() {
            let (record, next) = records::record(&bytes, at)?;
            self.record(record)?;
            at = next;
        }
        Ok(())
    }

    fn record(&mut self, record: Record<'_>) -> Result<(), Flaw> {
        match record {
            Record::Schema(id, schema) => self.schema(id, &schema),
            Record::Channel(id, channel) => self.channel(id, channel),
            Record::Message(message) => self.message(&message),
            Record::Chunk(_) => Err("a chunk in a chunk".into()),
            Record::DataEnd(_) | Record::Other => Ok(()),
        }
    }

    /// Adds a definition; chunks repeat those of their messages.
    fn schema(&mut self, id: u16, schema: &Schema<'_>) -> Result<(), Flaw> {
        if let Some((encoding, text, _)) = self.schemas.get(&id) {
            let is_same = *encoding == schema.encoding && text == schema.text;
            return if is_same { Ok(()) } else { Err(format!("another schema {id}").into()) };
        }
        self.define(schema.text.len() + schema.name.len() + schema.encoding.len())?;
        let text = String::from_utf8_lossy(schema.text);
        let parsed = match schema.encoding.as_str() {
            "ros1msg" => Definition::parse(&schema.name, &text, Dialect::Ros1),
            "ros2msg" => Definition::parse(&schema.name, &text, Dialect::Ros2),
            other => Err(format!("definitions in `{}`", printable(other))),
        };
        self.schemas.insert(id, (schema.encoding.clone(), schema.text.to_vec(), parsed.map(Rc::new)));
        Ok(())
    }

    /// Accounts for definitions and topics.
    fn define(&mut self, bytes: usize) -> Result<(), Flaw> {
        self.definition_bytes = self.definition_bytes.saturating_add(bytes);
        if self.definition_bytes > MAX_DEFINITION_BYTES { Err(Flaw::TooLarge) } else { Ok(()) }
    }

    /// Adds a channel. Channels with the same topic, encoding and definition share a table.
    fn channel(&mut self, id: u16, channel: Channel) -> Result<(), Flaw> {
        let shared = self.shared.get(&channel).copied();
        if let Some(known) = self.channels.get(&id) {
            return if shared == Some(*known) { Ok(()) } else { Err(format!("another channel {id}").into()) };
        }
        if let Some(topic) = shared {
            self.channels.insert(id, topic);
            return Ok(());
        }
        self.define(channel.topic.len() + channel.encoding.len())?;
        self.budget.name()?;
        let (name, decoder) = (printable(&channel.topic), self.decoder(&channel));
        self.channels.insert(id, self.topics.len());
        self.shared.insert(channel, self.topics.len());
        self.topics.push(Topic { name, decoder, table: Table::default() });
        Ok(())
    }

    /// Decoder of the messages of a channel.
    fn decoder(&self, channel: &Channel) -> Result<Decoder, String> {
        let of_dialect = |dialect: Dialect| {
            let (.., parsed) = self.schemas.get(&channel.schema).ok_or("messages without a definition")?;
            let definition = parsed.clone()?;
            let is_fitting = definition.dialect == dialect;
            is_fitting.then_some(Decoder::Ros(definition)).ok_or_else(|| "a definition of another ROS".into())
        };
        match channel.encoding.as_str() {
            "ros1" => of_dialect(Dialect::Ros1),
            "cdr" => of_dialect(Dialect::Ros2),
            "json" => Ok(Decoder::Json),
            other => Err(format!("messages in `{}`", printable(other))),
        }
    }

    /// Adds a message to the table of its topic. A damaged one ends the topic.
    fn message(&mut self, message: &Message<'_>) -> Result<(), Flaw> {
        let topic = self.channels.get(&message.channel).and_then(|topic| self.topics.get_mut(*topic));
        let Some(Topic { name, decoder, table }) = topic else {
            return Err(format!("a message of no channel {}", message.channel).into());
        };
        let Ok(own) = decoder else { return Ok(()) };
        let time = i64::try_from(message.log_time).map_err(|_| Flaw::from("a time after the year 2262"))?;
        let first = *self.first.get_or_insert(time);
        let number = table.rows() + 1;
        let mut row = table.row(name, (time, first), &mut self.budget)?;
        let added = match own {
            Decoder::Ros(definition) => message::read(definition, message.data, name, &mut row),
            Decoder::Json => json::read(message.data, name, &mut row),
        };
        match added {
            Err(Flaw::Damage(found)) => {
                *decoder = Err(format!("message {number} has {found}"));
                *table = Table::default();
                Ok(())
            }
            added => added,
        }
    }

    /// Columns of all topics, each with the one of its times first.
    fn columns(self) -> Mcap {
        let origin = self.topics.iter().flat_map(|topic| topic.table.times()).min().copied().unwrap_or(0);
        let (mut names, mut columns) = (Vec::new(), Vec::new());
        for Topic { name: topic, decoder, table } in self.topics {
            let index = names.len();
            let mut add = |name: String, content: Result<Vec<f64>, String>, unit, time| {
                names.push(name);
                columns.push(Column { topic: topic.clone(), content, unit, time });
            };
            let is_empty = table.rows() == 0;
            if let Some(reason) = decoder.err().or(is_empty.then(|| "no messages".into())) {
                add(topic.clone(), Err(reason), "", None);
                continue;
            }
            let rows = table.finish(origin, self.first.unwrap_or(origin));
            add(format!("{topic}.{TIME}"), Ok(rows.times), "s", Some(index));
            for (name, values, is_time) in rows.columns {
                add(name, Ok(values), if is_time { "s" } else { "" }, Some(index));
            }
            for (name, reason) in rows.others {
                add(name, Err(reason.into()), "", None);
            }
        }
        Mcap { names: distinct(names), columns }
    }
}

/// Adds to a flaw that it is in a chunk.
fn in_chunk(flaw: Flaw) -> Flaw {
    match flaw {
        Flaw::Damage(found) => format!("a chunk with {found}").into(),
        Flaw::TooLarge => flaw,
    }
}

impl LogFile for Mcap {
    fn format(&self) -> &'static str {
        "MCAP"
    }

    fn names(&self) -> &[String] {
        &self.names
    }

    fn group(&self, index: usize) -> &str {
        self.columns.get(index).map_or("", |column| &column.topic)
    }

    fn time_of(&self, index: usize) -> Option<usize> {
        self.columns.get(index)?.time
    }

    fn unit(&self, index: usize) -> &str {
        self.columns.get(index).map_or("", |column| column.unit)
    }

    fn expected_name(&self, name: &str) -> String {
        format!("a column `{name}` (a field of a topic is `/topic.{name}`)")
    }

    fn place(&self, row: usize) -> String {
        format!("message {}", row + 1)
    }

    fn values(&self, file: &str, index: usize, wanted: &str, _: bool) -> Result<Vec<f64>, LogError> {
        let name = self.names.get(index).map_or("", String::as_str);
        let refuse = |found: &str| refused(file, (name, wanted), found, READABLE);
        match self.columns.get(index).map(|column| &column.content) {
            Some(Ok(values)) => Ok(values.clone()),
            Some(Err(reason)) => Err(refuse(reason)),
            None => Err(refuse(&format!("only {} columns", self.columns.len()))),
        }
    }
}

#[cfg(test)]
mod made;
#[cfg(test)]
mod tests;
