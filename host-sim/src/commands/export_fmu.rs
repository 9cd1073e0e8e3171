//! `host-sim export-fmu`: writes a functional mock-up unit for co-simulation programs.

use crate::cli::error::CliError;
use crate::cli::options::BenchOptions;
use crate::cli::output;
use crate::fmu::export::{self, Export};
use clap::{Args, ValueEnum};
use pintle_fmu::{Kind, Version};
use std::path::PathBuf;

/// Content of a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Unit {
    /// Force of the bearing on a journal that the other program moves.
    Contact,
    /// The whole transmission bench.
    Bench,
    /// A mechanism.
    Mechanism,
}

impl From<Unit> for Kind {
    fn from(unit: Unit) -> Self {
        match unit {
            Unit::Contact => Self::Contact,
            Unit::Bench => Self::Bench,
            Unit::Mechanism => Self::Mechanism,
        }
    }
}

/// Source of the contact forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum UnitForce {
    /// The analytic laws.
    Law,
    /// The quantised networks.
    QuantisedNet,
}

/// Arguments of `host-sim export-fmu`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim export-fmu bench --out bench.fmu\n  \
    host-sim export-fmu contact --bearing plastic --clearance-mm 1 --force quantised-net\n  \
    host-sim export-fmu mechanism --bench examples/four-bar.toml --fmi 3.0 --out four-bar.fmu\n\n\
    docs/fmi.md describes units, variables and the largest stable steps.")]
pub struct ExportFmuArgs {
    /// Content of the unit.
    #[arg(value_enum)]
    pub unit: Unit,
    /// The bench.
    #[command(flatten)]
    pub bench: BenchOptions,
    /// Version of the Functional Mock-up Interface.
    #[arg(long, default_value = "2.0", value_parser = ["2.0", "3.0"])]
    pub fmi: String,
    /// Source of the contact forces at the start; the parameter `use_networks` changes it.
    #[arg(long, value_enum, default_value = "law")]
    pub force: UnitForce,
    /// Model image in place of the shipped one of its material; may be repeated.
    #[arg(long, value_name = "FILE")]
    pub image: Vec<PathBuf>,
    /// Folder with linux64/pintle_fmu.so, win64/pintle_fmu.dll or both.
    #[arg(long, value_name = "DIR")]
    pub libraries: Option<PathBuf>,
    /// File of the unit; default: pintle-UNIT.fmu in out.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Print variables and platforms as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
pub fn run(args: &ExportFmuArgs) -> Result<(), CliError> {
    let kind = Kind::from(args.unit);
    let out = args.out.clone().unwrap_or_else(|| format!("out/pintle-{}.fmu", kind.name()).into());
    if out.is_dir() {
        return Err(CliError::Input(format!("--out: found the folder {}; expected a file", out.display())));
    }
    let export = Export {
        kind,
        version: if args.fmi == "3.0" { Version::Three } else { Version::Two },
        described_in: &args.bench.bench,
        has_networks: args.force == UnitForce::QuantisedNet,
        images: &args.image,
        libraries: args.libraries.as_deref(),
    };
    let exported = export::write(args.bench.open_any()?, &export, &out)?;
    if args.json {
        print_result!("{}", output::json(&exported)?);
    } else {
        print_line!("{exported}");
    }
    Ok(())
}
