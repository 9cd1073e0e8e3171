//! Options of `host-sim run`.

use super::exchange::OnRestart;
use super::force::ForceSource;
use crate::cli::error::CliError;
use crate::cli::options::BenchOptions;
use crate::controller::choice::ConnectionOptions;
use crate::fmu::plant_unit::PlantOptions;
use crate::serve::options::ServeOptions;
use clap::{ArgGroup, Args, Parser, ValueEnum};
use link::ContactSource;
use std::path::PathBuf;

/// Transport to the estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ControllerChoice {
    /// No estimator.
    None,
    /// The firmware's estimator in this process.
    Native,
    /// The firmware on the emulated controller, in lockstep. It also runs natively, and the two are
    /// compared to the bit.
    Emulated,
    /// A board on a serial port or at a debug probe, in lockstep. The estimator also runs natively,
    /// and the two are compared to the bit.
    Attached,
}

/// Source of the contact in the estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ContactChoice {
    /// The networks of the loaded model image.
    Network,
    /// The analytic law.
    Law,
}

impl From<ContactChoice> for ContactSource {
    fn from(choice: ContactChoice) -> Self {
        match choice {
            ContactChoice::Network => Self::Network,
            ContactChoice::Law => Self::Law,
        }
    }
}

/// Arguments of `host-sim run`.
#[derive(Args, Clone, Debug)]
#[command(group(ArgGroup::new("live").args(["watch", "serve"]).multiple(true)))]
#[command(after_help = "Examples:\n  host-sim run\n  \
    host-sim run --force law --bearing plastic --clearance-mm 1 --load-kn -5\n  \
    host-sim run --controller emulated --json\n  \
    host-sim run --controller emulated --watch --watch-speed 0.2\n  \
    host-sim run --cycles 20 --serve\n  \
    host-sim run --serve 127.0.0.1:0 --watch-speed 0.1 --serve-for 60\n  \
    HOST_SIM_SERVE_TOKEN=$(openssl rand -hex 16) host-sim run --serve 0.0.0.0:8750\n  \
    host-sim run --plant-fmu shaft.fmu --plant-output journal_y_m=shaft.y\n  \
    host-sim run --controller attached --port /dev/ttyUSB0 --on-restart continue --record out/run/link.rec")]
pub struct RunArgs {
    /// The bench.
    #[command(flatten)]
    pub bench: BenchOptions,
    /// Source of the bearing force; default: quantised-net. On a mechanism that of the contacts
    /// with a `network`, law if there is none.
    #[arg(long, value_enum)]
    pub force: Option<ForceSource>,
    /// Controller that runs the estimator.
    #[arg(long, value_enum, default_value = "native", requires_if("attached", "way"))]
    pub controller: ControllerChoice,
    /// Source of elastic force, damping and friction in the estimate.
    #[arg(long, value_enum, default_value = "network")]
    pub contact: ContactChoice,
    /// Communication step of the networks and of --plant-fmu in microseconds: the force is held
    /// constant over it.
    #[arg(long, default_value_t = 10.0, value_name = "US", allow_negative_numbers = true)]
    pub step_us: f64,
    /// Seed of the sensors' noise.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Share of the readings that do not reach the controller, per channel. Noise, delay,
    /// bandwidth, resolution, offset, drift and limits are in the bench's description under
    /// `[sensors]`.
    #[arg(long, default_value_t = 0.0, value_name = "SHARE", allow_negative_numbers = true)]
    pub dropout_share: f64,
    /// Number of readings lost in a row.
    #[arg(long, default_value_t = 1.0, value_name = "N", allow_negative_numbers = true)]
    pub dropout_samples: f64,
    /// Firmware for the emulated controller.
    #[arg(long, value_name = "FILE")]
    pub elf: Option<PathBuf>,
    /// Serial port of the attached controller.
    #[arg(long, value_name = "PATH", group = "way")]
    pub port: Option<PathBuf>,
    /// Its debug probe and key.
    #[command(flatten)]
    pub connection: ConnectionOptions,
    /// Reaction to a restart of the controller in the middle of the run; the emulator ends when it
    /// restarts.
    #[arg(long, value_enum, default_value = "stop")]
    pub on_restart: OnRestart,
    /// File for every frame exchanged with the controller; `host-sim replay` replays it.
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Draw force, orbit and flags in the terminal while the estimator runs, at the bench's own
    /// pace; q closes the view.
    #[arg(long, conflicts_with = "json")]
    pub watch: bool,
    /// Simulated seconds per second of the live views, in the terminal and in browsers.
    #[arg(
        long,
        default_value_t = 1.0,
        value_name = "FACTOR",
        requires = "live",
        allow_negative_numbers = true
    )]
    pub watch_speed: f64,
    /// Server of the live view in browsers.
    #[command(flatten)]
    pub serve: ServeOptions,
    /// Plant of another program.
    #[command(flatten)]
    pub plant: PlantOptions,
    /// Folder for log.csv, estimates.csv, impacts.csv, estimated_impacts.csv, run.json and
    /// report.html; of three or more cycles cycles.csv; on a bench in two planes tilt.csv.
    #[arg(long, default_value = "out/run", value_name = "DIR")]
    pub out: PathBuf,
    /// Print the figures as JSON.
    #[arg(long)]
    pub json: bool,
}

