//! `model-quant dataset collision`: the collision set of a bearing, split, as files.

use super::super::{CliError, parse_bearing, print, print_json};
use super::progress::Progress;
use inference::Bearing;
use model_quant::dataset::bench_runs::{self, BenchRun, OutsideShare, bench_runs, outside};
use model_quant::dataset::collision::{COLUMNS, CollisionSet, Effects, window_names};
use model_quant::dataset::grid::ROWS;
use model_quant::dataset::sink::{Complete, Format, Part, Sink, publish};
use model_quant::dataset::split::Split;
use model_quant::dataset::spread::Spread;
use model_quant::dataset::stream::stream;
use model_quant::features::FloatFeatures;
use model_quant::ranges::{RangeKind, header};
use model_quant::write::write_whole;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The collision set of a bearing: Table 2 of the paper in full, split into training, validation and test
///
/// `--range paper` is Table 2: 15 clearances (uniform), 100 deformations, 100 rates and 100 latched rates (exponential), all
/// 1.5e7 combinations, shuffled and split 1e7 / 2.5e6 / 2.5e6. `--range bench` draws as many rows from what the bench
/// meets, the rows of the shipped models. Table 2 gives the ratio of the rates no bound: the latched rate is raised to
/// 1 mm/s and the rate then lowered to 6 times that; the summary shows what this does to the force. `--source bench`
/// takes 24 runs of bench B at 10 kHz through its noisy sensors instead, whole runs to each part. A row depends on seed
/// and place alone: a set of fewer rows is the beginning of each part, on any number of threads.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  model-quant dataset collision --bearing plastic --out sets --format parquet\n  \
                  model-quant dataset collision --range bench --rows 60000 --windows --out sets\n  \
                  model-quant dataset collision --source bench --out sets\n  \
                  model-quant dataset collision --summary --json"
)]
pub(crate) struct Arguments {
    /// Bearing: babbitt or plastic
    #[arg(long, value_parser = parse_bearing, default_value = "babbitt")]
    bearing: Bearing,
    /// Where the rows come from: the tables' ranges, or recorded runs of bench B
    #[arg(long, value_enum, default_value_t = Source::Table)]
    source: Source,
    /// Ranges and distributions; the ranges of the inputs with --windows
    #[arg(long, value_enum, default_value_t = RangeKind::Paper)]
    range: RangeKind,
    /// Rows of all three parts together; 15000000 if not given
    #[arg(long, value_name = "N")]
    rows: Option<u64>,
    /// Write the networks' windows instead of states
    #[arg(long)]
    windows: bool,
    /// Seed of every draw
    #[arg(long, default_value_t = 2)]
    seed: u64,
    /// Form of the files
    #[arg(long, value_enum, default_value_t = Format::Csv)]
    format: Format,
    /// Directory that gets the three files and a card, NAME.json
    #[arg(long, value_name = "DIR", required_unless_present = "summary")]
    out: Option<PathBuf>,
    /// Make and summarise all rows, write nothing
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

/// What came of a set.
struct Made {
    rows: [u64; 3],
    effects: Effects,
    files: Vec<Complete>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    if let Some(rows) = arguments.rows {
        if arguments.source == Source::Bench {
            let found = format!("{rows} with --source bench");
            return Err(CliError::Argument("--rows", found, "nothing: the runs have their length"));
        }
        if !(6..=ROWS).contains(&rows) {
            return Err(CliError::Argument("--rows", rows.to_string(), "6 to 15000000"));
        }
    }
    let started = Instant::now();
    let features = FloatFeatures::of(&header(arguments.bearing, arguments.range));
    let runs = || bench_runs(arguments.bearing, arguments.seed);
    let (made, runs, seconds) = match arguments.source {
        Source::Table => {
            let made = from_table(arguments)?;
            let seconds = started.elapsed().as_secs_f64();
            (made, runs()?, seconds)
        }
        Source::Bench => {
            let runs = runs()?;
            let made = from_runs(arguments, &features, &runs)?;
            (made, runs, started.elapsed().as_secs_f64())
        }
    };
    let outside = outside(&features, &runs);
    let card = card(arguments, &made, &outside);
    let mut files = Vec::new();
    if let Some(directory) = &arguments.out {
        files = publish(made.files)?;
        let path = directory.join(format!("{}.json", name(arguments)));
        write_whole(&path, format!("{}\n", serde_json::to_string_pretty(&card)?).as_bytes())?;
        files.push(path);
    }
    let rows_per_s = made.rows.iter().sum::<u64>() as f64 / seconds;
    if arguments.json {
        let mut summary = card;
        summary["seconds"] = json!(seconds);
        summary["rows_per_s"] = json!(rows_per_s);
        summary["files"] = json!(files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>());
        return print_json(&summary);
    }
    text(arguments, &made.rows, &made.effects, &outside)?;
    for file in files {
        print(format_args!("wrote {}", file.display()))?;
    }
    let did = if arguments.summary { "made" } else { "made and written" };
    print(format_args!("{did} in {seconds:.2} s, {:.2} million rows/s", 1e-6 * rows_per_s))
}

/// Name of the set's files, before the part's.
fn name(arguments: &Arguments) -> String {
    let source = match (arguments.source, arguments.range) {
        (Source::Bench, _) => "runs",
        (Source::Table, RangeKind::Paper) => "paper",
        (Source::Table, RangeKind::Bench) => "bench",
        (Source::Table, RangeKind::Rig) => "rig",
    };
    let windows = if arguments.windows { "-windows" } else { "" };
    format!("collision-{}-{source}{windows}", arguments.bearing.name())
}

/// Opens the file of a part, unless nothing is to be written.
fn open(arguments: &Arguments, split: Split, names: &[String]) -> Result<Option<Sink>, CliError> {
    let Some(directory) = &arguments.out else { return Ok(None) };
    let file = format!("{}-{}.{}", name(arguments), split.name(), arguments.format.ending());
    let path: &Path = &directory.join(file);
    // The values of the grid's axes come again and again; forces and windows do not.
    let repeating = |column| !arguments.windows && column + 1 < names.len();
    Ok(Some(Sink::create(path, arguments.format, names, repeating)?))
}

fn from_table(arguments: &Arguments) -> Result<Made, CliError> {
    let set = CollisionSet::new(arguments.bearing, arguments.range, arguments.seed);
    let names = if arguments.windows { window_names() } else { COLUMNS.map(str::to_owned).to_vec() };
    let total = arguments.rows.unwrap_or(ROWS);
    let progress = Progress::new(total);
    let (mut effects, mut files) = (Effects::default(), Vec::new());
    let rows = Split::ALL.map(|split| split.rows_of(total));
    for (split, rows) in Split::ALL.into_iter().zip(rows) {
        let mut sink = open(arguments, split, &names)?;
        let writes = sink.is_some();
        let make = |rows: std::ops::Range<u64>| {
            let count = rows.end - rows.start;
            let (columns, effects) = set.block(split, rows, arguments.windows);
            (writes.then(|| Part::new(columns, arguments.format)), effects, count)
        };
        stream(0..rows, names.len(), make, |blocks| {
            let mut parts = Vec::new();
            for (part, more, count) in blocks {
                effects.join(&more);
                parts.extend(part);
                progress.add(count);
            }
            sink.as_mut().map_or(Ok(()), |sink| sink.write(&parts))
        })?;
        files.extend(sink.map(Sink::complete).transpose()?);
    }
    Ok(Made { rows, effects, files })
}

fn from_runs(arguments: &Arguments, features: &FloatFeatures, runs: &[BenchRun]) -> Result<Made, CliError> {
    let start = ["run".to_owned(), "time_s".to_owned()];
    let names = if arguments.windows {
        start.into_iter().chain(window_names()).collect()
    } else {
        bench_runs::COLUMNS.map(str::to_owned).to_vec()
    };
    let (mut effects, mut files, mut rows) = (Effects::default(), Vec::new(), [0; 3]);
    for (split, rows) in Split::ALL.into_iter().zip(&mut rows) {
        let columns = bench_runs::columns(features, runs, arguments.seed, split, arguments.windows);
        let forces = columns.last().map(Vec::as_slice).unwrap_or_default();
        *rows = forces.len() as u64;
        forces.iter().for_each(|&force| effects.force_n.add(f64::from(force)));
        if let Some(mut sink) = open(arguments, split, &names)? {
            sink.write(&[Part::new(columns, arguments.format)])?;
            files.push(sink.complete()?);
        }
    }
    Ok(Made { rows, effects, files })
}

/// Shares at which a spread is shown.
const SHARES: [f64; 5] = [0.01, 0.25, 0.5, 0.75, 0.99];

fn figures(spread: &Spread) -> Value {
    let [p1, p25, p50, p75, p99] = SHARES.map(|share| spread.quantile(share));
    json!({
        "min": spread.low(), "p1": p1, "p25": p25, "median": p50, "p75": p75, "p99": p99, "max": spread.high(),
        "mean": spread.mean(),
    })
}

/// The spreads of the force that there are, with what they stand for.
fn spreads(effects: &Effects) -> Vec<(&'static str, &Spread)> {
    let mut spreads = vec![("as_written", &effects.force_n)];
    if let Some([floored, bare]) = &effects.without {
        spreads.extend([("floor_without_limit", floored), ("no_floor_no_limit", bare)]);
    }
    spreads
}

fn card(arguments: &Arguments, made: &Made, outside: &OutsideShare) -> Value {
    let count = made.rows.iter().sum::<u64>().max(1) as f64;
    let [training, validation, test] = made.rows;
    let rules = (arguments.source == Source::Table).then(|| {
        json!({
            "rule": "latched rate raised to 1 mm/s, rate then lowered to 6 times that",
            "share_limited": made.effects.limited as f64 / count,
            "share_below_floor": made.effects.below_floor as f64 / count,
        })
    });
    let force: serde_json::Map<_, _> =
        spreads(&made.effects).into_iter().map(|(name, spread)| (name.to_owned(), figures(spread))).collect();
    json!({
        "set": "collision",
        "bearing": arguments.bearing.name(),
        "source": arguments.source,
        "range": arguments.range,
        "windows": arguments.windows,
        "seed": arguments.seed,
        "rows": { "training": training, "validation": validation, "test": test },
        "ratio": rules,
        "normal_force_n": force,
        "bench_share_outside_range": outside,
    })
}

fn text(
    arguments: &Arguments,
    rows: &[u64; 3],
    effects: &Effects,
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
        print(format_args!(
            "rate over latched rate limited to 6 in {:.2} % of the rows; latched rate below the floor of 1 mm/s in {:.2} %",
            100.0 * effects.limited as f64 / count,
            100.0 * effects.below_floor as f64 / count
        ))?;
    }
    print(format_args!(
        "{:20} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}",
        "normal force in N", "min", "1 %", "25 %", "median", "75 %", "99 %", "max", "mean"
    ))?;
    for (name, spread) in spreads(effects) {
        let [p1, p25, p50, p75, p99] = SHARES.map(|share| spread.quantile(share));
        print(format_args!(
            "{:20} {:10.3e} {p1:10.3e} {p25:10.3e} {p50:10.3e} {p75:10.3e} {p99:10.3e} {:10.3e} {:10.3e}",
            name.replace('_', " "),
            spread.low(),
            spread.high(),
            spread.mean()
        ))?;
    }
    print(format_args!(
        "outside the range: {:.2} % of the contact of 24 runs of bench B ({:.2} % by the deformation, deepest {:.0} um; {:.2} % by the \
         ratio); the rate is below 0 in {:.1} %",
        100.0 * outside.any,
        100.0 * outside.deformation,
        1e6 * outside.deepest_m,
        100.0 * outside.rate_ratio,
        100.0 * outside.rate_below_zero
    ))
}
