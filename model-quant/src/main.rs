//! Command-line program `model-quant`; [`model_quant::cli`] holds the commands.

use std::process::ExitCode;

fn main() -> ExitCode {
    model_quant::cli::main()
}
