//! `host-sim run --record` and `host-sim replay`: a replay gives the recorded bits on every
//! controller, differences are listed, damaged files are refused, and a measured log gives the
//! estimates of its run.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

mod twin;

use host_sim::controller::{
    AttachedController, Controller, Direction, NativeController, RecordedFrame, Recorder, Recording, Timeouts,
};
use host_sim::replay::replay;
use host_sim::run::exchange::{OnRestart, exchange_observed};
use link::{Decoder, MAX_FRAME, ToController, ToHost, encode};
use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::Ordering;
use std::time::Duration;
use twin::{CONFIGURATION, Plan, Trouble, Twin, frames};

/// The timeout of an answer only matters after a failure, so it leaves room for a busy machine.
const TIMEOUTS: Timeouts = Timeouts { answer: Duration::from_secs(30), retry: Duration::from_millis(100) };

fn host_sim(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_host-sim")).current_dir(folder).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(output: &Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", text(&output.stderr)))
}

/// Records a run over a twin with planned troubles, with telemetry on.
fn recorded(plan: Vec<Plan>) -> Recording {
    // On a line without losses nothing is repeated, however busy the machine.
    let retry = if plan.is_empty() { TIMEOUTS.answer } else { TIMEOUTS.retry };
    recorded_at(&Twin::start(plan, 1), retry)
}

fn recorded_at(twin: &Twin, retry: Duration) -> Recording {
    let mut configuration = CONFIGURATION;
    configuration.limits.slow_every = 20;
    let mut controller = AttachedController::open_with(&twin.port, Timeouts { retry, ..TIMEOUTS }).unwrap();
    let recorder = Recorder::default();
    controller.listen(recorder.clone());
    controller.configure(configuration).unwrap();
    let build_id = controller.hello().build_id;
    exchange_observed(Box::new(controller), configuration, &frames(400, 1), OnRestart::Continue, None)
        .unwrap();
    Recording { build_id, frames: recorder.take() }
}

fn count(recording: &Recording, way: Direction) -> usize {
    recording.frames.iter().filter(|frame| frame.way == way).count()
}

#[test]
fn a_link_session_is_recorded_completely_and_replays_to_the_bit_on_another_controller() {
    let recording = recorded(vec![]);
    // Two commands and 400 samples; their answers and a frame of telemetry every 20 samples.
    assert_eq!(
        (count(&recording, Direction::ToController), count(&recording, Direction::ToHost)),
        (402, 422)
    );
    let last = recording.frames.last().unwrap();
    assert_eq!((last.way, last.sequence), (Direction::ToHost, Some(399)));
    let read = Recording::from_bytes(&recording.to_bytes()).unwrap();
    assert_eq!(read, recording);
    let replayed = replay(&read, &mut NativeController::open().unwrap()).unwrap();
    assert_eq!((replayed.samples, replayed.commands), (400, 2));
    assert_eq!(replayed.differences, []);
    // The same with a controller whose command numbers have advanced.
    let twin = Twin::start(vec![], 1);
    for _ in 0..2 {
        let mut controller = AttachedController::open_with(&twin.port, TIMEOUTS).unwrap();
        assert_eq!(replay(&read, &mut controller).unwrap().differences, []);
    }
}

#[test]
fn a_recording_does_not_depend_on_when_the_controller_started() {
    // The hello of a start before the host's is discarded with the rest of the port's input. The
    // hello of a start during the handshake arrives just before the answer to the host's request,
    // and that answer belongs to the handshake.
    let started_before = recorded(vec![]);
    let started_during = recorded_at(&Twin::start_on_first_bytes(), TIMEOUTS.answer);
    assert_eq!(started_before, started_during);
}

#[test]
fn requests_that_only_the_replaying_line_needed_are_no_differences() {
    let recording = recorded(vec![]);
    let at = |at, trouble| Plan { at, bytes: 0, trouble };
    // The host requests the counters before it repeats such a sample.
    let twin = Twin::start(vec![at(3, Trouble::SampleLost), at(200, Trouble::SampleDamaged)], 1);
    let mut controller = AttachedController::open_with(&twin.port, TIMEOUTS).unwrap();
    assert_eq!(replay(&recording, &mut controller).unwrap().differences, []);
    assert!(twin.samples.load(Ordering::Relaxed) > 400);
}

#[test]
fn repetitions_and_restarts_in_a_recording_are_replayed_once() {
    let at = |at, bytes, trouble| Plan { at, bytes, trouble };
    let plan = vec![
        at(0, 0, Trouble::SampleLost),
        at(77, 0, Trouble::SampleDamaged),
        at(200, 20, Trouble::Restarts),
    ];
    let recording = recorded(plan);
    assert!(count(&recording, Direction::ToController) > 405);
    let replayed = replay(&recording, &mut NativeController::open().unwrap()).unwrap();
    assert_eq!(replayed.samples, 400);
    assert_eq!(replayed.differences, []);
}

