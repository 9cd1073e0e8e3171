//! `host-sim update`: a model package brought to a controller.

use crate::cli::error::CliError;
use crate::cli::output;
use crate::cli::progress;
use crate::controller::choice::{self, ConnectionOptions, RemoteKind};
use crate::controller::{Controller, RemoteController};
use crate::device::update::{Ask, UpdateError, Updated, refusals, update};
use clap::Args;
use link::Command;
use link::update::{ModelMemory, ModelSource, RefusedPackage, UpdateAnswer, UpdateRequest, UpdateStatus};
use model_quant::exchange::package::Package;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Arguments of `host-sim update`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:\n  model-quant package --version 4 --out both-4.package\n  \
                        host-sim update both-4.package\n  \
                        host-sim update both-4.package --controller attached --port /dev/ttyUSB0 \
                        --stop-run\n  \
                        host-sim update --status --controller attached --port /dev/ttyUSB0\n\n\
                        A package is made and signed by `model-quant package`. Repeat the command to \
                        continue an interrupted update.")]
pub struct UpdateArgs {
    /// The package.
    #[arg(required_unless_present = "status", value_name = "PACKAGE")]
    pub package: Option<PathBuf>,
    /// Controller to update.
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
    /// End an active run first. A board stops while its flash is written, so it refuses updates
    /// while it estimates.
    #[arg(long)]
    pub stop_run: bool,
    /// Only print which models are on board and which packages were refused.
    #[arg(long, conflicts_with = "package")]
    pub status: bool,
    /// Print as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
pub fn run(args: &UpdateArgs) -> Result<(), CliError> {
    // The package first: if it is wrong, no controller is started.
    let package = args.package.as_ref().map(|path| read(path)).transpose()?;
    let mut controller = open(args)?;
    if args.stop_run {
        controller.order(Command::Stop)?;
    }
    let outcome = package.as_ref().map(|package| {
        let bar = progress::bar(package.manifest.length().into());
        bar.set_message("update");
        let outcome = update(&mut controller, package, |offset| bar.set_position(offset.into()));
        bar.finish_and_clear();
        outcome
    });
    let refused = refusals(&mut controller)?;
    match outcome {
        None => match controller.ask(UpdateRequest::Status)? {
            UpdateAnswer::Status(status) => report(args.json, &status, None, &refused),
            other => {
                Err(CliError::Work(format!("unexpected answer {other:?}; expected the status of the models")))
            }
        },
        Some(Ok(updated)) => report(args.json, &updated.after, Some(&updated), &refused),
        Some(Err(error @ UpdateError::Refused(_))) => Err(CliError::Input(match &args.package {
            Some(path) => format!("{}: {error}", path.display()),
            None => error.to_string(),
        })),
        Some(Err(UpdateError::NotPermitted(error))) => Err(error.into()),
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
        RemoteKind::Attached => choice::attached(elf, args.port.as_deref(), &args.connection),
        RemoteKind::Emulated => choice::emulated(elf, &args.connection),
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
            .map(|r| {
                let reason = r.reason.to_string();
                json!({ "number": r.number, "slot": r.slot, "version": r.version, "reason": reason })
            })
            .collect();
        let update = updated.map(|u| {
            json!({
                "before": source(u.before.running), "sent_bytes": u.sent_bytes,
                "resumed_at": u.resumed_at, "repeated": u.repeated,
            })
        });
        print_result!(
            "{}",
            output::json(&json!({
                "running": source(status.running), "kept_without_power": status.memory == ModelMemory::Flash,
                "capacity_bytes": status.capacity, "development_key": status.development_key,
                "min_version": status.min_version, "trusted_keys": status.trusted_keys,
                "revoked_keys": status.revoked_keys,
                "altered": status.corrupted, "refused": records, "update": update,
            }))?
        );
        return Ok(());
    }
    if let Some(updated) = updated {
        print_line!("before         {}", describe_source(updated.before.running));
        print_line!("sent           {} bytes, {} attempts repeated", updated.sent_bytes, updated.repeated);
        if updated.resumed_at > 0 {
            print_line!("resumed        at offset {}", updated.resumed_at);
        }
    }
    print_line!("running        {}", describe_source(status.running));
    print_line!(
        "kept           {}",
        match status.memory {
            ModelMemory::Flash => "in flash",
            ModelMemory::Volatile => "in RAM: lost without power",
        }
    );
    if status.development_key {
        print_line!("trusted key    the published development key: for tests only");
    }
    if status.revoked_keys > 0 {
        print_line!("revoked keys   {}; {} are trusted", status.revoked_keys, status.trusted_keys);
    }
    print_line!("next version   {} or higher, unless signed to be older", status.min_version);
    if status.corrupted > 0 {
        print_line!(
            "corrupted      networks found corrupted and replaced {} times since start",
            status.corrupted
        );
    }
    for record in refused {
        print_line!("refused        {}: version {}, {}", record.number, record.version, record.reason);
    }
    Ok(())
}

fn source(running: ModelSource) -> Value {
    match running {
        ModelSource::BuiltIn => json!({ "built_in": true }),
        ModelSource::Slot { slot, version, hash } => {
            let hash = model_quant::exchange::key::digits(&hash);
            json!({ "built_in": false, "slot": slot, "version": version, "hash": hash })
        }
    }
}

fn describe_source(running: ModelSource) -> String {
    match running {
        ModelSource::BuiltIn => "the models built into the firmware".into(),
        ModelSource::Slot { slot, version, hash } => {
            format!("version {version}, slot {slot}, hash {}...", model_quant::exchange::key::digits(&hash))
        }
    }
}
