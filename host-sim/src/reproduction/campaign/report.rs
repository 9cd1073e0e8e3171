//! Report of `host-sim claims`: the claims three times, maps, page and files.

use super::parameter_box::{BOX, Draw, Parameter, Values};
use super::table::{HEADER, MappedClaim, Nominal, cells, mapped, markdown};
use super::work::{self, Record};
use super::{pictures, verdicts};
use crate::cli::error::CliError;
use crate::cli::limits;
use crate::cli::output::{self, Files};
use crate::cli::progress;
use crate::reproduction::claims::{Claim, Verdict, cycles, evaluate_motion};
use crate::shard::{self, Shard};
use bench::description::TransmissionBench;
use model_quant::report::claims::{friction, torque, training};
use report::page::Page;
use report::text_table;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Options of a campaign.
#[derive(Clone, Debug)]
pub(crate) struct Options {
    /// Bench whose parameters are varied.
    pub(crate) base: TransmissionBench,
    /// Number of draws.
    pub(crate) runs: usize,
    /// Seed of the draws.
    pub(crate) seed: u64,
    /// Threads; 0 uses one per core.
    pub(crate) threads: usize,
}

/// A claim with its verdicts at the bench's own parameters and over the box.
#[derive(JsonSchema, Serialize)]
struct Row {
    #[serde(flatten)]
    claim: Claim,
    nominal: Nominal,
    /// Over the box: from rest and settled.
    #[serde(skip_serializing_if = "Option::is_none")]
    mapped: Option<MappedClaim>,
}

#[derive(JsonSchema, Serialize)]
pub(crate) struct Outcome {
    seed: u64,
    draws: usize,
    failed: usize,
    parameters: [Parameter; BOX.len()],
    claims: Vec<Row>,
}

/// Runs the campaign, or merges its shards, and writes claims.json, claims.md, draws.csv,
/// verdicts.csv, the pictures and report.html.
pub(crate) fn run(options: &Options, shards: &[PathBuf], folder: &Path, json: bool) -> Result<(), CliError> {
    output::check_folder(folder)?;
    let merged = if shards.is_empty() {
        None
    } else {
        Some(work::merge(&options.base, (options.seed, options.runs), shards, folder)?)
    };
    let bar = progress::bar(options.runs as u64);
    bar.set_message("at the bench's own parameters");
    let nominal = nominal(&options.base, options.threads)?;
    bar.set_message("draws of the parameter box");
    let records = match merged {
        Some(records) => records,
        None => options.draw(Shard::ALL, folder, || bar.inc(1))?,
    };
    bar.finish_and_clear();
    publish(options, nominal, &records, folder, json)
}

/// Judges the draws of one shard into the journal of a folder.
pub(crate) fn run_shard(options: &Options, shard: Shard, folder: &Path, json: bool) -> Result<(), CliError> {
    output::check_folder(folder)?;
    let bar = progress::bar((0..options.runs).filter(|index| shard.contains(*index)).count() as u64);
    let records = options.draw(shard, folder, || bar.inc(1))?;
    bar.finish_and_clear();
    let failed = records.iter().filter(|record| record.outcome.is_err()).count();
    shard::report(shard, [records.len(), options.runs, failed], &folder.join(work::NAME), json)
}

impl Options {
    fn draw(&self, shard: Shard, folder: &Path, progress: impl Fn() + Sync) -> Result<Vec<Record>, CliError> {
        work::run(&self.base, (self.seed, self.runs, shard), self.threads, Some(folder), progress)
    }
}

fn publish(
    options: &Options,
    nominal: Vec<(Claim, Nominal)>,
    records: &[Record],
    folder: &Path,
    json: bool,
) -> Result<(), CliError> {
    let claims = mapped(options.seed, records);
    let outcome = Outcome {
        seed: options.seed,
        draws: records.len(),
        failed: records.iter().filter(|record| record.outcome.is_err()).count(),
        parameters: BOX,
        claims: nominal
            .into_iter()
            .map(|(claim, nominal)| Row { mapped: find(&claims, claim.id), claim, nominal })
            .collect(),
    };
    let rows = rows(&outcome);
    let maps = pictures::maps(&claims)?;
    let charts = pictures::over_deciding((options.seed, records), &claims)?;
    let text = output::json(&outcome)?;
    let mut files = Files::new(folder);
    files.add("claims.json", &format!("{text}\n"))?;
    files.add_provenance()?;
    files.add("claims.md", &markdown(&rows))?;
    files.add("draws.csv", &draws_csv(options.seed, records)?)?;
    files.add("verdicts.csv", &verdicts_csv(records))?;
    files.add_pictures(&maps)?;
    files.add_pictures(&charts)?;
    let mut page = page(&outcome, &rows);
    page.section("Which parameter decides");
    for map in &maps {
        page.figure(&map.drawing, &map.caption);
    }
    output::show(&mut page, &charts);
    details(&mut page, &outcome);
    limits::section(&mut page, &options.base);
    files.add("report.html", &page.render())?;
    files.publish()?;
    if json {
        print_result!("{text}");
    } else {
        print_line!("{}", text_table(HEADER, &rows, 2));
        print_line!("\n{}", lead(&outcome));
        print_line!("report: {}", folder.join("report.html").display());
    }
    Ok(())
}

