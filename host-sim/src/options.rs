//! Options that several commands share: which bench, and what to change on it.

use crate::error::CliError;
use bench::slider_crank_description::SliderCrankBench;
use bench::{BearingMaterial, Bench};
use clap::{Args, ValueEnum};

/// Bearing with trained networks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BearingName {
    /// Babbitt alloy.
    Babbitt,
    /// Engineering plastic alloy.
    Plastic,
}

impl From<BearingName> for BearingMaterial {
    fn from(name: BearingName) -> Self {
        match name {
            BearingName::Babbitt => Self::Babbitt,
            BearingName::Plastic => Self::Plastic,
        }
    }
}

/// The bench and what differs from its description.
#[derive(Args, Clone, Debug)]
pub struct BenchOptions {
    /// Preset (bench-b, bench-a, friction-rig, friction-rig-babbitt, friction-rig-plastic, slider-crank) or bench
    /// description file.
    #[arg(long, default_value = "bench-b", value_name = "NAME|FILE")]
    pub bench: String,
    /// Bearing material, with its modulus, restitution and friction.
    #[arg(long, value_enum)]
    pub bearing: Option<BearingName>,
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
    /// Refuses the changes where the bench has nothing of the kind.
    pub fn unchanged(&self, plant: &str) -> Result<(), CliError> {
        let given = self.bearing.is_some() || self.clearance_mm.is_some() || self.cycles.is_some();
        if given || self.load_kn.is_some() {
            return Err(CliError::Input(format!(
                "{}: --bearing, --clearance-mm, --load-kn and --cycles belong to a transmission bench; found a {plant}",
                self.bench
            )));
        }
        Ok(())
    }

    /// Opens the bench and applies the changes; the result has been checked as a whole.
    pub fn open(&self) -> Result<Bench, CliError> {
        if SliderCrankBench::open(&self.bench)?.is_some() {
            return Err(CliError::Input(format!(
                "{}: found plant `slider-crank`, which only `run` takes; expected `transmission-bench` or `friction-rig`",
                self.bench
            )));
        }
        let mut bench = Bench::open(&self.bench)?;
        match &mut bench {
            Bench::Transmission(t) => {
                if let Some(name) = self.bearing {
                    t.set_material(name.into());
                }
                if let Some(clearance) = self.clearance_mm {
                    t.set_radial_clearance(clearance * 1e-3);
                }
                if let Some(load) = self.load_kn {
                    t.load.force_n = load * 1e3;
                }
                if let Some(cycles) = self.cycles {
                    t.drive.cycles = cycles;
                }
            }
            Bench::FrictionRig(rig) => {
                if self.bearing.is_some() || self.clearance_mm.is_some() || self.cycles.is_some() {
                    return Err(CliError::Input(format!(
                        "{}: --bearing, --clearance-mm and --cycles belong to a transmission bench; found a friction rig",
                        self.bench
                    )));
                }
                if let Some(load) = self.load_kn {
                    rig.load.force_n = load * 1e3;
                }
            }
        }
        // A changed number may be out of range: the description's own check says so, with the field's name.
        let text = bench.to_toml().map_err(|e| CliError::Work(format!("{}: {e}", self.bench)))?;
        Ok(Bench::parse(&format!("{} with the options given", self.bench), &text)?)
    }
}
