//! `host-sim update`: a model package brought to a controller.

use super::end::{self, ProbeOptions};
use super::output;
use crate::controller::{Controller, RemoteController};
use crate::error::CliError;
use crate::progress;
use crate::update::{Ask, UpdateError, Updated, refusals, update};
use clap::{Args, ValueEnum};
use link::Command;
use link::update::{ModelMemory, ModelSource, RefusedPackage, UpdateAnswer, UpdateRequest, UpdateStatus};
use model_quant::package::Package;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Where the controller is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Place {
    /// The firmware's image in the emulator: a rehearsal, forgotten when it ends.
    Emulated,
    /// A board on a serial port or at a debug probe.
    Attached,
}

/// Arguments of `host-sim update`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  model-quant package --version 4 --out both-4.package\n  host-sim update both-4.package\n  \
                        host-sim update both-4.package --controller attached --port /dev/ttyUSB0 --stop-run\n  \
                        host-sim update --status --controller attached --port /dev/ttyUSB0\n\n\
    A package is made and signed by `model-quant package`. An interrupted update is gone on with by the same command."
)]
pub struct UpdateArgs {
    /// The package.
    #[arg(required_unless_present = "status", value_name = "PACKAGE")]
    pub package: Option<PathBuf>,
    /// Where the controller is.
    #[arg(long, value_enum, default_value = "emulated", requires_if("attached", "way"))]
    pub controller: Place,
    /// Serial port of the attached controller.
    #[arg(long, value_name = "PATH", group = "way")]
    pub port: Option<PathBuf>,
    /// Its debug probe.
    #[command(flatten)]
    pub probe: ProbeOptions,
    /// Image for the emulated controller; by default the one that `cargo xtask firmware` builds.
    #[arg(long, value_name = "FILE")]
    pub elf: Option<PathBuf>,
    /// End a run that is going on: a board whose flash is written stands still meanwhile and refuses to while it estimates.
    #[arg(long)]
    pub stop_run: bool,
    /// Only say which models are on board and which packages were refused.
    #[arg(long, conflicts_with = "package")]
    pub status: bool,
    /// Print as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
pub fn run(args: &UpdateArgs) -> Result<(), CliError> {
    // The package first: a wrong one is no reason to start anything.
    let package = args.package.as_ref().map(|path| read(path)).transpose()?;
    let mut controller = open(args)?;
    if args.stop_run {
        controller.order(Command::Stop)?;
    }
    let outcome = package.as_ref().map(|package| {
        let bar = progress::bar(args.json, package.manifest.length().into());
        bar.set_message("update");
        let outcome = update(&mut controller, package, |offset| bar.set_position(offset.into()));
        bar.finish_and_clear();
        outcome
    });
    let refused = refusals(&mut controller)?;
    match outcome {
        None => match controller.ask(UpdateRequest::Status)? {
            UpdateAnswer::Status(status) => report(args.json, &status, None, &refused),
            other => Err(CliError::Work(format!("unexpected answer {other:?}; expected how things stand"))),
        },
        Some(Ok(updated)) => report(args.json, &updated.after, Some(&updated), &refused),
        Some(Err(error @ UpdateError::Refused(_))) => Err(CliError::Input(match &args.package {
            Some(path) => format!("{}: {error}", path.display()),
            None => error.to_string(),
        })),
        Some(Err(error)) => Err(CliError::Work(error.to_string())),
    }
}

fn read(path: &std::path::Path) -> Result<Package, CliError> {
    Package::read(path)
        .map_err(|error| CliError::Input(format!("{}: {error}", path.display())))?
        .map_err(|error| CliError::Input(format!("{}: not a model package: {error}", path.display())))
}

fn open(args: &UpdateArgs) -> Result<RemoteController, CliError> {
    let elf = args.elf.as_deref();
    match args.controller {
        Place::Attached => end::attached(elf, args.port.as_deref(), &args.probe),
        Place::Emulated => end::emulated(elf),
    }
}

fn report(
    as_json: bool,
    status: &UpdateStatus,
    updated: Option<&Updated>,
    refused: &[RefusedPackage],
) -> Result<(), CliError> {
    if as_json {
        let records: Vec<Value> = refused
            .iter()
            .map(|r| json!({ "number": r.number, "slot": r.slot, "version": r.version, "reason": r.reason.to_string() }))
            .collect();
        let update = updated.map(|u| {
            json!({ "before": source(u.before.running), "sent_bytes": u.sent_bytes, "resumed_at": u.resumed_at, "repeated": u.repeated })
        });
        say!(
            "{}",
            output::json(&json!({
                "running": source(status.running), "kept_without_power": status.memory == ModelMemory::Flash,
                "capacity_bytes": status.capacity, "development_key": status.development_key,
                "altered": status.altered, "refused": records, "update": update,
            }))?
        );
        return Ok(());
    }
    if let Some(updated) = updated {
        say!("before         {}", words(updated.before.running));
        say!("sent           {} bytes, {} attempts repeated", updated.sent_bytes, updated.repeated);
        if updated.resumed_at > 0 {
            say!("resumed        at offset {}", updated.resumed_at);
        }
    }
    say!("running        {}", words(status.running));
    say!(
        "kept           {}",
        match status.memory {
            ModelMemory::Flash => "in flash",
            ModelMemory::Volatile => "in RAM: gone with the power",
        }
    );
    if status.development_key {
        say!("trusted key    the published development key: for trying only");
    }
    if status.altered > 0 {
        say!("altered        networks found altered and replaced {} times since start", status.altered);
    }
    for record in refused {
        say!("refused        {}: version {}, {}", record.number, record.version, record.reason);
    }
    Ok(())
}

fn source(running: ModelSource) -> Value {
    match running {
        ModelSource::BuiltIn => json!({ "built_in": true }),
        ModelSource::Slot { slot, version, hash } => {
            json!({ "built_in": false, "slot": slot, "version": version, "hash": model_quant::key::digits(&hash) })
        }
    }
}

fn words(running: ModelSource) -> String {
    match running {
        ModelSource::BuiltIn => "the models built into the firmware".into(),
        ModelSource::Slot { slot, version, hash } => {
            format!("version {version}, slot {slot}, hash {}...", model_quant::key::digits(&hash))
        }
    }
}
