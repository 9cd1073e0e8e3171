//! `host-sim completions`: completions of the command line for a shell.

use crate::cli::error::CliError;
use clap::{Args, Command};
use clap_complete::{Shell, generate};

/// Arguments of `host-sim completions`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  \
    host-sim completions bash > ~/.local/share/bash-completion/completions/host-sim\n  \
    host-sim completions zsh > ~/.zfunc/_host-sim\n  \
    host-sim completions fish > ~/.config/fish/completions/host-sim.fish")]
pub struct CompletionsArgs {
    /// The shell.
    #[arg(value_name = "SHELL")]
    pub shell: Shell,
}

/// Prints the completions of `program`.
pub fn run(args: &CompletionsArgs, mut program: Command) -> Result<(), CliError> {
    let name = program.get_name().to_owned();
    let mut text = Vec::new();
    generate(args.shell, &mut program, name, &mut text);
    print_result!("{}", String::from_utf8_lossy(&text).trim_end());
    Ok(())
}
