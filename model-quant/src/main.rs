//! `model-quant`: data sets, training, quantisation and verification on the command line.
//!
//! Exit status: 0 done; 1 the work failed or a check found a difference; 2 the input is wrong.

mod cli;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    match cli::run(&cli::Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}
