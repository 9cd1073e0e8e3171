//! Impacts that the controller recorded: their table, and their comparison with those of the bench.
//!
//! A record belongs to the nearest true contact whose onset is at most [`MATCHED_S`] away. Peaks
//! are compared up to the time at which a record settles, energies and speed ratios are not: they
//! are in the tables.

use crate::impact_text::{end, seconds};
use crate::run::exchange::ExchangeResult;
use bench::integrate::Impact;
use bench::plants::transmission::Snapshot;
use controller::impacts::SETTLED_US;
use link::{ImpactEnd, ImpactRecord};
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write as _;

/// Name of the table in the folder of a run or a replay.
pub(crate) const FILE_NAME: &str = "estimated_impacts.csv";

/// Largest distance of the onsets of a contact and its record, s.
const MATCHED_S: f64 = 1e-3;

/// Header of the table.
const HEADER: &str = "number,onset_sequence,onset_s,peak_s,duration_s,peak_force_n,peak_force_sd_n,\
approach_speed_m_s,separation_speed_m_s,energy_lost_j,speed_ratio,flags,end";

/// Formats records as CSV with the shortest numbers that read back exactly. The speed ratio of a
/// contact that did not separate is empty.
pub fn to_csv(records: &[ImpactRecord]) -> String {
    let mut text = format!("{HEADER}\n");
    for r in records {
        // Writing to text does not fail.
        let _ = writeln!(
            text,
            "{},{},{:.6},{:.6},{:.6},{:e},{:e},{:e},{:e},{:e},{},{},{}",
            r.number,
            r.onset_sequence,
            seconds(r.onset_us),
            seconds(r.peak_us),
            seconds(r.duration_us),
            r.peak_force_n,
            r.peak_force_sd_n,
            r.approach_speed_m_s,
            r.separation_speed_m_s,
            r.energy_lost_j,
            r.speed_ratio().map(|value| format!("{value:e}")).unwrap_or_default(),
            r.flags,
            end(r.end)
        );
    }
    text
}

/// Number and size of the recorded impacts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct ImpactTotals {
    /// Records that the host received.
    pub records: u64,
    /// Records that the controller dropped or the line lost.
    pub lost: u64,
    /// Largest peak, N; 0 without a record.
    pub largest_peak_n: f64,
    /// Time of that peak, s; null without a record.
    pub largest_peak_s: Option<f64>,
}

impl ImpactTotals {
    /// Counts the records of an exchange.
    pub(crate) fn new(exchange: &ExchangeResult) -> Self {
        let largest = exchange.impacts.iter().max_by(|a, b| a.peak_force_n.total_cmp(&b.peak_force_n));
        let records = exchange.impacts.len() as u64;
        let missing = u64::from(exchange.counters.impacts).saturating_sub(records);
        Self {
            records,
            // A dropped record is missing, too, unless its state was corrupted before its end.
            lost: missing.max(exchange.counters.dropped_impacts.into()),
            largest_peak_n: largest.map_or(0.0, |record| record.peak_force_n.into()),
            largest_peak_s: largest.map(|record| seconds(record.peak_us)),
        }
    }
}

/// Recorded impacts with the errors of those that have a true contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct ImpactSummary {
    /// Number and size.
    #[serde(flatten)]
    pub totals: ImpactTotals,
    /// Records that belong to a true contact.
    pub matched: u64,
    /// Largest error of the peak as a share of the true one; null without a match. Interrupted
    /// records do not count.
    pub peak_error_max: Option<f64>,
    /// Largest error of the onset, s; null without a match.
    pub onset_error_max_s: Option<f64>,
}

/// A record with its true contact.
pub(crate) struct Pair<'a> {
    /// The record.
    pub(crate) record: &'a ImpactRecord,
    /// The true contact, with its largest force up to the time at which a record settles.
    pub(crate) truth: Option<(&'a Impact, f64)>,
}

/// Pairs every record with the nearest true contact.
pub(crate) fn pairs<'a>(
    records: &'a [ImpactRecord],
    truth: &'a [Impact],
    samples: &[Snapshot],
) -> Vec<Pair<'a>> {
    let pair = |record: &'a ImpactRecord| {
        let onset_s = seconds(record.onset_us);
        let distance = |impact: &Impact| (impact.onset_s - onset_s).abs();
        let nearest = truth.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let nearest = nearest.filter(|impact| distance(impact) <= MATCHED_S);
        Pair { record, truth: nearest.map(|impact| (impact, early_peak_n(impact, samples))) }
    };
    records.iter().map(pair).collect()
}

/// Returns the largest force of a contact before a record of it settles, N.
fn early_peak_n(impact: &Impact, samples: &[Snapshot]) -> f64 {
    let until_s = impact.onset_s + seconds(SETTLED_US);
    if impact.peak_s <= until_s {
        return impact.peak_force_n;
    }
    let first = samples.partition_point(|sample| sample.time_s < impact.onset_s);
    let early = samples.iter().skip(first).take_while(|sample| sample.time_s <= until_s);
    early.map(|sample| sample.forces.normal_n).fold(0.0, f64::max)
}

