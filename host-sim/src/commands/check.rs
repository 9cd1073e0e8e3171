//! `host-sim check`: judges measured logs and a description before a diagnosis.

use crate::cli::error::CliError;
use crate::cli::options::BenchOptions;
use crate::cli::{output, progress};
use crate::inspect::text;
use clap::Args;
use diagnosis::inspect;
use std::path::PathBuf;

/// Arguments of `host-sim check`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim check log.csv --bench my-bench.toml\n  \
    host-sim check stroke*.csv --bench examples/seal-friction.toml --json\n\n\
    Prints the quality of the log, suspicious units, signs and axes, the declared parameters that the \
    motion does not show or does not separate, and motions that would. Findings of any kind exit 0.")]
pub struct CheckArgs {
    /// Measured logs of one bench, in a format that `host-sim log info` reads.
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// The bench as described.
    #[command(flatten)]
    pub bench: BenchOptions,
    /// Folder for check.json; without it nothing is written.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the findings as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
pub fn run(args: &CheckArgs) -> Result<(), CliError> {
    if let Some(folder) = &args.out {
        output::check_folder(folder)?;
    }
    let bench = args.bench.open()?;
    let logs = super::diagnose::read(&args.logs, &bench)?;
    let bar = progress::bar(1);
    bar.set_message("checking the logs");
    let inspection = inspect(&bench, &logs);
    bar.finish_and_clear();
    let inspection = inspection?;
    let json = output::result_json(&inspection)?;
    if let Some(folder) = &args.out {
        output::write(folder, "check.json", &format!("{json}\n"))?;
    }
    if args.json {
        print_result!("{json}");
    } else {
        print_line!("{}", text::text(&inspection).trim_end());
    }
    Ok(())
}
