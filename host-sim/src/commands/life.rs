//! `host-sim life`: clearance of the bearing over its life, and how the controller tracks it.

use crate::cli::error::CliError;
use crate::cli::options::{BenchOptions, bearing_material, thread_count};
use crate::cli::output::{self, Files};
use crate::life::{self, Settings, pictures, report};
use crate::run::arguments::ContactChoice;
use crate::sweep::table;
use bench::description::{LifeSection, TransmissionBench};
use bench::{BearingMaterial, Bench};
use clap::Args;
use std::path::PathBuf;

/// File of the bench at the end of its life.
const WORN_BENCH: &str = "worn-bench.toml";

/// Arguments of `host-sim life`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim life --bearing plastic\n  \
    host-sim life --bench my-bench.toml --cycles 1e6 --out out/life\n  \
    host-sim record --bench out/life/worn-bench.toml --cycles 5 --out worn.csv\n\n\
    Wear, temperature, water and film are in the sections [wear], [thermal], [film] and [life].")]
pub struct LifeArgs {
    /// Preset or description file of a planar transmission bench.
    #[arg(long, default_value = "bench-b", value_name = "NAME|FILE")]
    pub bench: String,
    /// Bearing material, with its modulus, restitution and friction.
    #[arg(long, value_name = "BEARING", value_parser = bearing_material())]
    pub bearing: Option<BearingMaterial>,
    /// Radial clearance of the new bearing in mm.
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub clearance_mm: Option<f64>,
    /// Load in kN, positive along +Y.
    #[arg(long, value_name = "KN", allow_negative_numbers = true)]
    pub load_kn: Option<f64>,
    /// Cycles of the life, in place of `life.cycles`.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub cycles: Option<f64>,
    /// Source of elastic force, damping and friction in the controller's estimate.
    #[arg(long, value_enum, default_value = "network")]
    pub contact: ContactChoice,
    /// Seed of the sensors' noise.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads; 0 uses one per core. The result does not depend on it.
    #[arg(long, default_value_t = 0, value_name = "N", value_parser = thread_count())]
    pub threads: usize,
    /// Folder for life.csv, profile.csv, tracked.csv, life.json, the pictures, report.html and
    /// worn-bench.toml.
    #[arg(long, default_value = "out/life", value_name = "DIR")]
    pub out: PathBuf,
    /// Print the result as JSON.
    #[arg(long)]
    pub json: bool,
}

impl LifeArgs {
    /// Opens the bench with the changes of the options.
    fn open(&self) -> Result<TransmissionBench, CliError> {
        let options = BenchOptions {
            bench: self.bench.clone(),
            bearing: self.bearing,
            clearance_mm: self.clearance_mm,
            load_kn: self.load_kn,
            cycles: None,
        };
        let mut bench = options.open_transmission()?;
        let Some(cycles) = self.cycles else { return Ok(bench) };
        let section = bench.life.take().unwrap_or_default();
        bench.life = Some(LifeSection { cycles, ..section });
        let name = format!("{} with the options given", self.bench);
        Ok(TransmissionBench::from_bench(Bench::from(bench).checked(&name)?, &self.bench)?)
    }
}

/// Runs the command.
pub fn run(args: &LifeArgs) -> Result<(), CliError> {
    let bench = args.open()?;
    output::check_folder(&args.out)?;
    let settings = Settings { contact: args.contact.into(), seed: args.seed, threads: args.threads };
    let result = life::simulate(&bench, settings)?;
    let pictures = pictures::draw(&result)?;
    let mut files = Files::new(&args.out);
    files.leave_out(WORN_BENCH);
    files.add("life.csv", &report::life_csv(&result)?)?;
    files.add("profile.csv", &report::profile_csv(&result))?;
    files.add("tracked.csv", &table::csv(&result.outcome.tracked)?)?;
    let text = files.add_result("life.json", &result.outcome)?;
    pictures.add_to(&mut files)?;
    let worn = life::worn_bench(&bench, &result.outcome);
    let is_written = worn.is_some();
    files.add_page("report.html", report::page(&result, &pictures, &bench, is_written))?;
    if let Some(worn) = worn {
        let text = Bench::from(worn).to_toml().map_err(|e| CliError::Work(format!("{WORN_BENCH}: {e}")))?;
        files.add(WORN_BENCH, &text)?;
    }
    files.publish()?;
    if args.json {
        print_result!("{text}");
    } else {
        for [name, value] in report::rows(&result) {
            print_line!("{name:<44} {value:>24}");
        }
        if !is_written {
            print_line!("\n{}", report::effect(&result.outcome, is_written));
        }
        print_line!("\nreport: {}", args.out.join("report.html").display());
    }
    Ok(())
}
