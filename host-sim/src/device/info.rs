//! Device info: everything that a controller reports about itself, as text and as JSON.

use super::describe;
use crate::controller::{Controller, ControllerError, Losses, RemoteController};
use inference::BearingMaterial;
use link::start::SupervisorReport;
use link::track::TrackReport;
use link::update::{UpdateAnswer, UpdateRequest, UpdateStatus};
use link::{
    Answer, Command, ControllerConfiguration, Counters, Hello, Refusal, ReportKind, SamplingReport,
    SlowReport, State,
};
use serde_json::json;

/// Everything that a controller reports about itself.
pub(crate) struct DeviceInfo {
    hello: Hello,
    counters: Counters,
    configuration: Option<ControllerConfiguration>,
    models: UpdateStatus,
    supervisor: SupervisorReport,
    /// None if no run is active.
    track: Option<TrackReport>,
    /// None if no timer triggers samples on the controller.
    sampling: Option<SamplingReport>,
    losses: Losses,
}

impl DeviceInfo {
    /// Asks a controller for everything.
    pub(crate) fn read(controller: &mut RemoteController) -> Result<Self, ControllerError> {
        let counters = match controller.order(Command::GetCounters)? {
            Answer::Counters(counters) => counters,
            other => return Err(unexpected(&other)),
        };
        let configuration = match controller.order(Command::GetConfiguration)? {
            Answer::Configuration(configuration) => configuration,
            other => return Err(unexpected(&other)),
        };
        let models = match controller.update(UpdateRequest::Status)? {
            UpdateAnswer::Status(status) => status,
            other => return Err(unexpected(&other)),
        };
        let supervisor = match controller.order(Command::GetReport(ReportKind::Supervisor))? {
            Answer::Report(SlowReport::Supervisor(known)) => known,
            other => return Err(unexpected(&other)),
        };
        let track = track(controller)?;
        let sampling = match optional_report(controller.order(Command::GetReport(ReportKind::Sampling)))? {
            Some(SlowReport::Sampling(sampling)) => Some(sampling),
            None => None,
            Some(other) => return Err(unexpected(&other)),
        };
        // Last, so that it contains the newest state.
        let hello = controller.identify()?;
        Ok(Self {
            hello,
            counters,
            configuration,
            models,
            supervisor,
            track,
            sampling,
            losses: controller.link_state().1,
        })
    }

    /// The info as JSON.
    pub(crate) fn to_json(&self) -> serde_json::Value {
        let hello = &self.hello;
        json!({
            "build": hello.build_id.as_str(),
            "protocol": hello.protocol,
            "target": describe::target(hello.target),
            "clock": describe::clock(hello.clock),
            "core_hz": hello.core_hz,
            "state": describe::state(hello.state),
            "tripped": hello.state == State::Tripped,
            "reset_reason": describe::reset(hello.start.reason),
            "fault": hello.start.fault.map(|fault| json!({ "text": fault.to_string(), "record": fault })),
            "stack": hello.stack,
            "window_samples": hello.window,
            "models": BearingMaterial::ALL.iter().zip(hello.models).map(|(_, m)| json!({
                "crc": format!("{:08x}", m.crc), "training_id": format!("{:016x}", m.training_id),
            })).collect::<Vec<_>>(),
            "model_store": self.models,
            "supervisor": self.supervisor,
            "track": self.track,
            "sampling": self.sampling,
            "configuration_crc": format!("{:08x}", hello.configuration_crc),
            "configuration": self.configuration,
            "counters": self.counters,
            "losses": self.losses,
        })
    }

    /// Prints the info, one line per item.
    pub(crate) fn print(&self) {
        let track = self.track.as_ref().map(describe::track).unwrap_or_default();
        let sampling = self.sampling.as_ref().map(describe::sampling).unwrap_or_default();
        let lines = describe::identity(&self.hello, &self.models)
            .into_iter()
            .chain(describe::slots(&self.models))
            .chain(describe::supervisor(&self.supervisor))
            .chain(track)
            .chain(sampling);
        for (name, text) in lines {
            print_line!("{name:<16} {text}");
        }
        print_line!("{:<16} {}", "configuration", describe::configuration(self.configuration.as_ref()));
        for (name, count) in describe::counters(&self.counters) {
            print_line!("  {name:<44} {count:>10}");
        }
    }
}

/// Extracts a report; none if no run is active.
pub(super) fn optional_report(
    answer: Result<Answer, ControllerError>,
) -> Result<Option<SlowReport>, ControllerError> {
    match answer {
        Ok(Answer::Report(report)) => Ok(Some(report)),
        Err(ControllerError::Refused(Refusal::NotConfigured)) => Ok(None),
        Ok(other) => Err(unexpected(&other)),
        Err(error) => Err(error),
    }
}

pub(super) fn track(controller: &mut RemoteController) -> Result<Option<TrackReport>, ControllerError> {
    match optional_report(controller.order(Command::GetReport(ReportKind::Track)))? {
        Some(SlowReport::Track(track)) => Ok(Some(track)),
        None => Ok(None),
        Some(other) => Err(unexpected(&other)),
    }
}

pub(super) fn unexpected(found: &impl std::fmt::Debug) -> ControllerError {
    ControllerError::Unexpected { found: format!("{found:?}"), expected: "the requested report".into() }
}
