//! The estimator of a run: on the chosen controller and, for comparison, in this process.

use super::{ControllerChoice, RunArgs};
use crate::cli::error::CliError;
use crate::controller::choice::{self, ControllerKind};
use crate::controller::{NativeController, Recorder, Recording};
use crate::run::exchange::{self, ExchangeResult, Observer};
use crate::run::sensing::Sampled;
use link::{Command, ControllerConfiguration};

/// Result of the chosen controller.
pub(super) struct Estimated {
    pub(super) exchange: ExchangeResult,
    /// Number of estimates that differ from those of this process; none on the native controller.
    pub(super) differences: Option<u64>,
    /// The link session, if it was to be recorded.
    pub(super) recording: Option<Recording>,
}

/// Sends the frames to the chosen controller. Returns none without a controller.
pub(super) fn estimate(
    args: &RunArgs,
    configuration: ControllerConfiguration,
    frames: &[Sampled],
    see: Option<&mut Observer<'_>>,
) -> Result<Option<Estimated>, CliError> {
    let kind = match args.controller {
        ControllerChoice::None => return Ok(None),
        ControllerChoice::Native => ControllerKind::Native,
        ControllerChoice::Emulated => ControllerKind::Emulated,
        ControllerChoice::Attached => ControllerKind::Attached,
    };
    let mut controller = choice::open(kind, args.elf.as_deref(), args.port.as_deref(), &args.connection)?;
    let recorder = Recorder::default();
    if args.record.is_some() {
        controller.listen(recorder.clone());
    }
    let build_id = controller.hello().build_id;
    controller.order(Command::Configure(configuration))?;
    let exchanged = exchange::exchange_observed(controller, configuration, frames, args.on_restart, see)?;
    let differences = if kind == ControllerKind::Native {
        None
    } else {
        let native = Box::new(NativeController::start(configuration)?);
        let native = exchange::exchange_with_restarts(native, configuration, frames, &exchanged.restarts)?;
        Some(exchange::bit_differences(&native, &exchanged))
    };
    let recording = args.record.is_some().then(|| Recording { build_id, frames: recorder.take() });
    Ok(Some(Estimated { exchange: exchanged, differences, recording }))
}
