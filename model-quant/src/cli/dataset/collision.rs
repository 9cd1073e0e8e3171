//! `model-quant dataset collision`: writes the collision set of a bearing in three parts.

use super::progress::Progress;
use crate::cli::checkpoint::BearingParser;
use crate::cli::error::CliError;
use crate::cli::output::{print, print_json};
use crate::data::bench_runs::{self, BenchRun, OutsideShare, bench_runs, measure_outside_share};
use crate::data::collision::{COLUMNS, CollisionSet, LimitStatistics, window_names};
use crate::data::features::FloatFeatures;
use crate::data::file_io::write_atomically;
use crate::data::histogram::Histogram;
use crate::data::parameter_grid::ROWS;
use crate::data::ranges::{RangeKind, header};
use crate::data::sink::{Complete, Format, FormattedRows, Sink, publish};
use crate::data::split::Split;
use crate::data::stream::stream;
use inference::BearingMaterial;
use report::text_table;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The collision set of a bearing: Table 2 of the paper in full, split into training, validation
/// and test
///
/// `--range paper` is Table 2: 15 clearances (uniform), 100 deformations, 100 rates and 100
/// approach speeds (exponential), shuffled and split into two thirds, a sixth and a sixth. No row
/// occurs twice. Table 2 does not limit the ratio of rate to approach speed, the networks do: the
/// approach speed is raised to 1 mm/s, then the rate is limited to 6 times that, and points that
/// become equal are one row. `--printed` leaves the table as it is: all 1.5e7 combinations, split
/// 1e7 / 2.5e6 / 2.5e6, with the forces of the printed formula. `--range bench` draws 1.5e7 rows
/// from the states of the bench, as for the shipped models.
/// `--source bench` takes 24 simulated runs of bench B at 10 kHz through its noisy sensors; each
/// run belongs to one part. A row depends on seed and index alone: a smaller set is the beginning
/// of each part, on any number of threads.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  model-quant dataset collision --bearing plastic --out sets \
                  --format parquet\n  \
                  model-quant dataset collision --range bench --rows 60000 --windows --out sets\n  \
                  model-quant dataset collision --source bench --out sets\n  \
                  model-quant dataset collision --printed --out sets\n  \
                  model-quant dataset collision --summary --json")]