impl ImpactSummary {
    /// Compares the records of an exchange with the contacts of the bench.
    pub(crate) fn new(exchange: &ExchangeResult, truth: &[Impact], samples: &[Snapshot]) -> Self {
        let pairs = pairs(&exchange.impacts, truth, samples);
        let matched = || pairs.iter().filter_map(|pair| Some((pair.record, pair.truth?)));
        let largest = |errors: &mut dyn Iterator<Item = f64>| errors.map(f64::abs).reduce(f64::max);
        let is_complete = |record: &ImpactRecord| record.end != ImpactEnd::Interrupted;
        Self {
            totals: ImpactTotals::new(exchange),
            matched: matched().count() as u64,
            peak_error_max: largest(
                &mut matched()
                    .filter(|(record, _)| is_complete(record))
                    .map(|(record, (_, peak_n))| f64::from(record.peak_force_n) / peak_n - 1.0),
            ),
            onset_error_max_s: largest(
                &mut matched().map(|(record, (impact, _))| seconds(record.onset_us) - impact.onset_s),
            ),
        }
    }
}

/// Header of the table for terminal and page.
pub(super) const TABLE_HEADER: [&str; 10] = [
    "onset, s",
    "true",
    "peak, N",
    "+-",
    "true",
    "duration, ms",
    "true",
    "loss, J",
    "true",
    "speed ratio, true; end",
];

/// Rows of the table: estimate beside truth.
pub(super) fn table_rows(pairs: &[Pair<'_>]) -> Vec<Vec<String>> {
    let row = |pair: &Pair<'_>| {
        let r = pair.record;
        let truth = pair.truth.map(|(impact, _)| impact);
        let of_truth =
            |value: &dyn Fn(&Impact) -> Option<String>| truth.and_then(value).unwrap_or("-".into());
        let ratio = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.2}"));
        vec![
            format!("{:.6}", seconds(r.onset_us)),
            of_truth(&|i| Some(format!("{:.6}", i.onset_s))),
            format!("{:.0}", r.peak_force_n),
            format!("{:.0}", r.peak_force_sd_n),
            pair.truth.map_or("-".into(), |(_, peak_n)| format!("{peak_n:.0}")),
            format!("{:.3}", f64::from(r.duration_us) * 1e-3),
            of_truth(&|i| Some(format!("{:.3}", 1e3 * i.duration_s()?))),
            format!("{:.3}", r.energy_lost_j),
            of_truth(&|i| Some(format!("{:.3}", i.energy_lost_j))),
            format!(
                "{}, {}; {}",
                ratio(r.speed_ratio().map(f64::from)),
                ratio(truth.and_then(Impact::speed_ratio)),
                end(r.end)
            ),
        ]
    };
    pairs.iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(onset_us: u32, peak_force_n: f32, end: ImpactEnd) -> ImpactRecord {
        ImpactRecord { onset_us, peak_us: onset_us + 1_000, peak_force_n, end, ..ImpactRecord::default() }
    }

    fn truth(onset_s: f64, peak_force_n: f64) -> Impact {
        Impact { onset_s, peak_s: onset_s + 1e-3, peak_force_n, ..Impact::default() }
    }

    #[test]
    fn rows_have_the_fields_of_the_header_and_an_unknown_speed_ratio_is_empty() {
        let closed = ImpactRecord {
            approach_speed_m_s: 0.5,
            separation_speed_m_s: 0.25,
            ..record(1_500_000, 7.0, ImpactEnd::Separation)
        };
        let text = to_csv(&[closed, record(2_000_000, 8.0, ImpactEnd::Settled)]);
        let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        assert!(rows.len() == 3 && rows.iter().all(|row| row.len() == rows[0].len()));
        let field = |row: usize, name: &str| rows[row][rows[0].iter().position(|h| *h == name).unwrap()];
        assert_eq!((field(1, "onset_s"), field(1, "speed_ratio")), ("1.500000", "5e-1"));
        assert_eq!((field(2, "speed_ratio"), field(2, "end")), ("", "settled"));
    }

    #[test]
    fn a_record_belongs_to_the_nearest_contact_within_a_millisecond() {
        let records =
            [record(100_000, 990.0, ImpactEnd::Separation), record(300_000, 50.0, ImpactEnd::Separation)];
        let truths = [truth(0.1002, 1_000.0), truth(0.1009, 5.0), truth(0.305, 50.0)];
        let pairs = pairs(&records, &truths, &[]);
        assert_eq!(pairs[0].truth.map(|(impact, peak)| (impact.onset_s, peak)), Some((0.1002, 1_000.0)));
        assert!(pairs[1].truth.is_none());
    }

    #[test]
    fn the_errors_are_those_of_matched_records_and_an_interrupted_peak_does_not_count() {
        let records =
            [record(100_000, 990.0, ImpactEnd::Separation), record(200_000, 10.0, ImpactEnd::Interrupted)];
        let mut exchange = ExchangeResult { impacts: records.to_vec(), ..ExchangeResult::default() };
        (exchange.counters.impacts, exchange.counters.dropped_impacts) = (5, 2);
        let found = ImpactSummary::new(&exchange, &[truth(0.1, 1_000.0), truth(0.2003, 100.0)], &[]);
        assert_eq!((found.totals.records, found.totals.lost, found.matched), (2, 3, 2));
        let largest = (found.totals.largest_peak_n, found.totals.largest_peak_s);
        assert_eq!(largest, (990.0, Some(seconds(101_000))));
        assert!((found.peak_error_max.unwrap() - 0.01).abs() < 1e-9, "{found:?}");
        assert!((found.onset_error_max_s.unwrap() - 3e-4).abs() < 1e-9, "{found:?}");
    }
}
