//! `model-quant completions` and `man`: the command line for a shell and as manual pages.

use crate::cli::error::CliError;
use crate::cli::output::print;
use crate::data::file_io::WriteError;
use clap::Command;
use clap_complete::{Shell, generate};
use std::path::{Path, PathBuf};

/// Print the completions of the command line for a shell
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  model-quant completions bash > \
                        ~/.local/share/bash-completion/completions/model-quant")]
pub(crate) struct CompletionsArguments {
    /// The shell
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// Write the manual pages, one for each command
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  model-quant man --out ~/.local/share/man/man1")]
pub(crate) struct ManualArguments {
    /// Folder for the pages
    #[arg(long, default_value = "out/man", value_name = "DIR")]
    out: PathBuf,
}

/// Prints the completions of `program`.
pub(crate) fn completions(arguments: &CompletionsArguments, mut program: Command) -> Result<(), CliError> {
    let name = program.get_name().to_owned();
    let mut text = Vec::new();
    generate(arguments.shell, &mut program, name, &mut text);
    print(format_args!("{}", String::from_utf8_lossy(&text).trim_end()))
}

/// Writes the manual pages of `program`.
pub(crate) fn manual(arguments: &ManualArguments, program: Command) -> Result<(), CliError> {
    let folder: &Path = &arguments.out;
    std::fs::create_dir_all(folder)
        .and_then(|()| clap_mangen::generate_to(program, folder))
        .map_err(|source| WriteError { path: folder.to_path_buf(), source }.into())
}
