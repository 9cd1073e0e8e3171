//! `host-sim link`: who the controller is, how it started, what it counted; and the few things it can be told.

use super::end::{self, ProbeOptions};
use super::link_words as words;
use super::output;
use super::update::Place;
use crate::controller::{Controller, ControllerError, Losses, RemoteController};
use crate::error::CliError;
use crate::estimator;
use crate::force::SAMPLE_RATE_HZ;
use crate::options::BenchOptions;
use bench::Bench;
use bench::transmission::Transmission;
use clap::Args;
use link::start::SupervisorReport;
use link::track::TrackReport;
use link::update::{UpdateAnswer, UpdateRequest, UpdateStatus};
use link::{
    Answer, Command, ControllerConfiguration, Counters, Hello, NumberedEstimate, Refused, ReportKind,
    SlowReport, State,
};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Arguments of `host-sim link`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Examples:\n  host-sim link\n  host-sim link --controller attached --port /dev/ttyUSB0 --json\n  \
    host-sim link --controller attached --port /dev/ttyUSB0 --configure --bench bench-b --keep\n  \
    host-sim link --controller attached --port /dev/ttyUSB0 --sample --follow 60\n  \
    host-sim link --controller attached --probe --board feather-stm32f405\n\n\
    The emulated controller is started anew each time, forgets everything at its end, and has no sensors. \
    `--json` prints the configuration in the form that --configuration takes."
)]
pub struct LinkArgs {
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
    /// Let a controller that has tripped estimate again.
    #[arg(long)]
    pub clear_trip: bool,
    /// End the run.
    #[arg(long)]
    pub stop: bool,
    /// Give the controller the configuration of the bench below.
    #[arg(long)]
    pub configure: bool,
    /// Give the controller the configuration of a file: JSON, as printed under `configuration`.
    #[arg(long, value_name = "FILE", conflicts_with = "configure")]
    pub configuration: Option<PathBuf>,
    /// Have it sample its own sensors from now on, until it is stopped or configured anew.
    #[arg(long, conflicts_with_all = ["stop", "keep"])]
    pub sample: bool,
    /// Show the newest estimate, the counters, what is tracked and the own sensors' newest sample before calibration, twice a second, for so
    /// many seconds.
    #[arg(long, value_name = "SECONDS")]
    pub follow: Option<u32>,
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
    supervisor: SupervisorReport,
    /// None without a run.
    track: Option<TrackReport>,
    losses: Losses,
}

/// Runs the command.
pub fn run(args: &LinkArgs) -> Result<(), CliError> {
    // The bench first: a wrong one is no reason to start anything.
    let configuration = match &args.configuration {
        Some(file) => Some(read(file)?),
        None => args.configure.then(|| configuration(&args.bench)).transpose()?,
    };
    let elf = args.elf.as_deref();
    let mut controller = match args.controller {
        Place::Attached => end::attached(elf, args.port.as_deref(), &args.probe)?,
        Place::Emulated => end::emulated(elf)?,
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
    let learnt = learn(&mut controller)?;
    if args.json {
        say!("{}", output::json(&as_json(&learnt))?);
    } else {
        let track = learnt.track.as_ref().map(words::track).unwrap_or_default();
        let lines = words::greeting(&learnt.hello, &learnt.models)
            .into_iter()
            .chain(words::slots(&learnt.models))
            .chain(words::supervisor(&learnt.supervisor))
            .chain(track);
        for (what, text) in lines {
            say!("{what:<16} {text}");
        }
        say!("{:<16} {}", "configuration", words::configuration(learnt.configuration.as_ref()));
        for (name, count) in words::counters(&learnt.counters) {
            say!("  {name:<44} {count:>10}");
        }
    }
    Ok(())
}

/// The configuration in a file.
fn read(file: &Path) -> Result<ControllerConfiguration, CliError> {
    let wrong = |found: String| {
        CliError::Input(format!("{}: {found}; expected a controller's configuration as JSON", file.display()))
    };
    let text = std::fs::read_to_string(file).map_err(|error| wrong(error.to_string()))?;
    serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))
}

/// Shows how things go.
fn follow(controller: &mut RemoteController, seconds: u32, as_json: bool) -> Result<(), CliError> {
    for _ in 0..seconds.saturating_mul(2) {
        std::thread::sleep(Duration::from_millis(500));
        let estimate = of_run(controller.order(Command::GetReport(ReportKind::Estimate)))?;
        let Some(SlowReport::Estimate(estimate)) = estimate else {
            return Err(CliError::Work("no run is on: nothing to follow (host-sim link --configure)".into()));
        };
        let estimate = NumberedEstimate::from(estimate).estimate;
        let Answer::Counters(counters) = controller.order(Command::GetCounters)? else {
            return Err(CliError::Work("expected the counters".into()));
        };
        let track = track(controller)?;
        let sample = match of_run(controller.order(Command::GetReport(ReportKind::Sample)))? {
            Some(SlowReport::Sample(sample)) => Some(sample),
            _ => None,
        };
        if as_json {
            let line = json!({ "sample": sample, "estimate": estimate, "flags": words::flags(&estimate), "counters": counters, "track": track });
            say!("{line}");
        } else {
            if let Some(sample) = sample {
                say!("{}", words::sample(&sample));
            }
            say!("{}", words::live(&estimate, &counters, track.as_ref()));
        }
    }
    Ok(())
}

/// A report, or none because no run is on.
fn of_run(answer: Result<Answer, ControllerError>) -> Result<Option<SlowReport>, ControllerError> {
    match answer {
        Ok(Answer::Report(report)) => Ok(Some(report)),
        Err(ControllerError::Refused(Refused::NotConfigured)) => Ok(None),
        Ok(other) => Err(unexpected(&other)),
        Err(error) => Err(error),
    }
}

fn track(controller: &mut RemoteController) -> Result<Option<TrackReport>, ControllerError> {
    match of_run(controller.order(Command::GetReport(ReportKind::Track)))? {
        Some(SlowReport::Track(track)) => Ok(Some(track)),
        None => Ok(None),
        Some(other) => Err(unexpected(&other)),
    }
}

fn unexpected(found: &impl std::fmt::Debug) -> ControllerError {
    ControllerError::Unexpected { found: format!("{found:?}"), expected: "what was asked for".into() }
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
    // Last, so that it tells how things stand now.
    let hello = controller.identify()?;
    Ok(Learnt { hello, counters, configuration, models, supervisor, track, losses: controller.heard().1 })
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
        "supervisor": learnt.supervisor,
        "track": learnt.track,
        "configuration_crc": format!("{:08x}", hello.configuration_crc),
        "configuration": learnt.configuration,
        "counters": learnt.counters,
        "losses": learnt.losses,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_configuration_as_printed_is_read_back_and_anything_else_is_refused_with_its_place() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("configuration.json");
        let mut configuration = firmware::configuration::BENCH_B;
        configuration.wiring.first_probe_centidegrees = -4_500;
        std::fs::write(&file, serde_json::to_string(&configuration).expect("JSON")).expect("written");
        assert_eq!(read(&file).expect("a configuration"), configuration);
        std::fs::write(&file, "{\n\"version\": 2\n}").expect("written");
        let error = read(&file).expect_err("no configuration");
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("line 3") && error.to_string().contains("bench"), "{error}");
    }
}
