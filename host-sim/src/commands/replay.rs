//! `host-sim replay`: replays a recorded link session or a measured log on a controller.

use crate::cli::error::CliError;
use crate::cli::options::BenchOptions;
use crate::cli::output::{self, Files};
use crate::controller::Recording;
use crate::controller::choice::{self, ConnectionOptions, ControllerKind};
use crate::controller::recording::MAGIC;
use crate::impact_text;
use crate::replay::{Difference, Replayed, log, replay};
use crate::run::configuration::lockstep_configuration;
use crate::run::estimates;
use crate::run::exchange::{ExchangeResult, exchange};
use crate::run::impacts::{self, ImpactTotals};
use bench::MeasuredLog;
use bench::description::TransmissionBench;
use bench::plants::transmission::Transmission;
use clap::Args;
use controller::flags::SENSOR_FAULT;
use inference::Flags;
use link::{Command, ContactSource};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Maximum number of differences or impacts on the terminal; --json prints all differences.
const SHOWN: usize = 20;

/// Arguments of `host-sim replay`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  host-sim run --record link.rec\n  \
    host-sim replay link.rec --controller emulated\n  \
    host-sim replay link.rec --controller attached --port /dev/ttyUSB0 --json\n  \
    host-sim replay log.csv --bench my-bench.toml --out out/replay\n\n\
    A recording: exits with 0 if every answer equals the recorded one to the bit, else with 1.\n\
    A log: computes the estimates from journal_y_m, journal_z_m, shaft_angle_rad and load_force_n at 50 to \
    1000 us between samples.")]
pub struct ReplayArgs {
    /// A recording of `host-sim run --record`, or a measured log.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// The controller.
    #[arg(long, value_enum, default_value = "native", requires_if("attached", "way"))]
    pub controller: ControllerKind,
    /// Serial port of the attached controller.
    #[arg(long, value_name = "PATH", group = "way")]
    pub port: Option<PathBuf>,
    /// Its debug probe and key.
    #[command(flatten)]
    pub connection: ConnectionOptions,
    /// Image for the emulated controller; by default the one that `cargo xtask firmware` builds.
    #[arg(long, value_name = "FILE")]
    pub elf: Option<PathBuf>,
    /// The bench of a log; a recording contains its configuration.
    #[command(flatten)]
    pub bench: BenchOptions,
    /// Folder for estimates.csv and estimated_impacts.csv; for a recording they are written only
    /// with this option.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the outcome as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
pub fn run(args: &ReplayArgs) -> Result<(), CliError> {
    let bytes = std::fs::read(&args.file)
        .map_err(|error| CliError::Input(format!("{}: {error}", args.file.display())))?;
    if !bytes.starts_with(&MAGIC) {
        return run_log(args);
    }
    let wrong = |error: &dyn std::fmt::Display| CliError::Input(format!("{}: {error}", args.file.display()));
    let recording = Recording::from_bytes(&bytes).map_err(|error| wrong(&error))?;
    let mut controller =
        choice::open(args.controller, args.elf.as_deref(), args.port.as_deref(), &args.connection)?;
    let name = controller.name();
    let replayed = replay(&recording, &mut *controller)?;
    if let Some(out) = &args.out {
        let mut files = Files::new(out);
        files.add(estimates::FILE_NAME, &estimates::to_csv(&replayed.estimates))?;
        files.add(impacts::FILE_NAME, &impacts::to_csv(&replayed.impacts))?;
        files.publish()?;
    }
    print_recording(args, name, &recording, &replayed)?;
    match replayed.differences.len() {
        0 => Ok(()),
        count => Err(CliError::Work(format!(
            "{}: {count} differences on the {name} controller; expected none",
            args.file.display()
        ))),
    }
}

fn print_recording(
    args: &ReplayArgs,
    name: &str,
    recording: &Recording,
    replayed: &Replayed,
) -> Result<(), CliError> {
    let differences = &replayed.differences;
    if args.json {
        print_result!(
            "{}",
            output::json(&json!({
                "file": args.file.display().to_string(),
                "recorded_build": recording.build_id.as_str(),
                "controller": name,
                "frames": recording.frames.len(),
                "samples": replayed.samples,
                "commands": replayed.commands,
                "impacts": replayed.impacts.len(),
                "differences": differences,
            }))?
        );
        return Ok(());
    }
    print_line!(
        "{}: {} samples, {} commands and {} impacts on the {name} controller, {} differences",
        args.file.display(),
        replayed.samples,
        replayed.commands,
        replayed.impacts.len(),
        differences.len()
    );
    for Difference { sequence, field, recorded, replayed } in differences.iter().take(SHOWN) {
        let at = sequence.map_or_else(|| "-".into(), |sequence| sequence.to_string());
        print_line!("{at:>10}  {field:<24} recorded {recorded}, replayed {replayed}");
    }
    if differences.len() > SHOWN {
        print_line!("and {} more; --json lists all", differences.len() - SHOWN);
    }
    Ok(())
}

/// Folder of the table by default.
const OUT: &str = "out/replay";

/// Replays a measured log.
fn run_log(args: &ReplayArgs) -> Result<(), CliError> {
    let bench = args.bench.open()?;
    let measured = MeasuredLog::read(&args.file, &bench.log_format())?;
    let resolved = TransmissionBench::from_bench(bench.resolved(), &args.bench.bench)?;
    let period_s = log::period_s(&measured)?;
    let frames = log::frames(&measured, period_s)?;
    let plant = Transmission::new(&resolved, resolved.drive_profile(), resolved.load_profile());
    let rate_hz = 1.0 / period_s;
    let configuration = lockstep_configuration(&plant, &resolved, rate_hz, ContactSource::default())?;
    let mut controller =
        choice::open(args.controller, args.elf.as_deref(), args.port.as_deref(), &args.connection)?;
    controller.order(Command::Configure(configuration))?;
    let exchanged = exchange(controller, &frames)?;
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from(OUT));
    let mut files = Files::new(&out);
    files.add(estimates::FILE_NAME, &estimates::to_csv(&exchanged.estimates))?;
    files.add(impacts::FILE_NAME, &impacts::to_csv(&exchanged.impacts))?;
    files.publish()?;
    print_log(args, &exchanged, rate_hz, &out.join(estimates::FILE_NAME))
}

