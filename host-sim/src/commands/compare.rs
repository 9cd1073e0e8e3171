//! `host-sim compare`: compares stored runs with each other.

use crate::cli::error::CliError;
use crate::cli::output::{self, Files};
use crate::compare::{self, report};
use clap::Args;
use report::{columns, figures, texts};
use std::path::PathBuf;

/// Arguments of `host-sim compare`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim compare out/before out/after\n  \
    host-sim compare out/run out/wide out/plastic --out out/comparison\n\n\
    Logs of different times are compared by linear interpolation. Wall times are left out.")]
pub struct CompareArgs {
    /// Folders of `host-sim run`; the first is the reference.
    #[arg(required = true, num_args = 2.., value_name = "RUN")]
    pub runs: Vec<PathBuf>,
    /// Folder for comparison.json and report.html; without it nothing is written.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the comparison as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
pub fn run(args: &CompareArgs) -> Result<(), CliError> {
    if let Some(folder) = &args.out {
        let is_run =
            |run: &&PathBuf| folder.canonicalize().is_ok_and(|out| run.canonicalize().ok() == Some(out));
        if let Some(run) = args.runs.iter().find(is_run) {
            let run = run.display();
            return Err(CliError::Input(format!(
                "--out: found {run}, one of the runs; expected another folder"
            )));
        }
        output::check_folder(folder)?;
    }
    let runs = args.runs.iter().map(|path| compare::read(path)).collect::<Result<Vec<_>, _>>()?;
    let comparison = compare::compare(&args.runs, &runs);
    if comparison.figures.is_empty() && comparison.columns.is_empty() {
        let text = "RUN: found runs without a common figure or column; expected runs of one plant";
        return Err(CliError::Input(text.into()));
    }
    let json = output::result_json(&comparison)?;
    if let Some(folder) = &args.out {
        let mut files = Files::new(folder);
        files.add("comparison.json", &format!("{json}\n"))?;
        files.add_page("report.html", report::page(&comparison, &runs).map_err(CliError::Work)?)?;
        files.publish()?;
    }
    if args.json {
        print_result!("{json}");
        return Ok(());
    }
    for (header, rows) in [figures(&comparison), texts(&comparison), columns(&comparison)] {
        if !rows.is_empty() {
            print_line!("{}", ::report::text_table(header, rows, 1));
        }
    }
    if !comparison.missing.is_empty() {
        print_line!("not in all runs: {}", comparison.missing.join(", "));
    }
    if let Some(folder) = &args.out {
        print_line!("\nreport: {}", folder.join("report.html").display());
    }
    Ok(())
}
