//! `host-sim replay`: a recorded conversation, or a measured log, through a controller.

use super::end::{self, End, ProbeOptions};
use super::{output, replay_log};
use crate::controller::recording::MAGIC;
use crate::controller::replay::{Difference, replay};
use crate::controller::{Recording, replay::Replayed};
use crate::error::CliError;
use crate::options::BenchOptions;
use clap::Args;
use link::EstimateFrame;
use serde_json::json;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Differences that are shown one by one; --json has all.
const SHOWN: usize = 20;

/// Arguments of `host-sim replay`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  host-sim run --record link.rec\n  host-sim replay link.rec --controller emulated\n  \
    host-sim replay link.rec --controller attached --port /dev/ttyUSB0 --json\n  \
    host-sim replay log.csv --bench my-bench.toml --out out/replay\n\n\
    A recording: exits with 0 if every answer is the recorded one to the bit, else with 1. A log: the estimates that the controller \
    would have given, from journal_y_m, journal_z_m, shaft_angle_rad and load_force_n at 50 to 1000 us from sample to sample."
)]
pub struct ReplayArgs {
    /// A recording of `host-sim run --record`, or a measured log (CSV, Parquet or MAT-file).
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// The controller.
    #[arg(long, value_enum, default_value = "native", requires_if("attached", "way"))]
    pub controller: End,
    /// Serial port of the attached controller.
    #[arg(long, value_name = "PATH", group = "way")]
    pub port: Option<PathBuf>,
    /// Its debug probe.
    #[command(flatten)]
    pub probe: ProbeOptions,
    /// Image for the emulated controller; by default the one that `cargo xtask firmware` builds.
    #[arg(long, value_name = "FILE")]
    pub elf: Option<PathBuf>,
    /// The bench of a log; a recording has its configuration inside.
    #[command(flatten)]
    pub bench: BenchOptions,
    /// Folder for estimates.csv; of a recording only if given.
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
        return replay_log::run(args);
    }
    let wrong = |error: &dyn std::fmt::Display| CliError::Input(format!("{}: {error}", args.file.display()));
    let recording = Recording::of(&bytes).map_err(|error| wrong(&error))?;
    let mut controller = end::open(args.controller, args.elf.as_deref(), args.port.as_deref(), &args.probe)?;
    let name = controller.name();
    let replayed = replay(&recording, &mut *controller)?;
    if let Some(out) = &args.out {
        output::write(out, "estimates.csv", &estimates_csv(&replayed.estimates))?;
    }
    tell(args, name, &recording, &replayed)?;
    match replayed.differences.len() {
        0 => Ok(()),
        count => Err(CliError::Work(format!(
            "{}: {count} differences on the {name} controller; expected none",
            args.file.display()
        ))),
    }
}

fn tell(args: &ReplayArgs, name: &str, recording: &Recording, replayed: &Replayed) -> Result<(), CliError> {
    let differences = &replayed.differences;
    if args.json {
        say!(
            "{}",
            output::json(&json!({
                "file": args.file.display().to_string(),
                "recorded_build": recording.build_id.as_str(),
                "controller": name,
                "frames": recording.frames.len(),
                "samples": replayed.samples,
                "commands": replayed.commands,
                "differences": differences,
            }))?
        );
        return Ok(());
    }
    say!(
        "{}: {} samples and {} commands on the {name} controller, {} differences",
        args.file.display(),
        replayed.samples,
        replayed.commands,
        differences.len()
    );
    for Difference { sequence, field, recorded, replayed } in differences.iter().take(SHOWN) {
        let at = sequence.map_or_else(|| "-".into(), |sequence| sequence.to_string());
        say!("{at:>10}  {field:<24} recorded {recorded}, now {replayed}");
    }
    if differences.len() > SHOWN {
        say!("and {} more; --json lists all", differences.len() - SHOWN);
    }
    Ok(())
}

/// Estimates as a table: shortest numbers that read back exactly.
pub(super) fn estimates_csv(estimates: &[EstimateFrame]) -> String {
    let mut text = String::from(
        "sequence,t_s,normal_force_n,force_y_n,force_z_n,friction_torque_nm,deformation_m,contact_angle_rad,flags,saturated\n",
    );
    for e in estimates {
        let t = f64::from(e.time_us) * 1e-6;
        // Writing to text does not fail.
        let _ = writeln!(
            text,
            "{},{t:.6},{:e},{:e},{:e},{:e},{:e},{:e},{},{}",
            e.sequence,
            e.normal_force_n,
            e.force_y_n,
            e.force_z_n,
            e.friction_torque_nm,
            e.deformation_m,
            e.contact_angle_rad,
            e.flags,
            e.saturated
        );
    }
    text
}
