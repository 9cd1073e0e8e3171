//! The estimator beside a run: on the chosen end, in this process as well, and the two held against each other.

use super::end::{self, End};
use super::run::{ControllerChoice, RunArgs};
use crate::controller::{NativeController, Recorder, Recording};
use crate::error::CliError;
use crate::estimator::{self, See, Tracked};
use crate::sensing::Sampled;
use link::{Command, ControllerConfiguration};

/// What the controller made of the frames.
pub(super) struct Estimated {
    pub(super) tracked: Tracked,
    /// Estimates that differ from those of this process, where the controller is elsewhere.
    pub(super) differences: Option<u64>,
    /// The conversation, if it was to be recorded.
    pub(super) recording: Option<Recording>,
}

/// Has the frames estimated; nothing without a controller.
pub(super) fn estimate(
    args: &RunArgs,
    configuration: ControllerConfiguration,
    frames: &[Sampled],
    see: Option<&mut See<'_>>,
) -> Result<Option<Estimated>, CliError> {
    let end = match args.controller {
        ControllerChoice::None => return Ok(None),
        ControllerChoice::Native => End::Native,
        ControllerChoice::Emulated => End::Emulated,
        ControllerChoice::Attached => End::Attached,
    };
    let mut controller = end::open(end, args.elf.as_deref(), args.port.as_deref(), &args.probe)?;
    let recorder = Recorder::default();
    if args.record.is_some() {
        controller.listen(recorder.clone());
    }
    let build_id = controller.hello().build_id;
    controller.order(Command::Configure(configuration))?;
    let tracked = estimator::track_seen(controller, configuration, frames, args.on_restart, see)?;
    let differences = if end == End::Native {
        None
    } else {
        let native = Box::new(NativeController::start(configuration)?);
        let native = estimator::track_restarting(native, configuration, frames, &tracked.restarts)?;
        Some(estimator::bit_differences(&native, &tracked))
    };
    let recording = args.record.is_some().then(|| Recording { build_id, frames: recorder.take() });
    Ok(Some(Estimated { tracked, differences, recording }))
}
