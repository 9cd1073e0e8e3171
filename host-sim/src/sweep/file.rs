//! `host-sim sweep FILE`: the parameters of a file, on all cores, resumed after a kill.

use super::journal::{self, Header, Record};
use super::options::SweepOptions;
use super::owner;
use super::points::{Point, points};
use super::specification::{Scale, Specification};
use super::table::{self, Row};
use super::work;
use crate::cli::error::CliError;
use crate::cli::limits;
use crate::cli::output::{self, Files, Picture};
use crate::cli::progress;
use crate::run::force;
use crate::run::summary::{Figures, PerPeak};
use crate::shard::{self, Shard};
use bench::{BearingMaterial, Bench, PRESETS};
use report::figure::{Chart, Series, Style, lines, lines_log_x};
use report::page::Page;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Maximum number of runs that a report lists one by one.
const LISTED: usize = 200;

#[derive(Serialize, JsonSchema)]
pub(crate) struct Outcome<'a> {
    sweep: &'static str,
    specification: &'a Specification,
    runs: Vec<Row<'a>>,
}

/// Name of the sweep in its results.
const NAME: &str = "file";

/// Sweep that is checked and ready to run.
struct Sweep {
    file: String,
    specification: Specification,
    base: Bench,
    points: Vec<Point>,
    header: Header,
}

impl Sweep {
    /// Reads and checks the file of a sweep and every bench of it.
    fn read(file: &str, options: &SweepOptions) -> Result<Self, CliError> {
        let step_s = options.step_s()?;
        let text = std::fs::read_to_string(file).map_err(|e| {
            CliError::Input(format!(
                "{file} (neither clearance, load, latch, step nor a file): cannot be read: {e}"
            ))
        })?;
        let mut specification = Specification::parse(file, &text)?;
        specification.force = options.force.unwrap_or(specification.force);
        let base = base(file, &specification, options)?;
        let points = points(file, &specification, &base)?;
        let header = Header {
            version: env!("CARGO_PKG_VERSION").into(),
            bench: base.to_toml().map_err(|e| CliError::Work(format!("{file}: {e}")))?,
            networks: BearingMaterial::ALL
                .iter()
                .map(|b| (b.name().to_owned(), force::identity(specification.force, *b)))
                .filter(|(_, sum)| !sum.is_empty())
                .collect(),
            specification: specification.clone(),
            step_s,
        };
        Ok(Self { file: file.into(), specification, base, points, header })
    }

    /// Executes the missing runs of a shard. Returns the number of runs that were already in the
    /// journal, and all records of the journal.
    fn execute(&self, shard: Shard, threads: usize, folder: &Path) -> Result<(usize, Vec<Record>), CliError> {
        owner::check(folder, NAME)?;
        let journal = journal::open(folder, &self.header, self.points.len())?;
        let done = journal.1.len();
        let runs = (0..self.points.len()).filter(|index| shard.contains(*index)).count();
        let bar = progress::bar(runs as u64);
        bar.set_message(format!("runs with {}", self.specification.force.name()));
        bar.inc(done as u64);
        let kind = (self.specification.force, self.header.step_s);
        let records = work::run((&self.points, shard), kind, threads, journal, || bar.inc(1))?;
        bar.finish_and_clear();
        Ok((done, records))
    }

    /// Writes runs.csv, sweep.json, timing.csv and report.html from the records of all runs.
    fn publish(&self, records: &[Record], folder: &Path, json: bool) -> Result<(), CliError> {
        let outcome = Outcome {
            sweep: NAME,
            specification: &self.specification,
            runs: table::rows(&self.specification, &self.points, records),
        };
        let text = output::json(&outcome)?;
        let mut files = Files::new(folder);
        files.add("runs.csv", &table::csv(&outcome.runs)?)?;
        files.add("sweep.json", &format!("{text}\n"))?;
        files.add("timing.csv", &timing(records))?;
        files.add_provenance()?;
        let pictures = pictures(&outcome)?;
        files.add_pictures(&pictures)?;
        files.add("report.html", &page(&self.file, &outcome, &pictures, &self.base).render())?;
        files.publish()?;
        if json {
            print_result!("{text}");
        } else {
            print_line!("{}", summary(&outcome));
            print_line!("report: {}", folder.join("report.html").display());
        }
        match records.iter().filter(|r| r.outcome.is_err()).count() {
            0 => Ok(()),
            failed => Err(CliError::Work(format!(
                "{failed} of {} runs failed; the column `error` of {} contains the reason",
                records.len(),
                folder.join("runs.csv").display()
            ))),
        }
    }
}

/// Runs the sweep of a file and writes its results.
pub(crate) fn run(file: &str, options: &SweepOptions, folder: &Path, json: bool) -> Result<(), CliError> {
    let sweep = Sweep::read(file, options)?;
    let (done, records) = sweep.execute(Shard::ALL, options.threads, folder)?;
    if done > 0 && !json {
        print_line!("{done} of {} runs were already in the journal", records.len());
    }
    sweep.publish(&records, folder, json)
}

/// Executes one shard of the sweep of a file into the journal of a folder.
pub(crate) fn run_shard(
    file: &str,
    options: &SweepOptions,
    shard: Shard,
    folder: &Path,
    json: bool,
) -> Result<(), CliError> {
    let sweep = Sweep::read(file, options)?;
    let (_, mut records) = sweep.execute(shard, options.threads, folder)?;
    records.retain(|record| shard.contains(record.index));
    let failed = records.iter().filter(|record| record.outcome.is_err()).count();
    shard::report(shard, [records.len(), sweep.points.len(), failed], &folder.join(journal::NAME), json)
}

