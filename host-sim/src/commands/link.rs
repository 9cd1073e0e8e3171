//! `host-sim link`: who the controller is, how it started, what it counted; and the few things it can be told.

use super::link_words as words;
use super::output;
use super::update::Place;
use crate::controller::{
    AttachedController, Controller, ControllerError, EmulatedController, Losses, RemoteController,
};
use crate::error::CliError;
use crate::estimator;
use crate::force::SAMPLE_RATE_HZ;
use crate::options::BenchOptions;
use bench::Bench;
use bench::transmission::Transmission;
use clap::Args;
use link::update::{UpdateAnswer, UpdateRequest, UpdateStatus};
use link::{Answer, Command, ControllerConfiguration, Counters, Hello, State};
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `host-sim link`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  host-sim link\n  host-sim link --controller attached --port /dev/ttyUSB0 --json\n  \
    host-sim link --controller attached --port /dev/ttyUSB0 --configure --bench bench-b --keep\n\n\
    The emulated controller is started anew each time and forgets everything at its end."
)]
pub struct LinkArgs {
    /// Where the controller is.
    #[arg(long, value_enum, default_value = "emulated")]
    pub controller: Place,
    /// Serial port of the attached controller.
    #[arg(long, value_name = "PATH", required_if_eq("controller", "attached"))]
    pub port: Option<PathBuf>,
    /// Image for the emulated controller; by default the one that `cargo xtask firmware` builds.
    #[arg(long, value_name = "FILE")]
    pub elf: Option<PathBuf>,
    /// Let a controller that has tripped estimate again.
    #[arg(long)]
    pub clear_trip: bool,
    /// End the run.
    #[arg(long)]
    pub stop: bool,
    /// Give the controller the configuration of the bench below.
    #[arg(long)]
    pub configure: bool,
    /// Have it keep its configuration over a loss of power; the run is ended for that.
    #[arg(long)]
    pub keep: bool,
    /// The bench for --configure.
    #[command(flatten)]
    pub bench: BenchOptions,
    /// Print as JSON.
    #[arg(long)]
    pub json: bool,
}

/// What was learnt.
struct Learnt {
    hello: Hello,
    counters: Counters,
    configuration: Option<ControllerConfiguration>,
    models: UpdateStatus,
    losses: Losses,
}

/// Runs the command.
pub fn run(args: &LinkArgs) -> Result<(), CliError> {
    // The bench first: a wrong one is no reason to start anything.
    let configuration = args.configure.then(|| configuration(&args.bench)).transpose()?;
    let mut controller = match (args.controller, &args.port) {
        (Place::Attached, Some(port)) => AttachedController::open(port)?,
        _ => EmulatedController::open(&args.elf.clone().unwrap_or_else(EmulatedController::default_elf))?,
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
    let learnt = learn(&mut controller)?;
    if args.json {
        say!("{}", output::json(&as_json(&learnt))?);
    } else {
        for (what, text) in words::greeting(&learnt.hello, &learnt.models) {
            say!("{what:<16} {text}");
        }
        say!("{:<16} {}", "configuration", words::configuration(learnt.configuration.as_ref()));
        for (name, count) in words::counters(&learnt.counters) {
            say!("  {name:<44} {count:>10}");
        }
    }
    Ok(())
}

/// The configuration of a bench, as `host-sim run` would give it.
fn configuration(options: &BenchOptions) -> Result<ControllerConfiguration, CliError> {
    let Bench::Transmission(bench) = options.open()? else {
        return Err(CliError::Input(format!(
            "{}: found plant `friction-rig`; expected `transmission-bench`",
            options.bench
        )));
    };
    let Bench::Transmission(resolved) = Bench::Transmission(bench).resolved() else {
        return Err(CliError::Work("plant changed".into()));
    };
    let plant = Transmission::new(&resolved, resolved.drive_profile(), resolved.load_profile());
    estimator::controller_configuration(&plant, &resolved, SAMPLE_RATE_HZ)
}

fn learn(controller: &mut RemoteController) -> Result<Learnt, ControllerError> {
    let unexpected =
        |found: String| ControllerError::Unexpected { found, expected: "what was asked for".into() };
    let counters = match controller.order(Command::GetCounters)? {
        Answer::Counters(counters) => counters,
        other => return Err(unexpected(format!("{other:?}"))),
    };
    let configuration = match controller.order(Command::GetConfiguration)? {
        Answer::Configuration(configuration) => configuration,
        other => return Err(unexpected(format!("{other:?}"))),
    };
    let models = match controller.update(UpdateRequest::Status)? {
        UpdateAnswer::Status(status) => status,
        other => return Err(unexpected(format!("{other:?}"))),
    };
    // Last, so that it tells how things stand now.
    let hello = controller.identify()?;
    Ok(Learnt { hello, counters, configuration, models, losses: controller.heard().1 })
}

fn as_json(learnt: &Learnt) -> serde_json::Value {
    let hello = &learnt.hello;
    json!({
        "build": hello.build_id.as_str(),
        "protocol": hello.protocol,
        "target": words::target(hello.target),
        "clock": words::clock(hello.clock),
        "core_hz": hello.core_hz,
        "state": words::state(hello.state),
        "tripped": hello.state == State::Tripped,
        "reset_reason": words::reset(hello.start.reason),
        "fault": hello.start.fault.map(|fault| json!({ "text": fault.to_string(), "record": fault })),
        "stack": hello.stack,
        "window_samples": hello.window,
        "models": hello.models.map(|m| json!({ "crc": format!("{:08x}", m.crc), "training_id": format!("{:016x}", m.training_id) })),
        "model_store": learnt.models,
        "configuration_crc": format!("{:08x}", hello.configuration_crc),
        "configuration": learnt.configuration,
        "counters": learnt.counters,
        "losses": learnt.losses,
    })
}
