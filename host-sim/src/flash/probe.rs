//! Writing through a debug probe, and reading the controller's log through it, with probe-rs.
//!
//! Supported are probes with USB bulk transfers: ST-Link, CMSIS-DAP version 2, J-Link and others.
//! CMSIS-DAP version 1 (HID) is not supported, because it requires a C library of the system.
//! Following the log is tested with the library's fake probe. Writing has not been tested: no probe
//! was available, and the fake executes nothing.

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
/// Pause between two reads of the log.
const PAUSE: Duration = Duration::from_millis(20);
/// Timeout of the log's set-up after a reset.
const START_TIMEOUT: Duration = Duration::from_secs(2);

/// Converts an error of the library; names the attempted operation and the causes.
pub(crate) fn failed<E: std::error::Error>(what: &'static str) -> impl Fn(E) -> FlashError {
    move |error| FlashError::Probe { what, cause: with_causes(&error) }
}

/// Creates an error of this program.
pub(crate) fn found(what: &'static str, cause: impl Into<String>) -> FlashError {
    FlashError::Probe { what, cause: cause.into() }
}

/// Formats an error with its causes.
pub(crate) fn with_causes(error: &dyn std::error::Error) -> String {
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

/// Writes a planned image, verifies it and starts the controller.
///
/// # Errors
///
/// There is no probe or no chip, or the flash could not be written.
pub fn write(plan: &Plan, image: &Path, selector: Option<&str>) -> Result<Session, FlashError> {
    write_with(open(selector)?, plan, image)
}

/// Writes as [`write`] does, through an open probe.
///
/// # Errors
///
/// There is no chip, or the flash could not be written.
fn write_with(probe: Probe, plan: &Plan, image: &Path) -> Result<Session, FlashError> {
    let mut session =
        probe.attach(plan.chip, Permissions::default()).map_err(failed("attaching to the chip"))?;
    let mut options = DownloadOptions::default();
    options.verify = true;
    // Only the sectors of the image are erased: models and configuration in the other sectors stay.
    options.do_chip_erase = false;
    download_file_with_options(&mut session, image, ElfLoader(ElfOptions::default()), options)
        .map_err(failed("writing the flash"))?;
    session.core(CORE).and_then(|mut core| core.reset()).map_err(failed("starting the controller"))?;
    Ok(session)
}

/// Shows the log until it can no longer be read.
///
/// # Errors
///
/// The log cannot be found or read.
pub fn follow(session: &mut Session, image: &Path, mut show: impl FnMut(&str)) -> Result<(), FlashError> {
    let elf = std::fs::read(image).map_err(|source| FlashError::unreadable(image, source))?;
    let texts = Texts::from_elf(&elf)?;
    let mut log = texts.decoder();
    // The image contains the address. A search for the mark could find the buffers of another image
    // in RAM.
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

/// Attaches to the buffers after the controller has set them up.
pub(crate) fn attach(core: &mut Core, block: u64, what: &'static str) -> Result<Rtt, FlashError> {
    let deadline = Instant::now() + START_TIMEOUT;
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