/// Merges the shards of the sweep of a file and writes the results of a sweep on one machine.
pub(crate) fn merge(
    file: &str,
    options: &SweepOptions,
    shards: &[PathBuf],
    folder: &Path,
    json: bool,
) -> Result<(), CliError> {
    let sweep = Sweep::read(file, options)?;
    owner::check(folder, NAME)?;
    let records = shard::merge::<Record>(shards, folder, journal::NAME, &sweep.header, sweep.points.len())?;
    sweep.publish(&records, folder, json)
}

/// Opens the base bench: a preset, or a file beside the sweep's file.
fn base(file: &str, specification: &Specification, options: &SweepOptions) -> Result<Bench, CliError> {
    if let Some(found) = &options.bench {
        return Err(CliError::Input(format!(
            "--bench: found {found}; expected none: {file} names its bench, {}",
            specification.bench
        )));
    }
    let name = &specification.bench;
    if PRESETS.iter().any(|(preset, _)| preset == name) {
        return Ok(Bench::open(name)?);
    }
    let path = Path::new(file).parent().unwrap_or(Path::new("")).join(name);
    Ok(Bench::open(&path.to_string_lossy())?)
}

fn timing(records: &[Record]) -> String {
    let mut text = String::from("index,wall_s\n");
    records.iter().for_each(|r| text.push_str(&format!("{},{}\n", r.index, r.wall_s)));
    text
}

type Reading = (&'static str, &'static str, &'static str, fn(&Figures) -> f64);
const READINGS: [Reading; 4] = [
    ("peak-force", "Peak impact force", "N", |f| f.peak_contact_force_n),
    ("oscillation", "Oscillation", "N rms", |f| f.oscillation_rms_n),
    ("peak-torque", "Peak friction torque", "N m", |f| f.peak_friction_torque_nm),
    ("deformation", "Largest deformation", "um", |f| f.max_deformation_m * 1e6),
];

/// Range of every figure.
fn summary(outcome: &Outcome) -> String {
    let mut text = format!("{} runs\n", outcome.runs.len());
    for (_, what, unit, read) in READINGS {
        let values = || outcome.runs.iter().filter_map(|r| r.figures).map(read);
        let (low, high) =
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        if low <= high {
            text.push_str(&format!("{what:<24} {low:>10.1} to {high:>10.1} {unit}\n"));
        }
    }
    text.push_str(&bars(outcome));
    text.push('\n');
    text
}

fn bars(outcome: &Outcome) -> String {
    let figures: Vec<&Figures> = outcome.runs.iter().filter_map(|r| r.figures).collect();
    PerPeak::largest_bars(figures.into_iter())
}

fn pictures(outcome: &Outcome) -> Result<Vec<Picture>, CliError> {
    let mut pictures = Vec::new();
    for (number, parameter) in outcome.specification.parameters.iter().enumerate() {
        for (name, what, unit, read) in READINGS {
            let series: Vec<Series> = BearingMaterial::ALL
                .into_iter()
                .map(|bearing| {
                    let point = |row: &Row| {
                        let figures = row.figures.filter(|f| f.bearing == bearing)?;
                        Some((*row.parameters.get(parameter.path.as_str())?, read(figures)))
                    };
                    let points = outcome.runs.iter().filter_map(point).collect();
                    Series::through(bearing.name(), points).styled(Style::Points)
                })
                .filter(|s| !s.points.is_empty())
                .collect();
            let chart = Chart { title: what, x: &parameter.path, y: unit, size: (512, 320) };
            let file = format!("parameter-{}-{name}", number + 1);
            let draw =
                if parameter.range.is_some_and(|r| r.scale == Scale::Log) { lines_log_x } else { lines };
            pictures.push(Picture::draw(draw, &file, &chart, &series, "One point a run.")?);
        }
    }
    Ok(pictures)
}

/// Formats a number as in the file, or with five digits if that is long.
fn short(value: f64) -> String {
    let text = value.to_string();
    if text.len() <= 9 { text } else { format!("{value:.4e}") }
}

fn page(file: &str, outcome: &Outcome, pictures: &[Picture], base: &Bench) -> Page {
    let mut page = Page::new("Sweep");
    let name = Path::new(file).file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    page.lead(&format!(
        "{} runs of {} after {name}, bearing force from {}.",
        outcome.runs.len(),
        outcome.specification.bench,
        outcome.specification.force.name()
    ));
    page.section("Figures over each parameter");
    output::show(&mut page, pictures);
    page.section("Runs");
    page.note(&format!("Here {}. runs.csv has each.", bars(outcome)));
    if outcome.runs.len() > LISTED {
        page.note(&format!("The first {LISTED} of {}; runs.csv has all.", outcome.runs.len()));
    }
    let paths: Vec<&str> = outcome.specification.parameters.iter().map(|p| p.path.as_str()).collect();
    let mut header = vec!["run", "bearing"];
    header.extend(&paths);
    let names: Vec<String> = READINGS.iter().map(|(_, what, unit, _)| format!("{what}, {unit}")).collect();
    header.extend(names.iter().map(String::as_str));
    let row = |row: &Row| {
        let bearing = row.figures.map_or("failed", |f| f.bearing.name());
        let mut cells = vec![row.index.to_string(), bearing.into()];
        cells.extend(paths.iter().map(|p| row.parameters.get(p).map_or_else(String::new, |v| short(*v))));
        match (row.figures, row.error) {
            (Some(figures), _) => {
                cells.extend(READINGS.iter().map(|(_, _, _, read)| format!("{:.1}", read(figures))));
            }
            (None, error) => cells.push(error.unwrap_or_default().into()),
        }
        cells
    };
    page.table(&header, &outcome.runs.iter().take(LISTED).map(row).collect::<Vec<_>>());
    limits::section(&mut page, &**base);
    page
}