/// Returns the recording with one answer changed.
fn falsified(recording: &Recording, change: impl Fn(&mut ToHost) -> bool) -> Recording {
    let mut frames: Vec<RecordedFrame> = recording.frames.clone();
    for frame in frames.iter_mut().filter(|frame| frame.way == Direction::ToHost) {
        let mut decoder = Decoder::new();
        let mut message = frame.bytes.iter().find_map(|&byte| decoder.push::<ToHost>(byte)).unwrap().unwrap();
        if change(&mut message) {
            frame.bytes = encode(&message, &mut [0; MAX_FRAME]).unwrap().to_vec();
            return Recording { frames, ..recording.clone() };
        }
    }
    panic!("nothing to change");
}

#[test]
fn every_kind_of_difference_is_found_and_named() {
    let recording = recorded(vec![]);
    let found = |recording: &Recording| {
        let replayed = replay(recording, &mut NativeController::open().unwrap()).unwrap();
        let [difference] = &replayed.differences[..] else { panic!("{:?}", replayed.differences) };
        (difference.sequence, difference.field.clone())
    };
    let force = falsified(&recording, |message| match message {
        ToHost::Estimate(e) if e.estimate.sequence == 123 => {
            e.estimate.normal_force_n = f32::from_bits(e.estimate.normal_force_n.to_bits() ^ 1);
            true
        }
        _ => false,
    });
    assert_eq!(found(&force), (Some(123), "normal_force_n".into()));
    let flags = falsified(&recording, |message| match message {
        ToHost::Estimate(e) if e.estimate.sequence == 5 => {
            e.estimate.flags ^= 1 << 20;
            true
        }
        _ => false,
    });
    assert_eq!(found(&flags), (Some(5), "flags".into()));
    let slow = falsified(&recording, |message| match message {
        ToHost::Slow(slow) => match &mut slow.report {
            link::SlowReport::Sensors(health) => {
                health.held += 1;
                true
            }
            _ => false,
        },
        _ => false,
    });
    assert_eq!(found(&slow).1, "slow telemetry, sensors");
    let counters = falsified(&recording, |message| match message {
        ToHost::Acknowledged(link::Acknowledgement {
            outcome: Ok(link::Answer::Stopped(counters)), ..
        }) => {
            counters.samples += 1;
            true
        }
        _ => false,
    });
    assert_eq!(found(&counters), (Some(399), "outcome of a command".into()));
    // Ticks are in the report at the end.
    let ticks = falsified(&recording, |message| match message {
        ToHost::Estimate(e) => {
            e.estimate.instruction_ticks += 9;
            true
        }
        _ => false,
    });
    assert_eq!(replay(&ticks, &mut NativeController::open().unwrap()).unwrap().differences, []);
}

