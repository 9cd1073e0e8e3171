//! Tables of a diagnosis, for the terminal and the page.

use super::sentences::{interval, percent, placed, with_unit};
use diagnosis::{Cause, Diagnosis, Finding, Gain, Severity, four_digits};
use report::text_table;
use std::fmt::Write as _;

/// A nuisance parameter is listed if its deviation falls below this share of the declared one.
const MIN_LISTED: f64 = 0.995;

/// A table with its header; without rows if there is nothing to list.
pub(crate) struct Table {
    pub(crate) header: &'static [&'static str],
    pub(crate) rows: Vec<Vec<String>>,
}

/// Every parameter of every cause.
pub(crate) fn causes(diagnosis: &Diagnosis) -> Table {
    let rows = diagnosis.causes.iter().flat_map(|cause| {
        cause.parameters.iter().map(|p| {
            vec![
                placed(&cause.effect, cause.channel, &cause.of),
                format!("{:.1} %", 100.0 * cause.probability),
                p.name.clone(),
                with_unit(four_digits(p.value), &p.unit),
                format!("{} to {}", four_digits(p.ci95[0]), four_digits(p.ci95[1])),
                error_without(cause),
            ]
        })
    });
    let header = &["cause", "probability", "parameter", "value", "95 % interval", "error without"];
    Table { header, rows: rows.collect() }
}

/// Held-out error without a cause, of the channel where it rises by the largest factor.
fn error_without(cause: &Cause) -> String {
    let factor = |gain: &&Gain| gain.baseline_rms / gain.extended_rms.max(f64::MIN_POSITIVE);
    cause
        .gain
        .iter()
        .max_by(|a, b| factor(a).total_cmp(&factor(b)))
        .map_or_else(|| "-".into(), |gain| with_unit(four_digits(gain.baseline_rms), gain.channel.unit()))
}

/// Error before and after by channel.
pub(crate) fn gains(diagnosis: &Diagnosis) -> Table {
    let row = |gain: &Gain| {
        vec![
            gain.channel.name().into(),
            four_digits(gain.baseline_rms),
            four_digits(gain.extended_rms),
            four_digits(gain.noise_rms),
            percent(gain.explained_share),
            interval(gain.explained_share_ci95),
        ]
    };
    Table {
        header: &["held-out error of", "before", "after", "noise", "explained", "95 % interval"],
        rows: diagnosis.gain.iter().map(row).collect(),
    }
}

/// Findings about the logs and what was done about them, the most severe first; notes as well.
pub(crate) fn findings(checks: &[Finding]) -> Table {
    let row = |f: &Finding| {
        let short = f.log.rsplit(['/', '\\']).next().unwrap_or(&f.log);
        let applied = f.applied.clone().unwrap_or_else(|| "-".into());
        let correction = f.correction.clone().unwrap_or_else(|| "-".into());
        let words = if f.cause.is_empty() { f.found.clone() } else { format!("{}: {}", f.found, f.cause) };
        vec![
            f.severity.name().into(),
            short.into(),
            f.channel.clone(),
            f.kind.into(),
            words,
            applied,
            correction,
        ]
    };
    Table {
        header: &[
            "finding",
            "log",
            "channel",
            "kind",
            "observation",
            "correction",
            "configuration line that corrects it",
        ],
        rows: checks.iter().map(row).collect(),
    }
}

/// Appends the findings that are graver than a note, and the lines of a description that correct
/// them.
pub(crate) fn push_findings(out: &mut String, checks: &[Finding]) {
    let mut table = findings(checks);
    table.rows.retain(|row| row.first().is_some_and(|word| word != Severity::Note.name()));
    // The last column has lines of a description: a line that is wrapped cannot be copied.
    table.header = table.header.split_last().map_or(&[], |(_, header)| header);
    let lines: Vec<String> = table.rows.iter_mut().filter_map(Vec::pop).filter(|line| line != "-").collect();
    push(out, &table);
    if !lines.is_empty() {
        let _ = write!(out, "\nlines of the description that correct it:\n{}\n", lines.join("\n"));
    }
}

/// Appends a table; nothing without rows.
pub(crate) fn push(out: &mut String, table: &Table) {
    if !table.rows.is_empty() {
        let _ = write!(out, "\n{}\n", text_table(table.header, &table.rows, table.header.len()));
    }
}

/// Parameters calibrated within their declared uncertainty.
pub(crate) fn calibrated(diagnosis: &Diagnosis) -> Table {
    let row = |c: &diagnosis::CalibratedParameter| {
        vec![
            c.name.clone(),
            four_digits(c.described),
            four_digits(c.declared_deviation),
            four_digits(c.value),
            four_digits(c.deviation),
        ]
    };
    Table {
        header: &["parameter", "described", "declared deviation", "calibrated", "remaining deviation"],
        rows: diagnosis.calibrated.iter().map(row).collect(),
    }
}

/// Table of the per-log nuisance parameters.
pub(crate) fn nuisances(diagnosis: &Diagnosis) -> Table {
    // Parameters that a log does not determine are listed elsewhere.
    let is_listed = |n: &&diagnosis::LogNuisance| n.deviation < MIN_LISTED * n.declared_deviation;
    let row = |n: &diagnosis::LogNuisance| {
        let short = n.source.rsplit(['/', '\\']).next().unwrap_or(&n.source);
        let estimated_by = if n.held_out { "its start" } else { "the fit" };
        vec![
            short.into(),
            n.name.into(),
            n.channel.map_or("-", bench::Channel::name).into(),
            with_unit(four_digits(n.value), &n.unit),
            four_digits(n.deviation),
            four_digits(n.declared_deviation),
            format!("{:+.1}", n.deviations_off),
            estimated_by.into(),
        ]
    };
    Table {
        header: &[
            "log",
            "nuisance",
            "channel",
            "value",
            "remaining deviation",
            "declared",
            "distance, deviations",
            "estimated by",
        ],
        rows: diagnosis.nuisances.iter().filter(is_listed).map(row).collect(),
    }
}

/// Noise that errors are compared with.
pub(crate) fn noise(diagnosis: &Diagnosis) -> Table {
    let row = |n: &diagnosis::Noise| {
        vec![
            n.channel.name().into(),
            four_digits(n.floor),
            n.source.into(),
            four_digits(n.measured_floor),
            n.repeats.to_string(),
            percent(n.repeatable_share),
            format!("{:.2}", n.excess),
            format!("{:.1}", n.correlation_samples),
        ]
    };
    Table {
        header: &[
            "channel",
            "floor",
            "known from",
            "measured in the log",
            "cycles compared",
            "repeatable share of the error",
            "residual/floor",
            "correlation, samples",
        ],
        rows: diagnosis.noise.iter().map(row).collect(),
    }
}

/// Causes that the proposed experiment would separate.
pub(crate) fn separation(diagnosis: &Diagnosis) -> Table {
    let rows = diagnosis
        .experiment
        .iter()
        .flat_map(|e| &e.separation)
        .map(|s| vec![placed(&s.effect, s.channel, &s.of), format!("{:.0}", s.chi_square)]);
    Table { header: &["separated from", "chi-square"], rows: rows.collect() }
}
