//! Instruction counts and sizes: the figures that are counted, compared and shown.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// All counts.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Counts {
    /// Instructions of the reference network over a complete window of 32 columns.
    pub(crate) reference_window: u64,
    /// Instructions of the same network as a causal stream, for each new column.
    pub(crate) reference_stream: u64,
    /// Instructions of the same network over a window that moved by one column ('same' padding,
    /// exact reuse).
    pub(crate) reference_reuse: u64,
    /// Minimum instructions of a controller tick.
    pub(crate) estimator_tick_min: u64,
    /// Maximum instructions of a controller tick.
    pub(crate) estimator_tick_max: u64,
    /// Maximum instructions of a controller tick over disturbed samples: every kind of fault, and
    /// restarts of the history.
    #[serde(rename = "troubled_tick_max")]
    pub(crate) disturbed_tick_max: u64,
    /// RAM of the two networks of a bearing with their history, in bytes.
    pub(crate) pair_ram_bytes: u64,
    /// Flash of the smallest image that estimates, model included, in bytes.
    #[serde(rename = "least_flash_bytes")]
    pub(crate) smallest_flash_bytes: u64,
    /// All figures by name.
    pub(crate) figures: BTreeMap<String, Figure>,
}

/// Cost of one operation over 1000 random inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Figure {
    /// Minimum instructions.
    pub(crate) min: u64,
    /// Maximum instructions.
    pub(crate) max: u64,
    /// Multiply-accumulates.
    pub(crate) macs: u64,
}

impl Figure {
    /// Parses a line of the image's output: name, min, max, multiply-accumulates.
    pub(crate) fn parse(line: &str) -> Option<(String, Self)> {
        let mut words = line.split_whitespace();
        let name = words.next()?.to_owned();
        let [min, max, macs] =
            [words.next()?.parse().ok()?, words.next()?.parse().ok()?, words.next()?.parse().ok()?];
        Some((name, Self { min, max, macs }))
    }
}
