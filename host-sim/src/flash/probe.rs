//! Writing through a debug probe, and reading the controller's log through it: probe-rs does both.
//!
//! Probes over USB bulk transfers: ST-Link, CMSIS-DAP version 2, J-Link and others. CMSIS-DAP version 1 (HID) is left out, because it wants a C
//! library of the system. Built, but not yet tried: no probe was at hand.

use super::log::Texts;
use super::{FlashError, Plan};
use probe_rs::flashing::{DownloadOptions, ElfLoader, ElfOptions, download_file_with_options};
use probe_rs::probe::list::Lister;
use probe_rs::probe::{DebugProbeSelector, Probe};
use probe_rs::rtt::Rtt;
use probe_rs::{Permissions, Session};
use std::path::Path;
use std::time::Duration;

/// Core that everything runs on.
const CORE: usize = 0;
/// Pause between two looks at the log.
const PAUSE: Duration = Duration::from_millis(20);

fn failed<E: std::fmt::Display>(what: &'static str) -> impl Fn(E) -> FlashError {
    move |cause| FlashError::Probe { what, cause: cause.to_string() }
}

/// Opens the probe: the one selected, or the only one.
fn open(selector: Option<&str>) -> Result<Probe, FlashError> {
    let lister = Lister::new();
    if let Some(selector) = selector {
        let selector: DebugProbeSelector = selector.parse().map_err(failed("--probe"))?;
        return lister.open(selector).map_err(failed("opening the probe"));
    }
    let probes = lister.list_all();
    match probes.as_slice() {
        [probe] => probe.open().map_err(failed("opening the probe")),
        [] => Err(failed("looking for probes")("found none, expected one on USB")),
        several => {
            let names: Vec<_> = several.iter().map(ToString::to_string).collect();
            Err(failed("looking for probes")(format!("found {}; name one with --probe", names.join(", "))))
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
    let mut core = session.core(CORE).map_err(failed("the core"))?;
    let mut rtt = Rtt::attach(&mut core).map_err(failed("finding the log"))?;
    let channel = rtt.up_channel(0).ok_or_else(|| failed("finding the log")("no channel 0"))?;
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
