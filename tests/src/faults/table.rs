//! The outcomes counted: by kind and class, with the latencies until the host was told.

use super::judge::{Class, Outcome};
use super::plan::Kind;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write;

/// A kind's row.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Faults.
    pub faults: u32,
    /// Told in time.
    pub detected: u32,
    /// Told late.
    pub detected_late: u32,
    /// Nothing wrong.
    pub harmless: u32,
    /// Wrong and not told.
    pub silent: u32,
    /// Never carried out.
    pub not_struck: u32,
    /// Faults that changed anything that can be seen.
    pub alive: u32,
    /// Told, and unmarked estimates were wrong after that: it is up to the host to remember.
    pub wrong_after: u32,
    /// Samples until it was told: half of the faults, and the longest.
    pub latency_median: Option<u32>,
    /// As above.
    pub latency_longest: Option<u32>,
    /// Samples from the first wrong estimate until it was told, the longest.
    pub late_longest: Option<u32>,
    /// Largest error of an unmarked estimate of what is harmless, as a share of full scale.
    pub harmless_error_share: f64,
}

/// What is checked in of a campaign: by kind, the faults and how many of them were detected, detected late, harmless and silent. Of flips in memory,
/// whose effects depend on where the linker puts things (the build's name is among them), only the faults and the silent ones.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts(pub BTreeMap<String, Vec<u32>>);

impl Counts {
    /// The counts of a table.
    #[must_use]
    pub fn of(table: &Table) -> Self {
        let counts = |kind: Kind, row: &Row| match kind {
            Kind::Weights | Kind::Code | Kind::State | Kind::Stack => vec![row.faults, row.silent],
            _ => vec![row.faults, row.detected, row.detected_late, row.harmless, row.silent],
        };
        let kinds = Kind::ALL.into_iter().filter_map(|kind| {
            let name = kind.name();
            let row = table.kinds.get(&name)?;
            Some((name, counts(kind, row)))
        });
        Self(kinds.collect())
    }
}

/// The outcomes of a campaign.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// By kind.
    pub kinds: BTreeMap<String, Row>,
    /// All kinds together.
    pub all: Row,
    /// How often each thing was what the host was told first.
    pub told: BTreeMap<String, u32>,
}

fn row<'a>(outcomes: impl Iterator<Item = &'a Outcome>) -> Row {
    let mut row = Row::default();
    let mut latencies = vec![];
    for outcome in outcomes {
        row.faults += 1;
        match outcome.class {
            Class::Detected => row.detected += 1,
            Class::DetectedLate => row.detected_late += 1,
            Class::Harmless => {
                row.harmless += 1;
                row.harmless_error_share = row.harmless_error_share.max(outcome.error_share);
            }
            Class::Silent => row.silent += 1,
            Class::NotStruck => row.not_struck += 1,
        }
        row.alive += u32::from(outcome.alive);
        row.wrong_after += u32::from(outcome.class == Class::Detected && outcome.wrong > 0);
        latencies.extend(outcome.latency);
        row.late_longest = row.late_longest.max(outcome.late);
    }
    latencies.sort_unstable();
    row.latency_median = latencies.get(latencies.len() / 2).copied();
    row.latency_longest = latencies.last().copied();
    row
}

impl Table {
    /// Counts.
    #[must_use]
    pub fn of(outcomes: &[Outcome]) -> Self {
        let kinds = Kind::ALL
            .into_iter()
            .map(|kind| (kind.name(), row(outcomes.iter().filter(|outcome| outcome.kind == kind))))
            .filter(|(_, row)| row.faults > 0)
            .collect();
        let mut told = BTreeMap::new();
        for what in outcomes.iter().filter_map(|outcome| outcome.told.clone()) {
            *told.entry(what).or_insert(0) += 1;
        }
        Self { kinds, all: row(outcomes.iter()), told }
    }

    /// For people.
    #[must_use]
    pub fn render(&self) -> String {
        let mut text = String::from(
            "kind               faults  detected  again   late  harmless  silent  not struck  alive   median  longest  late by\n",
        );
        let rows = self.kinds.iter().map(|(name, row)| (name.as_str(), row)).chain([("all", &self.all)]);
        let number = |value: Option<u32>| value.map_or_else(|| "-".into(), |value| value.to_string());
        for (name, row) in rows {
            // Into a string: cannot fail.
            let _ = writeln!(
                text,
                "{name:18} {:6} {:9} {:6} {:6} {:9} {:7} {:11} {:6} {:>8} {:>8} {:>8}",
                row.faults,
                row.detected,
                row.wrong_after,
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
        let mut told: Vec<_> = self.told.iter().collect();
        told.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
        let told: Vec<_> = told.into_iter().map(|(what, count)| format!("{what} {count}")).collect();
        let _ = writeln!(text, "\ntold first by: {}", told.join(", "));
        text
    }
}