pub(crate) struct Arguments {
    /// Bearing material
    #[arg(long, value_parser = BearingParser, default_value = "babbitt")]
    bearing: BearingMaterial,
    /// Source of the rows: the ranges, or simulated runs of bench B
    #[arg(long, value_enum, default_value_t = Source::Table)]
    source: Source,
    /// Ranges and distributions; with --windows the ranges of the features
    #[arg(long, value_enum, default_value_t = RangeKind::Paper)]
    range: RangeKind,
    /// Table 2 as printed: no floor of the approach speed, no limit of the ratio
    #[arg(long, conflicts_with = "windows")]
    printed: bool,
    /// Rows of all three parts together; default: all
    #[arg(long, value_name = "N")]
    rows: Option<u64>,
    /// Write the networks' windows instead of states
    #[arg(long)]
    windows: bool,
    /// Seed of every random draw
    #[arg(long, default_value_t = 2)]
    seed: u64,
    /// File format
    #[arg(long, value_enum, default_value_t = Format::Csv)]
    format: Format,
    /// Output directory for the three files and a card, NAME.json
    #[arg(long, value_name = "DIR", required_unless_present = "summary")]
    out: Option<PathBuf>,
    /// Generate and summarise all rows; write nothing
    #[arg(long, conflicts_with_all = ["out", "format"])]
    summary: bool,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
enum Source {
    Table,
    Bench,
}

/// Result of a set.
struct GeneratedSet {
    rows: [u64; 3],
    limits: LimitStatistics,
    files: Vec<Complete>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    if let Some(rows) = arguments.rows {
        if arguments.source == Source::Bench {
            let found = format!("{rows} with --source bench");
            return Err(CliError::Argument("--rows", found, "nothing: the length of the runs is fixed"));
        }
        if !(6..=ROWS).contains(&rows) {
            return Err(CliError::Argument("--rows", rows.to_string(), "6 to 15000000"));
        }
    }
    if arguments.printed && (arguments.source, arguments.range) != (Source::Table, RangeKind::Paper) {
        let found = "another source or range".to_owned();
        return Err(CliError::Argument("--printed", found, "--source table and --range paper"));
    }
    let started = Instant::now();
    let features = FloatFeatures::from_header(&header(arguments.bearing, arguments.range));
    let runs = || bench_runs(arguments.bearing, arguments.seed);
    let (set, runs, seconds) = match arguments.source {
        Source::Table => {
            let set = from_table(arguments)?;
            let seconds = started.elapsed().as_secs_f64();
            (set, runs()?, seconds)
        }
        Source::Bench => {
            let runs = runs()?;
            let set = from_runs(arguments, &features, &runs)?;
            (set, runs, started.elapsed().as_secs_f64())
        }
    };
    let outside = measure_outside_share(&features, &runs);
    let card = card(arguments, &set, &outside);
    let mut files = Vec::new();
    if let Some(directory) = &arguments.out {
        files = publish(set.files)?;
        let path = directory.join(format!("{}.json", name(arguments)));
        write_atomically(&path, format!("{}\n", serde_json::to_string_pretty(&card)?).as_bytes())?;
        files.push(path);
    }
    let rows_per_s = set.rows.iter().sum::<u64>() as f64 / seconds;
    if arguments.json {
        let mut summary = card;
        summary["seconds"] = json!(seconds);
        summary["rows_per_s"] = json!(rows_per_s);
        summary["files"] = json!(files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>());
        return print_json(&summary);
    }
    text(arguments, &set.rows, &set.limits, &outside)?;
    for file in files {
        print(format_args!("wrote {}", file.display()))?;
    }
    let action = if arguments.summary { "made" } else { "made and written" };
    print(format_args!("{action} in {seconds:.2} s, {:.2} million rows/s", 1e-6 * rows_per_s))
}

/// File name of the set, without the name of the part.
fn name(arguments: &Arguments) -> String {
    let source = match (arguments.source, arguments.range) {
        (Source::Bench, _) => "runs",
        (Source::Table, RangeKind::Paper) if arguments.printed => "printed",
        (Source::Table, RangeKind::Paper) => "paper",
        (Source::Table, RangeKind::Bench) => "bench",
        (Source::Table, RangeKind::Rig) => "rig",
    };
    let windows = if arguments.windows { "-windows" } else { "" };
    format!("collision-{}-{source}{windows}", arguments.bearing.name())
}

/// Opens the file of a part unless only a summary is requested.
fn open(arguments: &Arguments, split: Split, names: &[String]) -> Result<Option<Sink>, CliError> {
    let Some(directory) = &arguments.out else { return Ok(None) };
    let file = format!("{}-{}.{}", name(arguments), split.name(), arguments.format.ending());
    let path: &Path = &directory.join(file);
    // The values of the grid's axes repeat; forces and windows do not.
    let repeating = |column| !arguments.windows && column + 1 < names.len();
    Ok(Some(Sink::create(path, arguments.format, names, repeating)?))
}

fn from_table(arguments: &Arguments) -> Result<GeneratedSet, CliError> {
    let set = if arguments.printed {
        CollisionSet::as_printed(arguments.bearing, arguments.seed)
    } else {
        CollisionSet::new(arguments.bearing, arguments.range, arguments.seed)
    };
    let names = if arguments.windows { window_names() } else { COLUMNS.map(str::to_owned).to_vec() };
    // A set with merged points has fewer rows than the grid has points.
    let total = arguments.rows.unwrap_or(ROWS).min(set.rows());
    let progress = Progress::new(total);
    let (mut limits, mut files) = (LimitStatistics::default(), Vec::new());
    let rows = Split::ALL.map(|split| split.row_count(total));
    for (split, rows) in Split::ALL.into_iter().zip(rows) {
        let mut sink = open(arguments, split, &names)?;
        let writes = sink.is_some();
        let make = |rows: std::ops::Range<u64>| {
            let count = rows.end - rows.start;
            let (columns, limits) = set.block(split, rows, arguments.windows);
            (writes.then(|| FormattedRows::new(columns, arguments.format)), limits, count)
        };
        stream(0..rows, names.len(), make, |blocks| {
            let mut parts = Vec::new();
            for (part, more, count) in blocks {
                limits.join(&more);
                parts.extend(part);
                progress.add(count);
            }
            sink.as_mut().map_or(Ok(()), |sink| sink.write(&parts))
        })?;
        files.extend(sink.map(Sink::complete).transpose()?);
    }
    Ok(GeneratedSet { rows, limits, files })
}

fn from_runs(
    arguments: &Arguments,
    features: &FloatFeatures,
    runs: &[BenchRun],
) -> Result<GeneratedSet, CliError> {
    let start = ["run".to_owned(), "time_s".to_owned()];
    let names = if arguments.windows {
        start.into_iter().chain(window_names()).collect()
    } else {
        bench_runs::COLUMNS.map(str::to_owned).to_vec()
    };
    let (mut limits, mut files, mut rows) = (LimitStatistics::default(), Vec::new(), [0; 3]);
    for (split, rows) in Split::ALL.into_iter().zip(&mut rows) {
        let columns = bench_runs::columns(features, runs, arguments.seed, split, arguments.windows);
        let forces = columns.last().map(Vec::as_slice).unwrap_or_default();
        *rows = forces.len() as u64;
        forces.iter().for_each(|&force| limits.force_n.add(f64::from(force)));
        if let Some(mut sink) = open(arguments, split, &names)? {
            sink.write(&[FormattedRows::new(columns, arguments.format)])?;
            files.push(sink.complete()?);
        }
    }
    Ok(GeneratedSet { rows, limits, files })
}

/// Quantiles in the summary.
const SHARES: [f64; 5] = [0.01, 0.25, 0.5, 0.75, 0.99];

fn figures(histogram: &Histogram) -> Value {
    let [p1, p25, p50, p75, p99] = SHARES.map(|share| histogram.quantile(share));
    json!({
        "min": histogram.low(), "p1": p1, "p25": p25, "median": p50,
        "p75": p75, "p99": p99, "max": histogram.high(),
        "mean": histogram.mean(),
    })
}

fn card(arguments: &Arguments, set: &GeneratedSet, outside: &OutsideShare) -> Value {
    let count = set.rows.iter().sum::<u64>().max(1) as f64;
    let [training, validation, test] = set.rows;
    let rules = (arguments.source == Source::Table).then(|| {
        let rule = if arguments.printed {
            "none: Table 2 as printed"
        } else {
            "approach speed raised to 1 mm/s, rate then lowered to 6 times that"
        };
        json!({
            "rule": rule,
            "share_limited": set.limits.limited as f64 / count,
            "share_below_floor": set.limits.below_floor as f64 / count,
        })
    });
    json!({
        "set": "collision",
        "bearing": arguments.bearing.name(),
        "source": arguments.source,
        "range": arguments.range,
        "windows": arguments.windows,
        "seed": arguments.seed,
        "rows": { "training": training, "validation": validation, "test": test },
        "ratio": rules,
        "normal_force_n": figures(&set.limits.force_n),
        "bench_share_outside_range": outside,
    })
}

fn text(
    arguments: &Arguments,
    rows: &[u64; 3],
    limits: &LimitStatistics,
    outside: &OutsideShare,
) -> Result<(), CliError> {
    let [training, validation, test] = rows;
    let count = (training + validation + test).max(1) as f64;
    print(format_args!(
        "{}, seed {}: {training} training, {validation} validation, {test} test rows",
        name(arguments),
        arguments.seed
    ))?;
    if arguments.source == Source::Table {
        let limit = if arguments.printed { "beyond 6" } else { "limited to 6" };
        print(format_args!(
            "rate over approach speed {limit} in {:.2} % of the rows; \
             approach speed below the floor of 1 mm/s in {:.2} %",
            100.0 * limits.limited as f64 / count,
            100.0 * limits.below_floor as f64 / count
        ))?;
    }
    let header = ["", "min", "1 %", "25 %", "median", "75 %", "99 %", "max", "mean"];
    let histogram = &limits.force_n;
    let quantiles = SHARES.map(|share| histogram.quantile(share));
    let figures = [&[histogram.low()], &quantiles[..], &[histogram.high(), histogram.mean()]].concat();
    let figures = figures.iter().map(|figure| format!("{figure:.3e}"));
    let row = std::iter::once("normal force in N".to_owned()).chain(figures).collect::<Vec<_>>();
    print(format_args!("{}", text_table(header, [row], 1)))?;
    print(format_args!(
        "outside the range: {:.2} % of the contact of 24 runs of bench B ({:.2} % by the deformation, \
         deepest {:.0} um; {:.2} % by the ratio); the rate is below 0 in {:.1} %",
        100.0 * outside.any,
        100.0 * outside.deformation,
        1e6 * outside.deepest_m,
        100.0 * outside.rate_ratio,
        100.0 * outside.rate_below_zero
    ))
}
