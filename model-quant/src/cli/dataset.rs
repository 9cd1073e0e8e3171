//! `model-quant dataset`: rows as a CSV table; its subcommands write complete sets.

mod collision;
mod friction;
mod progress;

use crate::cli::checkpoint::BearingParser;
use crate::cli::error::CliError;
use crate::cli::output::{print, print_json};
use crate::data::csv::table;
use crate::data::draw::Purpose;
use crate::data::features::FloatFeatures;
use crate::data::file_io::write_atomically;
use crate::data::ranges::{RangeKind, header};
use crate::data::rows::draw_rows;
use crate::data::statistics::mean;
use inference::BearingMaterial;
use serde_json::json;
use std::path::PathBuf;

/// Maximum number of rows in a table.
const ROWS_LIMIT: usize = 20_000_000;

/// Write rows of a data set as CSV: states and the forces of the laws; or a complete set with a
/// subcommand
///
/// A row depends on seed, set and index alone, so a longer table begins with the shorter one.
/// `paper` is Table 2 of the paper; `bench` covers the states of the transmission bench, and the
/// shipped models were trained on it. Both limit the ratio of rate to approach speed to -6..6: a
/// rate beyond is replaced by that of the nearest limit.
#[derive(Debug, clap::Args)]
#[command(
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    after_help = "Examples:\n  model-quant dataset --bearing plastic --range paper --rows 1000 --seed 7 \
                  --out rows.csv\n  \
                  model-quant dataset collision --bearing plastic --out sets --format parquet\n  \
                  model-quant dataset friction --bearing plastic --out sets"
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    complete_set: Option<CompleteSet>,
    /// Bearing material
    #[arg(long, value_parser = BearingParser, default_value = "babbitt")]
    bearing: BearingMaterial,
    /// Ranges and distributions
    #[arg(long, value_enum, default_value_t = RangeKind::Bench)]
    range: RangeKind,
    /// Set of rows
    #[arg(long, value_enum, default_value_t = Set::Training)]
    set: Set,
    /// Number of rows
    #[arg(long, default_value_t = 10_000)]
    rows: usize,
    /// Seed of every random draw; the shipped models use 2
    #[arg(long, default_value_t = 2)]
    seed: u64,
    /// File to write
    #[arg(long, value_name = "FILE", required = true)]
    out: Option<PathBuf>,
    /// Print a summary as JSON
    #[arg(long)]
    json: bool,
}

/// Complete sets.
#[derive(Debug, clap::Subcommand)]
enum CompleteSet {
    Collision(collision::Arguments),
    Friction(friction::Arguments),
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Set {
    Training,
    Validation,
    Calibration,
    Test,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let out = match (&arguments.complete_set, &arguments.out) {
        (Some(CompleteSet::Collision(arguments)), _) => return collision::run(arguments),
        (Some(CompleteSet::Friction(arguments)), _) => return friction::run(arguments),
        (None, Some(out)) => out,
        // Unreachable: without a subcommand clap requires the option.
        (None, None) => return Err(CliError::Argument("--out", "nothing".to_owned(), "a file to write")),
    };
    if arguments.rows == 0 || arguments.rows > ROWS_LIMIT {
        return Err(CliError::Argument("--rows", arguments.rows.to_string(), "1 to 20000000"));
    }
    let purpose = match arguments.set {
        Set::Training => Purpose::TrainingRows,
        Set::Validation => Purpose::ValidationRows,
        Set::Calibration => Purpose::CalibrationRows,
        Set::Test => Purpose::TestRows,
    };
    let features = FloatFeatures::from_header(&header(arguments.bearing, arguments.range));
    let set = draw_rows(arguments.bearing, arguments.range, arguments.seed, purpose, arguments.rows);
    let text = table(&features, &set);
    write_atomically(out, text.as_bytes())?;
    let largest = set.iter().fold(0.0_f64, |largest, row| largest.max(row.normal_force_n));
    let mean = mean(set.iter().map(|row| row.normal_force_n));
    let summary = json!({
        "file": out.display().to_string(),
        "bearing": arguments.bearing.name(),
        "range": arguments.range,
        "rows": set.len(),
        "seed": arguments.seed,
        "mean_normal_force_n": mean,
        "largest_normal_force_n": largest,
    });
    if arguments.json {
        return print_json(&summary);
    }
    print(format_args!(
        "{}: {} rows, normal force mean {mean:.1} N, largest {largest:.1} N",
        out.display(),
        set.len()
    ))?;
    Ok(())
}
