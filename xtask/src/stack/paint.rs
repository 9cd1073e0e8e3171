//! Depth of the stack in a run of the estimator on the emulator.
//!
//! The link's pipes are plain files here. All frames are written before the run, and the image ends
//! after the last one. Its answers are read afterwards.

use crate::run::{ChoreError, run_with_timeout, target_folder};
use crate::setup::EMULATOR;
use controller::configuration::BENCH_B;
use controller::emulator::MACHINE;
use link::track::SensorStatus;
use link::{Command, Decoder, MAX_FRAME, NumberedCommand, SensorFrame, ToController, ToHost, encode};
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

/// Samples of the run. The search for the mark advances once in 16 frames and completes several
/// rounds.
const SAMPLES: u32 = 12_000;
/// The run takes less than two seconds.
const TIMEOUT: Duration = Duration::from_secs(600);

/// Runs an image with contacts, a bad configuration, damaged frames and a stop. Returns the used
/// bytes of its stack.
pub(super) fn run(image: &Path) -> Result<u32, ChoreError> {
    let folder = target_folder().join("painted");
    let file = |name: &str| folder.join(name);
    let failed =
        |found: String, expected: &'static str| ChoreError::File { file: folder.clone(), found, expected };
    std::fs::create_dir_all(&folder)
        .and_then(|()| std::fs::write(file("to-controller"), frames()))
        .and_then(|()| std::fs::write(file("to-host"), []))
        .map_err(|error| failed(error.to_string(), "files that can be written"))?;
    emulate(image, &folder)?;
    let answers = std::fs::read(file("to-host")).map_err(|error| failed(error.to_string(), "the answers"))?;
    let mut decoder = Decoder::new();
    let messages = answers.iter().filter_map(|&byte| decoder.push::<ToHost>(byte)?.ok());
    let (mut estimates, mut painted) = (0, None);
    for message in messages {
        match message {
            ToHost::Hello(hello) => painted = Some(hello.stack.used_bytes),
            ToHost::Estimate(_) => estimates += 1,
            _ => {}
        }
    }
    match painted {
        Some(bytes) if estimates == SAMPLES => Ok(bytes),
        _ => Err(failed(
            format!("{estimates} estimates and {painted:?} in to-host"),
            "one for each sample, and a hello frame at the end",
        )),
    }
}

fn emulate(image: &Path, folder: &Path) -> Result<(), ChoreError> {
    let mut command = std::process::Command::new(EMULATOR);
    command
        .args(["-M", MACHINE, "-display", "none", "-serial", "null", "-monitor", "none", "-no-reboot"])
        .args(["-semihosting-config", "enable=on,target=native", "-icount", "shift=6,sleep=off", "-kernel"])
        .arg(image)
        .current_dir(folder)
        .stdin(Stdio::null());
    run_with_timeout(&mut command, TIMEOUT).map(|_| ())
}

/// The host's side of the run.
fn frames() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut add = |message: &ToController| {
        let mut frame = [0; MAX_FRAME];
        // Every message fits.
        bytes.extend_from_slice(encode(message, &mut frame).unwrap_or_default());
    };
    let command = |id: u32, command: Command| ToController::Command(NumberedCommand { id, command });
    let mut bad = BENCH_B;
    bad.bench.sample_period_us = 1;
    add(&command(1, Command::Configure(bad)));
    add(&command(2, Command::Configure(BENCH_B)));
    for sequence in 0..SAMPLES {
        add(&ToController::Sensor(sample(sequence), SensorStatus::GOOD));
    }
    add(&command(3, Command::GetCounters));
    add(&command(4, Command::Keep));
    add(&command(5, Command::Stop));
    bytes.extend_from_slice(&[1, 2, 3, 0, 0]);
    let mut frame = [0; MAX_FRAME];
    bytes.extend_from_slice(encode(&ToController::Identify { token: 1 }, &mut frame).unwrap_or_default());
    bytes
}

/// Sample with the journal in and out of contact below the centre while the shaft swings.
fn sample(sequence: u32) -> SensorFrame {
    let wave = |period: i64, most: i64| {
        let phase = i64::from(sequence) % period * 4 * most / period;
        (if phase < 2 * most { phase - most } else { 3 * most - phase }) as i32
    };
    SensorFrame {
        sequence,
        time_us: sequence * BENCH_B.bench.sample_period_us,
        journal_y_nm: wave(97, 20_000),
        journal_z_nm: -510_000 - wave(301, 60_000),
        shaft_angle_nrad: wave(2_003, 40_000_000),
        load_force_mn: 10_000_000 + wave(53, 5_000),
    }
}
