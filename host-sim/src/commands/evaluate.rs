//! `host-sim evaluate`: simulates a described bench under the inputs of measured logs and compares;
//! fits nothing.

use crate::cli::error::CliError;
use crate::cli::options::BenchOptions;
use crate::cli::output::{self, Files};
use crate::cli::progress;
use crate::evaluate::{report, text};
use clap::Args;
use diagnosis::evaluate;
use std::path::PathBuf;

/// Arguments of `host-sim evaluate`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim evaluate log.csv --bench my-bench.toml\n  \
    host-sim evaluate stroke*.csv --bench examples/seal-friction.toml --json\n  \
    host-sim evaluate friday.csv --bench out/diagnosis/extended-bench.toml --out out/evaluation\n\n\
    Nothing is fitted and no reading is corrected: `diagnose` does both. Rows without a reading are \
    left out.")]
pub struct EvaluateArgs {
    /// Measured logs of one bench, in a format that `host-sim log info` reads.
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// The bench as described.
    #[command(flatten)]
    pub bench: BenchOptions,
    /// Folder for evaluation.json and report.html; without it nothing is written.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the errors as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
pub fn run(args: &EvaluateArgs) -> Result<(), CliError> {
    if let Some(folder) = &args.out {
        output::check_folder(folder)?;
    }
    let bench = args.bench.open()?;
    let logs = super::diagnose::read(&args.logs, &bench)?;
    let bar = progress::bar(1);
    bar.set_message("simulating the logs");
    let evaluation = evaluate(&bench, &logs);
    bar.finish_and_clear();
    let evaluation = evaluation?;
    let json = output::result_json(&evaluation)?;
    if let Some(folder) = &args.out {
        let page = report::page(&evaluation, &args.bench.bench, &bench).map_err(CliError::Work)?;
        let mut files = Files::new(folder);
        files.add("evaluation.json", &format!("{json}\n"))?;
        files.add_page("report.html", page)?;
        files.publish()?;
    }
    if args.json {
        print_result!("{json}");
        return Ok(());
    }
    print_line!("{}", text::text(&evaluation).trim_end());
    if let Some(folder) = &args.out {
        print_line!("\nreport: {}", folder.join("report.html").display());
    }
    Ok(())
}