fn print_log(
    args: &ReplayArgs,
    exchanged: &ExchangeResult,
    rate_hz: f64,
    table: &Path,
) -> Result<(), CliError> {
    let peak = exchanged.estimates.iter().map(|e| e.normal_force_n).fold(0.0, f32::max);
    let flagged = |flags: Flags| {
        exchanged.estimates.iter().filter(|e| Flags::from_bits(e.flags).intersects(flags)).count()
    };
    let (outside, suspect) = (flagged(Flags::OUTSIDE_TRAINING), flagged(SENSOR_FAULT));
    if args.json {
        print_result!(
            "{}",
            output::json(&json!({
                "log": args.file.display().to_string(),
                "controller": exchanged.controller,
                "samples": exchanged.estimates.len(),
                "sample_rate_hz": rate_hz,
                "peak_normal_force_n": peak,
                "outside_training": outside,
                "suspect": suspect,
                "impacts": ImpactTotals::new(exchanged),
                "counters": exchanged.counters,
                "estimates": table.display().to_string(),
            }))?
        );
        return Ok(());
    }
    print_line!(
        "{}: {} samples at {rate_hz:.0} Hz on the {} controller",
        args.file.display(),
        exchanged.estimates.len(),
        exchanged.controller
    );
    print_line!(
        "largest normal force {peak:.0} N; outside the training range {outside}, suspect {suspect} samples"
    );
    let totals = ImpactTotals::new(exchanged);
    print_line!("impacts: {}; lost records {}", totals.records, totals.lost);
    for record in exchanged.impacts.iter().take(SHOWN) {
        print_line!("  {}", impact_text::line(record));
    }
    if exchanged.impacts.len() > SHOWN {
        print_line!("  and {} more in {}", exchanged.impacts.len() - SHOWN, impacts::FILE_NAME);
    }
    print_line!("estimates: {}", table.display());
    Ok(())
}
