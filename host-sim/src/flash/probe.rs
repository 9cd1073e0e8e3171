//! Writing through a debug probe, and reading the controller's log through it: probe-rs does both.
//!
//! Probes over USB bulk transfers: ST-Link, CMSIS-DAP version 2, J-Link and others. CMSIS-DAP version 1 (HID) is left out, because it wants a C
//! library of the system. Following the log is tested through the library's fake of a probe; writing has not yet been tried, as no probe was at hand
//! and the fake executes nothing.

use super::log::Texts;
use super::{FlashError, Plan};
use probe_rs::flashing::{DownloadOptions, ElfLoader, ElfOptions, download_file_with_options};
use probe_rs::probe::list::Lister;
use probe_rs::probe::{DebugProbeSelector, Probe};
use probe_rs::rtt::{Rtt, find_rtt_control_block_in_raw_file};
use probe_rs::{Core, Permissions, Session};
use std::path::Path;
use std::time::{Duration, Instant};

/// Core that everything runs on.
pub(crate) const CORE: usize = 0;
/// Pause between two looks at the log.
const PAUSE: Duration = Duration::from_millis(20);
/// Longest time from reset to a log that is set up.
const START: Duration = Duration::from_secs(2);

/// An error that names what was tried and tells its causes.
pub(crate) fn failed<E: std::error::Error>(what: &'static str) -> impl Fn(E) -> FlashError {
    move |error| FlashError::Probe { what, cause: told(&error) }
}

/// An error of ours.
pub(crate) fn found(what: &'static str, cause: impl Into<String>) -> FlashError {
    FlashError::Probe { what, cause: cause.into() }
}

/// An error with its causes.
pub(crate) fn told(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(error.source(), |cause| cause.source());
    causes.fold(error.to_string(), |text, cause| format!("{text}: {cause}"))
}

/// Opens the probe: the one selected, or the only one.
pub(crate) fn open(selector: Option<&str>) -> Result<Probe, FlashError> {
    let lister = Lister::new();
    if let Some(selector) = selector {
        let selector: DebugProbeSelector = selector.parse().map_err(failed("--probe"))?;
        return lister.open(selector).map_err(failed(OPENING));
    }
    let probes = lister.list_all();
    match probes.as_slice() {
        [probe] => probe.open().map_err(failed(OPENING)),
        [] => Err(found(LOOKING, "found none, expected one on USB")),
        several => {
            let names: Vec<_> = several.iter().map(ToString::to_string).collect();
            Err(found(LOOKING, format!("found {}; name one with --probe", names.join(", "))))
        }
    }
}

/// Writes an image that has been planned, verifies it and starts the controller.
///
/// # Errors
///
/// No probe, no chip, or the flash could not be written.
pub fn write(plan: &Plan, image: &Path, selector: Option<&str>) -> Result<Session, FlashError> {
    write_with(open(selector)?, plan, image)
}

/// As [`write`], through a probe that is open.
///
/// # Errors
///
/// No chip, or the flash could not be written.
pub fn write_with(probe: Probe, plan: &Plan, image: &Path) -> Result<Session, FlashError> {
    let mut session =
        probe.attach(plan.chip, Permissions::default()).map_err(failed("attaching to the chip"))?;
    let mut options = DownloadOptions::default();
    options.verify = true;
    // The models and the configuration in the other sectors stay: only what the image covers is erased.
    options.do_chip_erase = false;
    download_file_with_options(&mut session, image, ElfLoader(ElfOptions::default()), options)
        .map_err(failed("writing the flash"))?;
    session.core(CORE).and_then(|mut core| core.reset()).map_err(failed("starting the controller"))?;
    Ok(session)
}

/// Shows the log until it cannot be read any more.
///
/// # Errors
///
/// The log cannot be found or read.
pub fn follow(session: &mut Session, image: &Path, mut show: impl FnMut(&str)) -> Result<(), FlashError> {
    let elf = std::fs::read(image).map_err(|source| FlashError::Unreadable { path: image.into(), source })?;
    let texts = Texts::of(&elf)?;
    let mut log = texts.decoder();
    // Where the image says, and not wherever its mark is found: RAM may still hold another image's.
    let block = find_rtt_control_block_in_raw_file(&elf)
        .map_err(failed(FINDING))?
        .ok_or_else(|| found(FINDING, "the image has none"))?;
    let mut core = session.core(CORE).map_err(failed("the core"))?;
    let mut rtt = attach(&mut core, block, FINDING)?;
    let channel = rtt.up_channel(0).ok_or_else(|| found(FINDING, "no channel 0"))?;
    let mut buffer = [0; 1024];
    loop {
        let count = channel.read(&mut core, &mut buffer).map_err(failed("reading the log"))?;
        for line in log.take(buffer.get(..count).unwrap_or_default()) {
            show(&line);
        }
        if count == 0 {
            std::thread::sleep(PAUSE);
        }
    }
}

/// The buffers, once the controller has come as far as to set them up.
pub(crate) fn attach(core: &mut Core, block: u64, what: &'static str) -> Result<Rtt, FlashError> {
    let deadline = Instant::now() + START;
    loop {
        match Rtt::attach_at(core, block) {
            Ok(rtt) => return Ok(rtt),
            Err(_) if Instant::now() < deadline => std::thread::sleep(PAUSE),
            Err(error) => return Err(failed(what)(error)),
        }
    }
}

const LOOKING: &str = "looking for probes";
const FINDING: &str = "finding the log";
const OPENING: &str = "opening the probe (another program may hold it, or the rights to it be missing)";
