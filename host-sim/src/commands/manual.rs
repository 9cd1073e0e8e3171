//! `host-sim man`: manual pages, one for each command.

use crate::cli::error::CliError;
use crate::cli::output;
use clap::{Args, Command};
use std::path::PathBuf;

/// Arguments of `host-sim man`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim man --out ~/.local/share/man/man1\n  \
    host-sim man && man out/man/host-sim-diagnose.1")]
pub struct ManualArgs {
    /// Folder for the pages.
    #[arg(long, default_value = "out/man", value_name = "DIR")]
    pub out: PathBuf,
}

/// Writes the pages of `program`.
pub fn run(args: &ManualArgs, program: Command) -> Result<(), CliError> {
    output::check_folder(&args.out)?;
    let written =
        std::fs::create_dir_all(&args.out).and_then(|()| clap_mangen::generate_to(program, &args.out));
    written.map_err(|e| CliError::output(&args.out, &e))?;
    print_line!("manual pages: {}", args.out.display());
    Ok(())
}