#[test]
fn a_recording_of_something_else_than_a_run_is_refused() {
    let recording = recorded(vec![]);
    let foreign = encode(&ToController::Update(link::update::UpdateRequest::Status), &mut [0; MAX_FRAME])
        .unwrap()
        .to_vec();
    for (bytes, expected) in [
        (foreign, "an update of models"),
        (vec![1, 2, 0], "expected a frame"),
        (vec![], "one complete frame"),
    ] {
        let mut changed = recording.clone();
        changed.frames[0].bytes = bytes;
        let error = replay(&changed, &mut NativeController::open().unwrap()).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn run_and_replay_agree_and_a_damaged_file_exits_with_2() {
    let folder = tempfile::tempdir().unwrap();
    let run = host_sim(folder.path(), &["run", "--force", "law", "--record", "link.rec"]);
    assert!(run.status.success(), "{}", text(&run.stderr));
    let output = host_sim(folder.path(), &["replay", "link.rec", "--json", "--out", "again"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let printed = json(&output);
    assert_eq!(printed.get("samples").unwrap(), 10_000);
    assert_eq!(printed.get("differences").unwrap().as_array().unwrap().len(), 0);
    let table = std::fs::read_to_string(folder.path().join("again/estimates.csv")).unwrap();
    assert_eq!(table.lines().count(), 10_001);

    let bytes = std::fs::read(folder.path().join("link.rec")).unwrap();
    let force = falsified(&Recording::from_bytes(&bytes).unwrap(), |message| match message {
        ToHost::Estimate(e) if e.estimate.sequence == 7_000 => {
            e.estimate.deformation_m += 1.0;
            true
        }
        _ => false,
    });
    std::fs::write(folder.path().join("false.rec"), force.to_bytes()).unwrap();
    let output = host_sim(folder.path(), &["replay", "false.rec"]);
    assert_eq!(output.status.code(), Some(1));
    let listing = text(&output.stdout);
    assert!(listing.contains("7000  deformation_m") && listing.contains("1 differences"), "{listing}");
    assert!(text(&output.stderr).contains("false.rec: 1 differences on the native controller"));

    let mut cut = bytes.clone();
    cut.truncate(bytes.len() / 2);
    std::fs::write(folder.path().join("cut.rec"), cut).unwrap();
    for (arguments, expected) in [
        (&["replay", "cut.rec"][..], "cut.rec: byte "),
        (&["replay", "missing.rec"], "missing.rec: "),
        (&["replay", "link.rec", "--controller", "attached"], "--port"),
        (&["replay", "link.rec", "--controller", "attached", "--port", "nowhere"], "nowhere: "),
        (&["run", "--controller", "none", "--record", "x.rec"], "--record: found --controller none"),
        (&["run", "--controller", "attached"], "--port"),
        (&["replay"], "<FILE>"),
    ] {
        let output = host_sim(folder.path(), arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
    assert!(!folder.path().join("x.rec").exists());
}

#[test]
fn a_measured_log_gives_the_estimates_of_its_run() {
    let folder = tempfile::tempdir().unwrap();
    // A log at the controller's own rate from perfect sensors contains the exact input of the
    // controller.
    let preset = include_str!("../../crates/bench/presets/bench-b.toml");
    let perfect = preset.replace("noise = 20e-6", "noise = 0.0").replace("noise = 0.2e-6", "noise = 0.0");
    let rate = preset.lines().find(|line| line.starts_with("sample_rate_hz")).unwrap();
    std::fs::write(folder.path().join("fast.toml"), perfect.replace(rate, "sample_rate_hz = 10000.0"))
        .unwrap();
    let run =
        host_sim(folder.path(), &["run", "--bench", "fast.toml", "--force", "law", "--record", "a.rec"]);
    assert!(run.status.success(), "{}", text(&run.stderr));
    let replayed = host_sim(folder.path(), &["replay", "a.rec", "--out", "a"]);
    assert!(replayed.status.success(), "{}", text(&replayed.stderr));
    let output = host_sim(
        folder.path(),
        &["replay", "out/run/log.csv", "--bench", "fast.toml", "--out", "b", "--json"],
    );
    assert!(output.status.success(), "{}", text(&output.stderr));
    let printed = json(&output);
    assert_eq!(printed.get("samples").unwrap(), 10_000);
    assert!((printed.get("sample_rate_hz").unwrap().as_f64().unwrap() - 10_000.0).abs() < 1e-6);
    assert!(printed.get("peak_normal_force_n").unwrap().as_f64().unwrap() > 5_000.0);
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name).join("estimates.csv")).unwrap();
    assert!(read("a") == read("b"), "the log's estimates are not the run's");

    // The controller notices missing rows.
    let log = std::fs::read_to_string(folder.path().join("out/run/log.csv")).unwrap();
    let holes: Vec<&str> =
        log.lines().enumerate().filter(|(i, _)| !(5000..5100).contains(i)).map(|(_, line)| line).collect();
    std::fs::write(folder.path().join("holes.csv"), holes.join("\n")).unwrap();
    let output =
        host_sim(folder.path(), &["replay", "holes.csv", "--bench", "fast.toml", "--out", "d", "--json"]);
    let printed = json(&output);
    assert_eq!(printed.get("samples").unwrap(), 9_900, "{}", text(&output.stderr));
    assert_eq!(printed.pointer("/counters/sequence_gaps").unwrap(), 1);
    assert!(read("d").lines().last().unwrap().starts_with("9999,"));

    // Logs that the controller cannot process.
    let twice = log.replacen("\n0.0002,", "\n0.00011,", 1);
    assert!(twice != log);
    std::fs::write(folder.path().join("twice.csv"), twice).unwrap();
    let thinned: String = log
        .lines()
        .enumerate()
        .filter(|(i, _)| *i == 0 || i % 50 == 1)
        .map(|(_, l)| format!("{l}\n"))
        .collect();
    std::fs::write(folder.path().join("slow.csv"), thinned).unwrap();
    std::fs::write(folder.path().join("few.csv"), "t_s,journal_y_m\n0,0\n1e-4,0\n2e-4,0\n").unwrap();
    for (name, expected) in [
        ("slow.csv", "slow.csv: found 5000 us between samples; expected 50 to 1000 us"),
        ("few.csv", "few.csv: no column `journal_z_m`"),
        ("twice.csv", "twice.csv: found rows 2 and 3 in one period of 100 us; expected one"),
    ] {
        let output = host_sim(folder.path(), &["replay", name, "--out", "c"]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(expected), "{message}");
        assert!(!folder.path().join("c").exists());
    }
}

#[test]
fn help_has_examples() {
    let folder = tempfile::tempdir().unwrap();
    let help = text(&host_sim(folder.path(), &["replay", "--help"]).stdout);
    assert!(
        help.contains("host-sim replay link.rec --controller emulated") && help.contains("--json"),
        "{help}"
    );
}
