//! `host-sim`: runs, records, diagnoses and validates the test bench.

use std::process::ExitCode;

fn main() -> ExitCode {
    host_sim::program::main()
}
