//! Counts of a campaign's outcomes by kind and class, with the latencies of the first report.

use super::classify::{Class, Outcome};
use super::plan::Kind;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Counts of one kind of fault.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Faults.
    pub faults: u32,
    /// Faults reported in time, and not wrong without a mark afterwards.
    pub detected: u32,
    /// Faults reported in time, and wrong without a mark afterwards.
    pub wrong_again: u32,
    /// Faults reported after wrong estimates.
    pub detected_late: u32,
    /// Faults without a wrong estimate and without a report.
    pub harmless: u32,
    /// Faults with wrong estimates and without a report.
    pub silent: u32,
    /// Faults that were never injected.
    pub not_struck: u32,
    /// Faults that changed any message.
    pub alive: u32,
    /// Median number of samples from the fault to the first report.
    pub latency_median: Option<u32>,
    /// Largest number of samples from the fault to the first report.
    pub latency_longest: Option<u32>,
    /// Largest number of samples from the first wrong estimate to the first report.
    pub late_longest: Option<u32>,
    /// Largest error of an unmarked estimate among the harmless faults, as a share of full scale.
    pub harmless_error_share: f64,
}

/// Golden counts of a campaign by kind: faults, detected, wrong again, detected late, harmless,
/// silent.
///
/// For bit flips in memory only the faults and the silent ones are compared: their effects depend
/// on the addresses that the linker chooses, and the build name changes these.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts(pub BTreeMap<String, Vec<u32>>);

impl Counts {
    /// Returns the counts of a table.
    #[must_use]
    pub fn from_table(table: &Table) -> Self {
        let counts = |kind: Kind, row: &Row| match kind {
            Kind::Weights | Kind::Code | Kind::State | Kind::Stack => vec![row.faults, row.silent],
            _ => vec![row.faults, row.detected, row.wrong_again, row.detected_late, row.harmless, row.silent],
        };
        let kinds = Kind::ALL.into_iter().filter_map(|kind| {
            let name = kind.name();
            let row = table.kinds.get(&name)?;
            Some((name, counts(kind, row)))
        });
        Self(kinds.collect())
    }
}

/// Counts of a campaign.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Counts by kind.
    pub kinds: BTreeMap<String, Row>,
    /// Counts of all kinds together.
    pub all: Row,
    /// Number of faults by their first report.
    pub first_reports: BTreeMap<String, u32>,
}

fn row<'a>(outcomes: impl Iterator<Item = &'a Outcome>) -> Row {
    let mut row = Row::default();
    let mut latencies = vec![];
    for outcome in outcomes {
        row.faults += 1;
        match outcome.class {
            Class::Detected => row.detected += 1,
            Class::WrongAgain => row.wrong_again += 1,
            Class::DetectedLate => row.detected_late += 1,
            Class::Harmless => {
                row.harmless += 1;
                row.harmless_error_share = row.harmless_error_share.max(outcome.error_share);
            }
            Class::Silent => row.silent += 1,
            Class::NotStruck => row.not_struck += 1,
        }
        row.alive += u32::from(outcome.alive);
        latencies.extend(outcome.latency);
        row.late_longest = row.late_longest.max(outcome.late);
    }
    latencies.sort_unstable();
    row.latency_median = latencies.get(latencies.len() / 2).copied();
    row.latency_longest = latencies.last().copied();
    row
}

impl Table {
    /// Counts outcomes.
    #[must_use]
    pub fn from_outcomes(outcomes: &[Outcome]) -> Self {
        let kinds = Kind::ALL
            .into_iter()
            .map(|kind| (kind.name(), row(outcomes.iter().filter(|outcome| outcome.kind == kind))))
            .filter(|(_, row)| row.faults > 0)
            .collect();
        let mut first_reports = BTreeMap::new();
        for report in outcomes.iter().filter_map(|outcome| outcome.first_report.clone()) {
            *first_reports.entry(report).or_insert(0) += 1;
        }
        Self { kinds, all: row(outcomes.iter()), first_reports }
    }

    /// Returns the table as text.
    #[must_use]
    pub fn render(&self) -> String {
        let mut text = String::from(
            "                           of these                                         samples to \
             report\n\
             kind                faults  detected  wrong  late  harmless  silent     not  alive   median  \
             longest  late by\n\
             \x20                                    again                          struck\n",
        );
        let rows = self.kinds.iter().map(|(name, row)| (name.as_str(), row)).chain([("all", &self.all)]);
        let number = |value: Option<u32>| value.map_or_else(|| "-".into(), |value| value.to_string());
        for (name, row) in rows {
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "{name:19} {:6} {:9} {:6} {:5} {:9} {:7} {:7} {:6} {:>7} {:>8} {:>8}",
                row.faults,
                row.detected,
                row.wrong_again,
                row.detected_late,
                row.harmless,
                row.silent,
                row.not_struck,
                row.alive,
                number(row.latency_median),
                number(row.latency_longest),
                number(row.late_longest),
            );
        }
        let mut reports: Vec<_> = self.first_reports.iter().collect();
        reports.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
        let reports: Vec<_> = reports.into_iter().map(|(what, count)| format!("{what} {count}")).collect();
        let _ = writeln!(text, "\nfirst report: {}", reports.join(", "));
        text
    }
}
