//! `host-sim record`: simulates a log as the bench's sensors would record it.

use crate::cli::error::CliError;
use crate::cli::options::BenchOptions;
use crate::cli::output;
use bench::log::LogError;
use bench::simulate::record;
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// File name inside a folder.
const DEFAULT_NAME: &str = "log.csv";

/// Arguments of `host-sim record`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim record --cycles 5 --seed 7 --out log.csv\n  \
    host-sim record --bench worn-bench.toml --cycles 5 --seed 7 --out out/record\n  \
    host-sim record --cycles 5 --out log.parquet")]
pub struct RecordArgs {
    /// The bench.
    #[command(flatten)]
    pub bench: BenchOptions,
    /// Seed of the sensors' noise.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Log file (.parquet: Parquet, .mat: MAT-file of version 5, else CSV), or a folder for
    /// log.csv.
    #[arg(long, default_value = "out/record", value_name = "FILE|DIR")]
    pub out: PathBuf,
    /// Print a summary as JSON.
    #[arg(long)]
    pub json: bool,
}

#[derive(Serialize, JsonSchema)]
pub(crate) struct Written {
    log: String,
    samples: usize,
    duration_s: f64,
    channels: Vec<&'static str>,
    seed: u64,
}

/// Runs the command.
pub fn run(args: &RecordArgs) -> Result<(), CliError> {
    let bench = args.bench.open()?;
    let path = file_of(&args.out);
    output::check_folder(path.parent().unwrap_or(Path::new("")))?;
    let log = record(&bench, args.seed)?;
    log.write(&path).map_err(|error| match error {
        LogError::Io { source, .. } => CliError::output(&path, &source),
        other => CliError::Work(other.to_string()),
    })?;
    let written = Written {
        log: path.display().to_string(),
        samples: log.time_s.len(),
        duration_s: log.time_s.last().copied().unwrap_or_default(),
        channels: log.channels.keys().map(|c| c.name()).collect(),
        seed: args.seed,
    };
    if args.json {
        print_result!(
            "{}",
            serde_json::to_string_pretty(&written).map_err(|e| CliError::Work(e.to_string()))?
        );
    } else {
        print_line!("{}: {} samples of {} channels", written.log, written.samples, written.channels.len());
    }
    Ok(())
}

/// Returns the file. A path without an extension, or an existing folder, is a folder.
fn file_of(out: &Path) -> PathBuf {
    if out.is_dir() || out.extension().is_none() { out.join(DEFAULT_NAME) } else { out.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_gets_a_log_of_the_default_name() {
        assert_eq!(file_of(Path::new("out/record")), Path::new("out/record/log.csv"));
        assert_eq!(file_of(Path::new("a.csv")), Path::new("a.csv"));
    }
}
