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
//! Specification", version 0; of messages: "ROS 1 serialization" and OMG CDR, version 1. A file is
//! a sequence of records, of which chunks contain others; definitions and channels come before the
//! messages that refer to them.

mod cursor;
mod definition;
mod json;
mod message;
mod records;
mod table;
mod topics;

use super::file::{LogFile, MAX_NAMES, MAX_ROWS, MAX_VALUES, refused};
use crate::log::LogError;
use records::MAX_CHUNK_BYTES;
use table::Flaw;
use topics::{MAX_DEFINITION_BYTES, MAX_UNPACKED_BYTES, Topics};

/// First bytes of a file, with the version.
const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// First bytes of a file of any version.
pub(super) const MCAP: &[u8] = b"\x89MCAP";
/// First bytes of a bag of ROS 1.
const ROS_BAG: &[u8] = b"#ROSBAG";
/// First bytes of a database, which rosbag2 wrote before MCAP.
const SQLITE: &[u8] = b"SQLite format 3\0";

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
        topics.file(bytes, MAGIC.len()).map_err(|(flaw, at)| match flaw {
            Flaw::Damage(found) => LogError::content(file, format!("{found} at byte {at}"), COMPLETE),
            Flaw::TooLarge => LogError::content(
                file,
                format!("more than can be held at byte {at}"),
                format!(
                    "at most {MAX_ROWS} messages of a topic, {MAX_VALUES} numbers, {MAX_NAMES} columns, \
                     {} MB in a chunk, {} MB in all and {} MB of definitions; `mcap filter` selects \
                     topics and times",
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
