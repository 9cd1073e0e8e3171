//! Tables of an evaluation.

use crate::diagnose::tables::{self, Table};
use diagnosis::{ChannelComparison, Evaluation, LogComparison, four_digits};
use report::text_table;
use std::fmt::Write as _;

/// Errors by channel.
pub(super) fn channels(evaluation: &Evaluation) -> Table {
    let row = |c: &ChannelComparison| {
        vec![
            c.channel.name().into(),
            c.unit.into(),
            four_digits(c.rms),
            four_digits(c.noise_rms),
            c.noise_source.into(),
            four_digits(c.mean),
            four_digits(c.max),
            c.samples.to_string(),
        ]
    };
    Table {
        header: &["channel", "unit", "error, rms", "noise, rms", "noise from", "mean", "largest", "samples"],
        rows: evaluation.channels.iter().map(row).collect(),
    }
}

/// Errors by log; without rows for a single log.
pub(super) fn logs(evaluation: &Evaluation) -> Table {
    let row = |l: &LogComparison| {
        vec![
            short(&l.log).into(),
            l.channel.name().into(),
            four_digits(l.rms),
            four_digits(l.mean),
            l.samples.to_string(),
        ]
    };
    let is_single = evaluation.logs.len() <= evaluation.channels.len();
    Table {
        header: &["log", "channel", "error, rms", "mean", "samples"],
        rows: if is_single { Vec::new() } else { evaluation.logs.iter().map(row).collect() },
    }
}

/// Name of a log without its folder.
pub(crate) fn short(source: &str) -> &str {
    source.rsplit(['/', '\\']).next().unwrap_or(source)
}

/// Formats the errors and the findings about the logs.
pub(crate) fn text(evaluation: &Evaluation) -> String {
    let channels = channels(evaluation);
    let mut out = format!(
        "measured minus simulated with the bench as described; nothing was fitted\n\n{}\n",
        text_table(channels.header, &channels.rows, 2)
    );
    let logs = logs(evaluation);
    if !logs.rows.is_empty() {
        let _ = write!(out, "\n{}\n", text_table(logs.header, &logs.rows, 2));
    }
    tables::push_findings(&mut out, &evaluation.checks);
    out
}
