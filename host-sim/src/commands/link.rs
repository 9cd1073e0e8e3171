//! `host-sim link`: device info of a controller (identity, last start, counters), and the few
//! commands it takes.

use crate::cli::error::CliError;
use crate::cli::options::BenchOptions;
use crate::cli::output;
use crate::controller::Controller;
use crate::controller::choice::{self, ConnectionOptions, RemoteKind};
use crate::device::follow::follow;
use crate::device::info::DeviceInfo;
use crate::run::configuration::controller_configuration;
use bench::plants::transmission::Transmission;
use clap::Args;
use link::{Command, ContactSource, ControllerConfiguration};
use std::path::{Path, PathBuf};

/// Arguments of `host-sim link`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim link\n  \
    host-sim link --controller attached --port /dev/ttyUSB0 --json\n  \
    host-sim link --controller attached --port /dev/ttyUSB0 --configure --bench bench-b \
    --sample-period-us 300 --keep\n  \
    host-sim link --controller attached --port /dev/ttyUSB0 --sample --follow 60\n  \
    host-sim link --controller attached --probe --board feather-stm32f405\n\n\
    The emulated controller starts anew each time, loses its state at its end, and has no sensors. \
    `--json` prints the configuration in the form that --configuration takes.")]
pub struct LinkArgs {
    /// Controller to ask.
    #[arg(long, value_enum, default_value = "emulated", requires_if("attached", "way"))]
    pub controller: RemoteKind,
    /// Serial port of the attached controller.
    #[arg(long, value_name = "PATH", group = "way")]
    pub port: Option<PathBuf>,
    /// Its debug probe and key.
    #[command(flatten)]
    pub connection: ConnectionOptions,
    /// Image for the emulated controller; by default the one that `cargo xtask firmware` builds.
    #[arg(long, value_name = "FILE")]
    pub elf: Option<PathBuf>,
    /// Let a tripped controller estimate again.
    #[arg(long)]
    pub clear_trip: bool,
    /// End the run.
    #[arg(long)]
    pub stop: bool,
    /// Send the configuration of the bench below.
    #[arg(long)]
    pub configure: bool,
    /// Sample period for --configure, us. An STM32F405 with its own sensors needs 298 or more.
    #[arg(
        long,
        value_name = "US",
        default_value_t = 100,
        value_parser = clap::value_parser!(u32).range(50..=1_000),
        requires = "configure"
    )]
    pub sample_period_us: u32,
    /// Send the configuration in a file: JSON, as printed under `configuration`.
    #[arg(long, value_name = "FILE", conflicts_with = "configure")]
    pub configuration: Option<PathBuf>,
    /// Let the controller sample its own sensors from now on, until it is stopped or configured
    /// again.
    #[arg(long, conflicts_with_all = ["stop", "keep"])]
    pub sample: bool,
    /// Show the newest estimate, the counters, the tracked values and the newest raw sample of the
    /// controller's sensors, twice a second, for so many seconds.
    #[arg(long, value_name = "SECONDS")]
    pub follow: Option<u32>,
    /// Save the configuration over a loss of power; this ends the run.
    #[arg(long)]
    pub keep: bool,
    /// The bench for --configure.
    #[command(flatten)]
    pub bench: BenchOptions,
    /// Print as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
pub fn run(args: &LinkArgs) -> Result<(), CliError> {
    // The bench first: if it is wrong, no controller is opened.
    let configuration = match &args.configuration {
        Some(file) => Some(read(file)?),
        None => args.configure.then(|| configuration(&args.bench, args.sample_period_us)).transpose()?,
    };
    let elf = args.elf.as_deref();
    let mut controller = match args.controller {
        RemoteKind::Attached => choice::attached(elf, args.port.as_deref(), &args.connection)?,
        RemoteKind::Emulated => choice::emulated(elf, &args.connection)?,
    };
    if args.clear_trip {
        controller.order(Command::ClearTrip)?;
    }
    if let Some(configuration) = configuration {
        controller.configure(configuration)?;
    }
    if args.stop || args.keep {
        controller.order(Command::Stop)?;
    }
    if args.keep {
        controller.order(Command::Keep)?;
    }
    if args.sample {
        controller.order(Command::SampleYourself)?;
    }
    if let Some(seconds) = args.follow {
        follow(&mut controller, seconds, args.json)?;
    }
    let info = DeviceInfo::read(&mut controller)?;
    if args.json {
        print_result!("{}", output::json(&info.to_json())?);
    } else {
        info.print();
    }
    Ok(())
}

/// Reads a configuration file.
fn read(file: &Path) -> Result<ControllerConfiguration, CliError> {
    let wrong = |found: String| {
        CliError::Input(format!("{}: {found}; expected a controller's configuration as JSON", file.display()))
    };
    let text = std::fs::read_to_string(file).map_err(|error| wrong(error.to_string()))?;
    serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))
}

/// Returns the configuration of a bench, as `host-sim run` sends it.
fn configuration(options: &BenchOptions, sample_period_us: u32) -> Result<ControllerConfiguration, CliError> {
    let resolved = options.open_transmission()?.resolved();
    let plant = Transmission::new(&resolved, resolved.drive_profile(), resolved.load_profile());
    let rate_hz = 1e6 / f64::from(sample_period_us);
    controller_configuration(&plant, &resolved, rate_hz, ContactSource::default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_configuration_as_printed_is_read_back_and_anything_else_is_refused_with_its_place() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("configuration.json");
        let mut configuration = controller::configuration::BENCH_B;
        configuration.wiring.first_probe_centidegrees = -4_500;
        std::fs::write(&file, serde_json::to_string(&configuration).expect("JSON")).expect("written");
        assert_eq!(read(&file).expect("a configuration"), configuration);
        std::fs::write(&file, "{\n\"version\": 2\n}").expect("written");
        let error = read(&file).expect_err("no configuration");
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("line 3") && error.to_string().contains("bench"), "{error}");
    }
}
