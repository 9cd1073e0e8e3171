//! `host-sim log`: content of a log file, and its conversion to another format.

use crate::cli::error::CliError;
use crate::cli::output;
use crate::logs::{convert, info, text};
use bench::Bench;
use bench::log::RawLog;
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// Arguments of `host-sim log`.
#[derive(Args, Clone, Debug)]
pub struct LogArgs {
    /// Action.
    #[command(subcommand)]
    pub action: LogAction,
}

/// Actions of `host-sim log`.
#[derive(Clone, Debug, Subcommand)]
pub enum LogAction {
    /// Show the columns of a log with units and ranges, its rate, and what is no column of numbers.
    Info(InfoArgs),
    /// Write a log as CSV, Parquet or MAT-file.
    Convert(ConvertArgs),
}

/// Arguments of `host-sim log info`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim log info bench.mf4\n  \
    host-sim log info bench.tdms --json\n\n\
    Reads CSV and other texts, Parquet, MAT-files of version 5 to 7.3, HDF5, MDF of version 4,\n\
    TDMS, MCAP and workbooks (.xlsx). The content decides about the format, not the name.")]
pub struct InfoArgs {
    /// Log.
    #[arg(value_name = "LOG")]
    pub log: PathBuf,
    /// Print as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `host-sim log convert`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim log convert bench.mf4 bench.parquet\n  \
    host-sim log convert bench.tdms bench.csv --column wf_time --column force\n  \
    host-sim log convert bench.mf4 bench.csv --rate 1000\n  \
    host-sim log convert bench.mat si.csv --bench my-bench.toml\n\n\
    Without --bench the values and names are those of the log; columns with another number of rows\n\
    or other times than the time are left out, unless --rate gives all columns one time. With --bench\n\
    the file has the signals of the description in SI.")]
pub struct ConvertArgs {
    /// Log.
    #[arg(value_name = "LOG")]
    pub log: PathBuf,
    /// File to write: .csv, .parquet or .mat.
    #[arg(value_name = "OUT")]
    pub out: PathBuf,
    /// Column to write; may be repeated.
    #[arg(long, value_name = "NAME", conflicts_with = "bench")]
    pub column: Vec<String>,
    /// Preset or description whose [log] and [columns] tables map the columns.
    #[arg(long, value_name = "NAME|FILE")]
    pub bench: Option<String>,
    /// Rate in Hz to which columns of several rates are interpolated linearly.
    #[arg(long, value_name = "HZ", value_parser = rate, conflicts_with = "bench")]
    pub rate: Option<f64>,
    /// Print the columns that were written as JSON.
    #[arg(long)]
    pub json: bool,
}

fn rate(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|rate| (1e-6..=1e7).contains(rate));
    rate.ok_or_else(|| format!("found {text}; expected 1e-6 to 1e7"))
}

/// Runs the command.
pub fn run(args: &LogArgs) -> Result<(), CliError> {
    match &args.action {
        LogAction::Info(args) => show(args),
        LogAction::Convert(args) => write(args),
    }
}

fn show(args: &InfoArgs) -> Result<(), CliError> {
    let found = info(&RawLog::read(&args.log)?);
    if args.json {
        print_result!("{}", output::json(&found)?);
    } else {
        print_line!("{}", text::text(&found).trim_end());
    }
    Ok(())
}

fn write(args: &ConvertArgs) -> Result<(), CliError> {
    convert::check(&args.log, &args.out)?;
    let written = match &args.bench {
        Some(bench) => convert::described(&args.log, &Bench::open(bench)?, &args.out)?,
        None => {
            let log = RawLog::read(&args.log)?;
            match args.rate {
                Some(rate_hz) => convert::resampled(&log, &args.column, rate_hz, &args.out)?,
                None => convert::as_found(&log, &args.column, &args.out)?,
            }
        }
    };
    if args.json {
        print_result!("{}", output::json(&written)?);
        return Ok(());
    }
    print_line!("{}: {} rows of {}", written.log, written.rows, written.columns.join(", "));
    if !written.left_out.is_empty() {
        print_line!("left out: {}", written.left_out.join(", "));
    }
    Ok(())
}