fn find(claims: &[MappedClaim], id: u8) -> Option<MappedClaim> {
    claims.iter().find(|claim| claim.id == id).cloned()
}

/// Judges the claims at the bench's own parameters, from rest, settled and for the networks.
fn nominal(base: &TransmissionBench, threads: usize) -> Result<Vec<(Claim, Nominal)>, CliError> {
    let failed = |e: &dyn std::fmt::Display| CliError::Work(e.to_string());
    let (_, facts) = cycles::gather(base, threads, || {})?;
    let [from_rest, settled] = facts.map(|facts| evaluate_motion(&facts));
    let rigs = torque::measure_rigs().map_err(|e| failed(&e))?;
    let networks = torque::measure_networks().map_err(|e| failed(&e))?;
    let networks = friction::assess_curves(&networks, "");
    let mut claims = from_rest;
    claims.extend(friction::assess(&rigs));
    claims.push(training::assess(&training::measure().map_err(|e| failed(&e))?));
    let of = |claims: &[Claim], id: u8| claims.iter().find(|c| c.id == id).map(|c| c.verdict);
    let row = |claim: Claim| {
        let nominal = Nominal {
            as_run: Some(claim.verdict),
            settled: of(&settled, claim.id),
            networks: of(&networks, claim.id),
        };
        (claim, nominal)
    };
    Ok(claims.into_iter().map(row).collect())
}

fn rows(outcome: &Outcome) -> Vec<Vec<String>> {
    let row = |row: &Row| {
        let none = MappedClaim { id: row.claim.id, operations: [None, None] };
        cells(row.mapped.as_ref().unwrap_or(&none), &row.nominal)
    };
    outcome.claims.iter().map(row).collect()
}

/// Every draw with its values and its verdicts.
fn draws_csv(seed: u64, records: &[Record]) -> Result<String, CliError> {
    let failed = |e: &dyn std::fmt::Display| CliError::Work(format!("csv: {e}"));
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut header = vec!["draw".to_owned()];
    header.extend(BOX.iter().map(|parameter| parameter.field.to_owned()));
    for operation in ["from_rest", "settled"] {
        header.extend((1..verdicts::CLAIMS).map(|claim| format!("{operation}_{claim}")));
    }
    header.push("error".into());
    writer.write_record(&header).map_err(|e| failed(&e))?;
    for record in records {
        let draw = Draw::new(seed, record.index);
        let mut cells = vec![record.index.to_string()];
        cells.extend(BOX.iter().zip(draw.values).map(|(parameter, value)| match parameter.values {
            Values::Between(..) => format!("{value:.9e}"),
            Values::OneOf(_) => parameter.values.name(value).to_owned(),
        }));
        let (letters, error) = match &record.outcome {
            Ok(letters) => ([letters.from_rest.as_str(), letters.settled.as_str()], ""),
            Err(error) => ([""; 2], error.as_str()),
        };
        for text in letters {
            let verdict = |v: &Option<Verdict>| v.map_or("", Verdict::name).to_owned();
            cells.extend(verdicts::row(text).iter().take(verdicts::CLAIMS - 1).map(verdict));
        }
        cells.push(error.into());
        writer.write_record(&cells).map_err(|e| failed(&e))?;
    }
    let bytes = writer.into_inner().map_err(|e| failed(&e))?;
    String::from_utf8(bytes).map_err(|e| failed(&e))
}

/// Verdicts of every draw as letters, one line a draw.
pub(crate) fn verdicts_csv(records: &[Record]) -> String {
    let mut text = String::from("draw,from_rest,settled\n");
    for record in records {
        let (from_rest, settled) = match &record.outcome {
            Ok(letters) => (letters.from_rest.as_str(), letters.settled.as_str()),
            Err(_) => ("failed", "failed"),
        };
        text.push_str(&format!("{},{from_rest},{settled}\n", record.index));
    }
    text
}

fn lead(outcome: &Outcome) -> String {
    let always = |operation: usize| {
        let shares = outcome.claims.iter().filter_map(|row| row.mapped.as_ref());
        let shares = shares.filter_map(|mapped| mapped.operations.get(operation)?.as_ref());
        shares.filter(|mapped| mapped.holds.hits == mapped.holds.count).count()
    };
    format!(
        "{} draws of seed {}, {} failed. In every draw hold {} of 14 claims from rest and {} of 11 settled.",
        outcome.draws,
        outcome.seed,
        outcome.failed,
        always(0),
        always(1)
    )
}