#[derive(Parser)]
struct Defaults {
    #[command(flatten)]
    args: RunArgs,
}

impl RunArgs {
    /// The main job: every option at its default.
    pub(crate) fn default_job() -> Self {
        Defaults::parse_from(["host-sim"]).args
    }

    /// Source of the bearing force of a bench with networks.
    pub(crate) fn force(&self) -> ForceSource {
        self.force.unwrap_or(ForceSource::QuantisedNet)
    }

    /// Refuses the options that have no effect on a plant without a controller, which has a
    /// communication step only with networks.
    pub(crate) fn check_uncontrolled(&self, plant: &str, has_networks: bool) -> Result<(), CliError> {
        let own = Self::default_job();
        let with_controller = "`transmission-bench`, which has a controller";
        let changed = [
            ("--controller", self.controller != own.controller, with_controller),
            ("--contact", self.contact != own.contact, with_controller),
            ("--seed", self.seed != own.seed, "`record`, which reads the sensors"),
            ("--dropout-share", self.dropout_share != own.dropout_share, with_controller),
            ("--dropout-samples", self.dropout_samples != own.dropout_samples, with_controller),
            ("--elf", self.elf.is_some(), with_controller),
            ("--on-restart", self.on_restart != own.on_restart, with_controller),
            ("--record", self.record.is_some(), with_controller),
            ("--watch", self.watch, with_controller),
            ("--serve", self.serve.serve.is_some(), with_controller),
            ("--plant-fmu", self.plant.plant_fmu.is_some(), with_controller),
            ("--step-us", !has_networks && self.step_us != own.step_us, "a contact with networks"),
        ];
        match changed.into_iter().find(|(_, is_changed, _)| *is_changed) {
            Some((option, _, expected)) => {
                Err(CliError::Input(format!("{option}: found plant `{plant}`; expected {expected}")))
            }
            None => Ok(()),
        }
    }
}

/// Range of the communication step, s.
const STEP_RANGE_S: (f64, f64) = (1e-7, 1e-3);

/// Converts a communication step from microseconds to s and checks its range.
pub(crate) fn communication_step_s(step_us: f64) -> Result<f64, CliError> {
    let step_s = step_us * 1e-6;
    if (STEP_RANGE_S.0..=STEP_RANGE_S.1).contains(&step_s) {
        Ok(step_s)
    } else {
        Err(CliError::Input(format!("--step-us: found {step_us}; expected 0.1 to 1000")))
    }
}
