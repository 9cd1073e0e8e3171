//! Topics of a file with their definitions, and their messages in tables.

use super::definition::{Definition, Dialect};
use super::message::{self, printable};
use super::records::{self, Channel, Chunk, Message, Record, Schema};
use super::table::{Budget, Flaw, Table};
use super::{Column, Mcap, json};
use crate::log::files::file::distinct;
use std::collections::HashMap;
use std::rc::Rc;

/// Maximum size of the definitions and topics of a file.
pub(super) const MAX_DEFINITION_BYTES: usize = 1 << 24;
/// Maximum size of all unpacked chunks.
pub(super) const MAX_UNPACKED_BYTES: u64 = 1 << 36;
/// Name of the column of times of a topic.
const TIME: &str = "time";

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
pub(super) struct Topics {
    /// Encoding, text and definition of each schema.
    schemas: HashMap<u16, (String, Vec<u8>, Parsed)>,
    /// Index of the topic of each channel.
    channels: HashMap<u16, usize>,
    /// Index of the topic of all channels with the same content.
    shared: HashMap<Channel, usize>,
    topics: Vec<Topic>,
    budget: Budget,
    definition_bytes: usize,
    unpacked_bytes: u64,
    /// Time of the first message in ns.
    first: Option<i64>,
}

impl Topics {
    /// Reads the records of a file from a place up to the end of its data; a flaw has its place.
    pub(super) fn file(&mut self, bytes: &[u8], start: usize) -> Result<(), (Flaw, usize)> {
        let mut at = start;
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
        self.unpacked_bytes += chunk.size()? as u64;
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
    pub(super) fn columns(self) -> Mcap {
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
