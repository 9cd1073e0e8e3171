//! A log in SI units, and its text as CSV.

use super::LogError;
use crate::signals::Channel;
use std::collections::BTreeMap;

/// Log in SI units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeasuredLog {
    /// Origin of the log, for messages.
    pub source: String,
    /// Time of each sample in s; strictly ascending unless the log was read as found.
    pub time_s: Vec<f64>,
    /// Signals by channel, each as long as the time; finite unless the log was read as found.
    pub channels: BTreeMap<Channel, Vec<f64>>,
}

impl MeasuredLog {
    /// Returns the log as CSV text: channels in their order, shortest numbers that read back
    /// exactly.
    pub fn to_csv(&self) -> String {
        let mut text = String::from("t_s");
        for channel in self.channels.keys() {
            text.push(',');
            text.push_str(channel.name());
        }
        text.push('\n');
        for (i, t) in self.time_s.iter().enumerate() {
            text.push_str(&t.to_string());
            for values in self.channels.values() {
                text.push(',');
                if let Some(value) = values.get(i) {
                    text.push_str(&format!("{value:e}"));
                }
            }
            text.push('\n');
        }
        text
    }

    /// Returns a channel, or an error that names it.
    pub fn need(&self, channel: Channel) -> Result<&[f64], LogError> {
        self.channels.get(&channel).map(Vec::as_slice).ok_or_else(|| self.missing(channel))
    }

    /// Returns the error of a log that lacks a channel.
    pub fn missing(&self, channel: Channel) -> LogError {
        LogError::content(
            &self.source,
            format!("no column `{channel}`"),
            format!("the input `{channel}` of this plant"),
        )
    }

    /// Returns the error of a plant that has no log.
    pub(crate) fn plant_without_log(&self, plant: &str) -> LogError {
        LogError::content(&self.source, format!("plant `{plant}`, which has no log"), "a plant with a log")
    }
}
