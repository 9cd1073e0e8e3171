//! `host-sim diagnose`: finds what a simulation gets wrong in measured logs, names the cause,
//! measures the gain.

use crate::cli::error::CliError;
use crate::cli::options::BenchOptions;
use crate::cli::progress;
use crate::diagnose::{report, text};
use bench::{Bench, MeasuredLog, atomic};
use clap::Args;
use diagnosis::{Diagnosis, DiagnosisError, Options, diagnose};
use std::path::{Path, PathBuf};

/// Arguments of `host-sim diagnose`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim diagnose log.csv\n  \
    host-sim diagnose monday.csv tuesday.csv --held-out friday.csv --bench my-bench.toml --out \
    out/diagnosis\n  \
    host-sim diagnose stroke*.csv --bench examples/seal-friction.toml --json\n\n\
    Any verdict exits 0.")]
pub struct DiagnoseArgs {
    /// Measured logs of one bench: CSV, Parquet or MAT-files (version 5 to 7).
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// Logs on which nothing is fitted; without this option a part of each log is held out.
    ///
    /// They contribute to the noise floors and to the choice between causes. Keep back a log that
    /// is to judge the answer.
    #[arg(long, value_name = "LOG", num_args = 1..)]
    pub held_out: Vec<PathBuf>,
    /// The bench as described.
    #[command(flatten)]
    pub bench: BenchOptions,
    /// Folder for diagnosis.json, extended-bench.toml and report.html.
    #[arg(long, default_value = "out/diagnosis", value_name = "DIR")]
    pub out: PathBuf,
    /// Print the diagnosis as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
pub fn run(args: &DiagnoseArgs) -> Result<(), CliError> {
    let bench = args.bench.open()?;
    let logs = read(&args.logs, &bench)?;
    let held_out = read(&args.held_out, &bench)?;
    let bar = progress::bar(args.json, progress::PERCENT);
    let shown = bar.clone();
    let show_progress = move |share: f64, words: &str| {
        shown.set_position((100.0 * share) as u64);
        shown.set_message(words.to_owned());
    };
    let result =
        diagnose(&bench, &logs, &held_out, &Options { progress: Some(&show_progress), ..Options::default() });
    bar.finish_and_clear();
    let mut diagnosis = result?;
    write(&mut diagnosis, &args.out)?;
    if args.json {
        print_line!("{}", json(&diagnosis)?);
    } else {
        print_line!("{}", text::text(&diagnosis).trim_end());
        print_line!("\nreport: {}", args.out.join("report.html").display());
    }
    Ok(())
}

/// Reads logs with all their defects; the checks report them.
pub(super) fn read(paths: &[PathBuf], bench: &Bench) -> Result<Vec<MeasuredLog>, CliError> {
    let format = bench.log_format();
    paths.iter().map(|path| Ok(MeasuredLog::read_as_found(path, &format)?)).collect()
}

fn json(diagnosis: &Diagnosis) -> Result<String, CliError> {
    serde_json::to_string_pretty(diagnosis).map_err(|e| CliError::Work(e.to_string()))
}

/// Writes all files. Everything is rendered before the first file is written.
fn write(diagnosis: &mut Diagnosis, out: &Path) -> Result<(), CliError> {
    let bench_path = out.join("extended-bench.toml");
    let extended = match &diagnosis.extended {
        Some(bench) => Some(bench.to_toml().map_err(|e| CliError::Work(format!("extended bench: {e}")))?),
        None => None,
    };
    diagnosis.extended_bench = extended.as_ref().map(|_| bench_path.display().to_string());
    let page = report::page(diagnosis).map_err(CliError::Work)?.render();
    let text = format!("{}\n", json(diagnosis)?);
    let files = [
        (bench_path, extended),
        (out.join("diagnosis.json"), Some(text)),
        (out.join("report.html"), Some(page)),
    ];
    for (path, content) in files {
        if let Some(content) = content {
            atomic::write(&path, content.as_bytes()).map_err(|e| CliError::output(&path, &e))?;
        }
    }
    Ok(())
}

impl From<DiagnosisError> for CliError {
    fn from(error: DiagnosisError) -> Self {
        match error {
            DiagnosisError::Log(e) => Self::Input(e.to_string()),
            DiagnosisError::NoLog => Self::Input(error.to_string()),
            DiagnosisError::Respond(e) => Self::Work(e.to_string()),
        }
    }
}
