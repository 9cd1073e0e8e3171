//! `host-sim diagnose`: finds what a simulation gets wrong in measured logs, names the cause,
//! measures the gain.

use crate::cli::error::CliError;
use crate::cli::options::BenchOptions;
use crate::cli::output::{self, Files};
use crate::cli::progress;
use crate::diagnose::{report, text};
use bench::{Bench, MeasuredLog};
use clap::{Args, ValueEnum};
use diagnosis::{Diagnosis, DiagnosisError, Options, Verdict, diagnose};
use std::path::{Path, PathBuf};

/// File name of the extended bench.
const EXTENDED_BENCH: &str = "extended-bench.toml";

/// Arguments of `host-sim diagnose`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim diagnose log.csv\n  \
    host-sim diagnose monday.csv tuesday.csv --held-out friday.csv --bench my-bench.toml --out \
    out/diagnosis\n  \
    host-sim diagnose stroke*.csv --bench examples/seal-friction.toml --json\n  \
    host-sim diagnose log.csv --fail-on named,unknown --quiet\n\n\
    Without --fail-on any verdict exits 0.")]
pub struct DiagnoseArgs {
    /// Measured logs of one bench, in a format that `host-sim log info` reads.
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
    /// Exit with 1 if a cause is named, or if an error remains unknown; both with a comma. The
    /// results are written before.
    #[arg(long, value_name = "VERDICT", value_delimiter = ',')]
    pub fail_on: Vec<FailOn>,
    /// Print the diagnosis as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
pub fn run(args: &DiagnoseArgs) -> Result<(), CliError> {
    let bench = args.bench.open()?;
    output::check_folder(&args.out)?;
    let logs = read(&args.logs, &bench)?;
    let held_out = read(&args.held_out, &bench)?;
    let bar = progress::bar(progress::PERCENT);
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
        print_result!("{}", json(&diagnosis)?);
    } else {
        print_line!("{}", text::text(&diagnosis).trim_end());
        print_line!("\nreport: {}", args.out.join("report.html").display());
    }
    outcome(&args.fail_on, diagnosis.verdict)
}

/// Reads logs with all their defects; the checks report them.
pub(super) fn read(paths: &[PathBuf], bench: &Bench) -> Result<Vec<MeasuredLog>, CliError> {
    let format = bench.log_format();
    paths.iter().map(|path| Ok(MeasuredLog::read_as_found(path, &format)?)).collect()
}

fn json(diagnosis: &Diagnosis) -> Result<String, CliError> {
    output::result_json(diagnosis)
}

/// Writes all files.
fn write(diagnosis: &mut Diagnosis, out: &Path) -> Result<(), CliError> {
    let mut files = Files::new(out);
    files.leave_out(EXTENDED_BENCH);
    if let Some(bench) = &diagnosis.extended {
        let text = bench.to_toml().map_err(|e| CliError::Work(format!("extended bench: {e}")))?;
        files.add(EXTENDED_BENCH, &text)?;
        diagnosis.extended_bench = Some(out.join(EXTENDED_BENCH).display().to_string());
    }
    files.add("diagnosis.json", &format!("{}\n", json(diagnosis)?))?;
    files.add_page("report.html", report::page(diagnosis).map_err(CliError::Work)?)?;
    files.publish()
}

/// Verdict at which the command fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FailOn {
    /// A cause was named, or several that the logs cannot separate.
    Named,
    /// An error remains that no cause explains.
    Unknown,
}

impl FailOn {
    fn applies_to(self, verdict: Verdict) -> bool {
        match self {
            Self::Named => matches!(verdict, Verdict::Named | Verdict::Ambiguous | Verdict::Partial),
            Self::Unknown => matches!(verdict, Verdict::Unknown | Verdict::Partial),
        }
    }
}

/// Fails if one of `verdicts` applies.
fn outcome(fail_on: &[FailOn], verdict: Verdict) -> Result<(), CliError> {
    if !fail_on.iter().any(|f| f.applies_to(verdict)) {
        return Ok(());
    }
    Err(CliError::Work(format!("--fail-on: the verdict is `{}`", verdict.name())))
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
