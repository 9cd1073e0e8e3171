//! A controller at a debug probe: the link through two ring buffers in its memory (RTT), beside
//! those of its log.
//!
//! The probe reads and writes memory while the core runs; the controller does not notice it. The
//! image contains the address of the buffers, so the board must run exactly this image: the build
//! name on board is compared first. After a restart the buffers are found again, and the
//! controller's hello reports the restart.
//!
//! The timeouts are those of a line, plus the transfer timeout of the probe's library. When it
//! attaches or detaches, the library stops the core briefly to remove its breakpoints; the
//! controller counts the late ticks.

use super::line::{Line, Timeouts};
use super::probe_channels::{Channels, channels};
use super::stream::Stream;
use super::{ControllerError, RemoteController, attached};
use crate::flash::FlashError;
use crate::flash::probe::{CORE, attach, failed, found, open};
use controller::boards::Board;
use object::{Object, ObjectSection, ObjectSymbol};
use probe_rs::probe::Probe;
use probe_rs::{Core, MemoryInterface, Permissions};
use std::path::Path;

/// Reads that empty a buffer: more than a sending controller can fill meanwhile.
const EMPTYING: usize = 64;

/// Opens controllers at debug probes.
#[derive(Debug)]
pub struct ProbedController;

impl ProbedController {
    /// Opens a probe (`VID:PID` or `VID:PID:SERIAL`; none selects the only one) and identifies the
    /// board. `image` is the image that the board runs.
    pub fn open(
        selector: Option<&str>,
        board: Board,
        image: &Path,
    ) -> Result<RemoteController, ControllerError> {
        // The image first: it contains the addresses.
        let marks = Marks::from_elf(image)?;
        Self::with(open(selector)?, board, &marks, image, attached::TIMEOUTS)
    }

    /// Opens a controller through an open probe with other timeouts.
    pub fn through(
        probe: Probe,
        board: Board,
        image: &Path,
        timeouts: Timeouts,
    ) -> Result<RemoteController, ControllerError> {
        Self::with(probe, board, &Marks::from_elf(image)?, image, timeouts)
    }

    fn with(
        probe: Probe,
        board: Board,
        marks: &Marks,
        image: &Path,
        timeouts: Timeouts,
    ) -> Result<RemoteController, ControllerError> {
        let chip = board.microcontroller.probe_name.ok_or_else(|| {
            FlashError::Board(format!("{}: a board of the emulator; no probe reaches it", board.name))
        })?;
        let mut session = probe.attach(chip, Permissions::default()).map_err(failed(ATTACHING))?;
        let mut core = session.core(CORE).map_err(failed(ATTACHING))?;
        if core.core_halted().map_err(failed(ATTACHING))? {
            let halted = "found the core halted, expected it to run; another debugger may have stopped it, \
                or it is locked up";
            return Err(found(FINDING, halted).into());
        }
        marks.compare(&mut core, image)?;
        let rtt = attach(&mut core, marks.block, FINDING)?;
        let mut open = channels(rtt).ok_or_else(|| found(FINDING, "no channel `link` in both directions"))?;
        let mut left = [0; 1024];
        for _ in 0..EMPTYING {
            if open.0.read(&mut core, &mut left).map_err(failed(FINDING))? == 0 {
                break;
            }
        }
        drop(core);
        let channels = Channels { session, block: marks.block, open: Some(open) };
        let line = Line::new(Stream::Probe(Box::new(channels)), None, timeouts);
        RemoteController::handshake("attached", line, attached::token())
    }
}

/// Addresses in the memory of a controller with a certain image.
struct Marks {
    /// Control block of the buffers.
    block: u64,
    /// Address of the build name.
    build_at: u64,
    build: Vec<u8>,
}

impl Marks {
    /// Reads the addresses from an ELF image.
    fn from_elf(path: &Path) -> Result<Self, ControllerError> {
        let bytes =
            std::fs::read(path).map_err(|_| ControllerError::FirmwareMissing { path: path.into() })?;
        let not = |found: &str| ControllerError::NotFirmware { path: path.into(), found: found.into() };
        let file = object::File::parse(&*bytes).map_err(|_| not("no ELF image"))?;
        let named = |name: &str| {
            file.symbols().find(|symbol| symbol.name() == Ok(name) && symbol.section_index().is_some())
        };
        let block = named("_SEGGER_RTT").ok_or_else(|| not("an image without buffers for a probe"))?;
        let build = named("PINTLE_BUILD_ID").and_then(|symbol| {
            let section = file.section_by_index(symbol.section_index()?).ok()?;
            section
                .data_range(symbol.address(), link::BUILD_ID_LEN as u64)
                .ok()
                .flatten()
                .map(|bytes| (symbol.address(), bytes.to_vec()))
        });
        let (build_at, build) = build.ok_or_else(|| not("an image without a link over a probe"))?;
        Ok(Self { block: block.address(), build_at, build })
    }

    /// Checks that the controller runs this image.
    fn compare(&self, core: &mut Core, path: &Path) -> Result<(), ControllerError> {
        let mut found = vec![0; self.build.len()];
        core.read(self.build_at, &mut found).map_err(failed("reading the name of the build on board"))?;
        if found == self.build {
            return Ok(());
        }
        Err(ControllerError::OtherImage {
            path: path.into(),
            found: build_name(&found),
            expected: build_name(&self.build),
        })
    }
}

/// The build name as text, or a remark that there is none.
fn build_name(bytes: &[u8]) -> String {
    let name = bytes.split(|byte| *byte == 0).next().and_then(|name| std::str::from_utf8(name).ok());
    match name {
        Some(name) if !name.is_empty() && name.chars().all(|c| c.is_ascii_graphic()) => name.into(),
        _ => "without a name".into(),
    }
}

const ATTACHING: &str =
    "attaching to the chip (it may have no power, its wires be loose, or it may be another than the board's)";
const FINDING: &str = "finding the link";
