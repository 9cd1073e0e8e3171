//! Options that several commands share: the bench and changes to it.

use crate::cli::error::CliError;
use bench::description::TransmissionBench;
use bench::{BearingMaterial, Bench, PRESETS};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

/// Parser of a bearing material's name.
pub fn bearing_material() -> impl TypedValueParser<Value = BearingMaterial> {
    PossibleValuesParser::new(BearingMaterial::ALL.map(BearingMaterial::name))
        .try_map(|name| BearingMaterial::from_name(&name).ok_or("expected the name of a bearing material"))
}

/// Maximum number of threads.
const MAX_THREADS: i64 = 1024;

/// Parser of a number of threads, 0 to [`MAX_THREADS`].
pub(crate) fn thread_count() -> impl TypedValueParser<Value = usize> {
    clap::value_parser!(u16).range(..=MAX_THREADS).map(usize::from)
}

/// Help of `--bench`.
fn bench_help() -> String {
    format!(
        "Preset ({}) or bench description file",
        PRESETS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
    )
}

/// The bench and changes to its description.
#[derive(Args, Clone, Debug)]
pub struct BenchOptions {
    /// Preset or bench description file.
    #[arg(long, default_value = "bench-b", value_name = "NAME|FILE", help = bench_help())]
    pub bench: String,
    /// Bearing material, with its modulus, restitution and friction.
    #[arg(long, value_name = "BEARING", value_parser = bearing_material())]
    pub bearing: Option<BearingMaterial>,
    /// Radial clearance in mm.
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub clearance_mm: Option<f64>,
    /// Load in kN, positive along +Y.
    #[arg(long, value_name = "KN", allow_negative_numbers = true)]
    pub load_kn: Option<f64>,
    /// Cycles of the drive.
    #[arg(long, value_name = "N")]
    pub cycles: Option<u32>,
}

impl BenchOptions {
    /// Refuses the changes that a plant does not have.
    pub(crate) fn check_changes(&self, bench: &Bench) -> Result<(), CliError> {
        let (load, transmission) = ("a plant with a load", "`transmission-bench`");
        let (has_load, is_transmission) = (bench.load().is_some(), bench.transmission().is_some());
        let changes = [
            ("--load-kn", self.load_kn.is_some() && !has_load, load),
            ("--bearing", self.bearing.is_some() && !is_transmission, transmission),
            ("--clearance-mm", self.clearance_mm.is_some() && !is_transmission, transmission),
            ("--cycles", self.cycles.is_some() && !is_transmission, transmission),
        ];
        match changes.into_iter().find(|(_, is_refused, _)| *is_refused) {
            Some((option, _, expected)) => Err(CliError::Input(format!(
                "{}: {option}: found plant `{}`; expected {expected}",
                self.bench,
                bench.plant_name()
            ))),
            None => Ok(()),
        }
    }

    /// Opens the bench of a plant with a log, applies the changes and checks the result.
    pub fn open(&self) -> Result<Bench, CliError> {
        let bench = self.open_any()?;
        if bench.logged().is_none() {
            let expected = match bench {
                Bench::Mechanism(_) => "a mechanism with `[[measured]]`, or another plant with a log",
                _ => "a plant with a log",
            };
            return Err(CliError::Input(format!(
                "{}: found plant `{}`, which only `run` takes; expected {expected}",
                self.bench,
                bench.plant_name()
            )));
        }
        Ok(bench)
    }

    /// Opens the bench of any plant, applies the changes and checks the result.
    pub(crate) fn open_any(&self) -> Result<Bench, CliError> {
        let mut bench = Bench::open(&self.bench)?;
        self.check_changes(&bench)?;
        if let (Some(load_kn), Some(load)) = (self.load_kn, bench.load_mut()) {
            load.force_n = load_kn * 1e3;
        }
        if let Some(cycles) = self.cycles {
            bench.set_cycles(cycles);
        }
        if let Some(transmission) = bench.transmission_mut() {
            if let Some(material) = self.bearing {
                transmission.set_material(material);
            }
            if let Some(clearance_mm) = self.clearance_mm {
                transmission.set_radial_clearance(clearance_mm * 1e-3);
            }
        }
        // A changed number may be out of range. The check of the description reports it with the
        // field's name.
        Ok(bench.checked(&format!("{} with the options given", self.bench))?)
    }

    /// Opens the bench as [`Self::open`] does, and refuses every plant without a controller.
    pub(crate) fn open_transmission(&self) -> Result<TransmissionBench, CliError> {
        Ok(TransmissionBench::from_bench(self.open()?, &self.bench)?)
    }
}