fn page(outcome: &Outcome, rows: &[Vec<String>]) -> Page {
    let mut page = Page::new("The paper's claims, judged three times");
    page.lead(&lead(outcome));
    page.text(
        "As run: one cycle from rest, as in the paper. Settled: the last two of five cycles. Share of the \
         box: draws of parameters that the paper does not state. `assumed` means that the project's own \
         friction law stands in for the paper's unpublished measurements, so the claim cannot fail by \
         itself.",
    );
    page.table(&HEADER, rows);
    page.note(
        "Shares have Wilson's 95 % interval in brackets. The deciding parameter has the largest difference \
         of shares between the halves of its range, in points; a minus means that the claim holds more often \
         with small values. Claims 12 to 14 have the rig as run, the shipped networks in the column \
         networks, and in the box the bench's own friction law at the rig's speeds. Claim 15 is about a \
         training. Failed draws are left out.",
    );
    page.section("The box");
    let values = |parameter: &Parameter| match parameter.values {
        Values::Between(from, to) => format!("{from} to {to}, by its logarithm"),
        Values::OneOf(names) => names.join(", "),
    };
    let table: Vec<Vec<String>> = BOX
        .iter()
        .map(|p| vec![p.name.to_owned(), p.description.to_owned(), values(p), p.field.to_owned()])
        .collect();
    page.table(&["", "parameter", "values", "field"], &table);
    page
}

fn details(page: &mut Page, outcome: &Outcome) {
    page.section("The claims and their thresholds");
    let row = |row: &Row| {
        vec![
            row.claim.id.to_string(),
            row.claim.claim.to_owned(),
            row.claim.why.clone(),
            row.claim.threshold.to_owned(),
        ]
    };
    let header = ["", "claim", "numbers at the bench's own parameters, from rest", "holds if"];
    page.table(&header, &outcome.claims.iter().map(row).collect::<Vec<_>>());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduction::campaign::verdicts::{Letters, evaluate_law};

    /// Seed and draws of the published campaign.
    const PUBLISHED: (u64, usize) = (1, 2000);

    #[test]
    fn the_document_has_the_table_of_the_published_campaign() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let read = |name: &str| std::fs::read_to_string(root.join(name)).unwrap();
        let (golden, document) = (read("tests/golden/claims.csv"), read("docs/claims.md"));
        let records: Vec<Record> = golden
            .lines()
            .skip(1)
            .map(|line| {
                let cells: Vec<&str> = line.split(',').collect();
                let [index, from_rest, settled] = cells[..] else { unreachable!("{line}") };
                let letters = Letters { from_rest: from_rest.into(), settled: settled.into() };
                let outcome = if from_rest == "failed" { Err(String::new()) } else { Ok(letters) };
                Record { index: index.parse().unwrap(), outcome }
            })
            .collect();
        assert_eq!(records.len(), PUBLISHED.1);
        assert_eq!(verdicts_csv(&records), golden);
        let base = TransmissionBench::open("bench-b").unwrap();
        for record in &records {
            let Ok(letters) = &record.outcome else { continue };
            let law = evaluate_law(&base, Some(&Draw::new(PUBLISHED.0, record.index))).unwrap();
            assert_eq!(letters.from_rest[11..14], verdicts::letters(&law)[11..14], "draw {}", record.index);
        }
        let claims = mapped(PUBLISHED.0, &records);
        let row = |(claim, nominal): (Claim, Nominal)| {
            let none = MappedClaim { id: claim.id, operations: [None, None] };
            cells(&find(&claims, claim.id).unwrap_or(none), &nominal)
        };
        let rows: Vec<Vec<String>> = nominal(&base, 0).unwrap().into_iter().map(row).collect();
        let table = markdown(&rows);
        assert!(document.contains(&table), "docs/claims.md lacks this table:\n{table}");
        check_sentences(&records);
    }

    /// Checks the numbers in the sentences below the table.
    fn check_sentences(records: &[Record]) {
        let draws: Vec<(Draw, [verdicts::Row; 2])> = records
            .iter()
            .filter_map(|record| {
                let letters = record.outcome.as_ref().ok()?;
                let rows = [&letters.from_rest, &letters.settled].map(|text| verdicts::row(text));
                Some((Draw::new(PUBLISHED.0, record.index), rows))
            })
            .collect();
        let holds = |row: &verdicts::Row, claim: usize| row[claim - 1].is_some_and(Verdict::is_affirmed);
        let together = draws.iter().filter(|(_, [row, _])| [2, 3, 5, 7].iter().all(|c| holds(row, *c)));
        assert_eq!(together.count(), 76);
        for operation in [0, 1] {
            let count = |rows: &[verdicts::Row; 2]| (1..=11).filter(|c| holds(&rows[operation], *c)).count();
            let mut counts: Vec<usize> = draws.iter().map(|(_, rows)| count(rows)).collect();
            counts.sort_unstable();
            assert_eq!(counts[counts.len() / 2], 4);
        }
        let share = |operation: usize, periods_s: std::ops::Range<f64>| {
            let counted = draws.iter().filter(|(draw, _)| periods_s.contains(&draw.values[5]));
            let counted: Vec<bool> = counted.map(|(_, rows)| holds(&rows[operation], 2)).collect();
            counted.iter().filter(|holds| **holds).count() as f64 / counted.len() as f64
        };
        assert!((share(0, 0.0..0.75) - 0.35).abs() < 0.005);
        assert!((share(0, 1.0..2.0) - 0.065).abs() < 5e-4 && share(1, 1.0..2.0) < 0.01);
    }
}
