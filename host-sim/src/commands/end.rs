//! Which controller a command talks to, and opening it.

use crate::controller::{
    AttachedController, Controller, ControllerError, EmulatedController, NativeController,
};
use std::path::Path;

/// A controller's end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum End {
    /// The firmware's code in this process.
    Native,
    /// The firmware's image in the emulator.
    Emulated,
    /// A board on a serial port.
    Attached,
}

/// Opens an end, not yet configured. An attached one without a port has been refused by the command line.
pub(super) fn open(
    end: End,
    elf: Option<&Path>,
    port: Option<&Path>,
) -> Result<Box<dyn Controller>, ControllerError> {
    Ok(match end {
        End::Native => Box::new(NativeController::open()?),
        End::Emulated => {
            let default = EmulatedController::default_elf();
            Box::new(EmulatedController::open(elf.unwrap_or(&default))?)
        }
        End::Attached => Box::new(AttachedController::open(port.unwrap_or(Path::new("")))?),
    })
}
