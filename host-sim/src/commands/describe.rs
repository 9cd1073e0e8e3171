//! `host-sim describe`: writes a commented description template for a log.

use crate::cli::error::CliError;
use crate::cli::output;
use bench::atomic;
use bench::log::RawLog;
use bench::template::{Template, TemplatePlant, template};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::PathBuf;

/// Arguments of `host-sim describe`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim describe log.csv\n  \
    host-sim describe log.csv --plant linear-axis --out my-bench.toml\n  \
    host-sim describe log.mat --json\n\n\
    Separator, header and decimal comma are detected. Fill in every \"?\" of the template; then\n\
    `host-sim check log.csv --bench my-bench.toml` judges log and description.\n\
    docs/description.md lists every field.")]
pub struct DescribeArgs {
    /// Measured log, in a format that `host-sim log info` reads.
    #[arg(value_name = "LOG")]
    pub log: PathBuf,
    /// Plant; by default the header decides.
    #[arg(long, value_name = "PLANT", value_parser = plants())]
    pub plant: Option<TemplatePlant>,
    /// New file for the template; without it the template is printed.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Print the template and the columns of the log as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Parser of a plant's name.
fn plants() -> impl TypedValueParser<Value = TemplatePlant> {
    PossibleValuesParser::new(TemplatePlant::ALL.iter().map(|(name, _)| *name)).try_map(|name| {
        let known = TemplatePlant::ALL.iter().find(|(known, _)| *known == name);
        known.map(|(_, plant)| *plant).ok_or("expected the name of a plant")
    })
}

#[derive(Serialize, JsonSchema)]
pub(crate) struct Described {
    #[serde(flatten)]
    template: Template,
    /// File that was written.
    description: Option<String>,
}

/// Runs the command.
pub fn run(args: &DescribeArgs) -> Result<(), CliError> {
    // A description that has been filled in must not be lost.
    if let Some(path) = args.out.as_ref().filter(|path| path.exists()) {
        return Err(CliError::Input(format!("--out: {} exists; expected a new file", path.display())));
    }
    let template = template(&RawLog::read(&args.log)?, args.plant)?;
    if let Some(path) = &args.out {
        atomic::write(path, template.toml.as_bytes()).map_err(|e| CliError::output(path, &e))?;
    }
    let description = args.out.as_ref().map(|path| path.display().to_string());
    match &description {
        _ if args.json => print_result!("{}", output::json(&Described { template, description })?),
        None => print_result!("{}", template.toml.trim_end()),
        Some(path) => {
            print_line!("{path}: to fill in:");
            template.to_fill_in.iter().for_each(|name| print_line!("  {name}"));
        }
    }
    Ok(())
}
