//! The link over files of the host, served by the emulator.
//!
//! Two named pipes in the emulator's working directory. One trap moves one frame; while it waits, the emulated time stands still. On
//! silicon a semihosting trap without a debugger is a hard fault, so nothing here may be called there.

use core::ffi::CStr;

use cortex_m_semihosting::{debug, nr};

/// Pipe that the controller reads.
const INPUT: &CStr = c"to-controller";
/// Pipe that the controller writes.
const OUTPUT: &CStr = c"to-host";

/// The two open pipes.
pub struct Files {
    input: usize,
    output: usize,
}

impl Files {
    /// Opens the pipes; nothing if the host did not put them there.
    #[must_use]
    pub fn open() -> Option<Self> {
        let input = open(INPUT, nr::open::R_BINARY)?;
        let output = open(OUTPUT, nr::open::W_TRUNC_BINARY)?;
        Some(Self { input, output })
    }

    /// Waits for bytes and returns those that came; an empty slice when the host has closed the pipe.
    pub fn read<'a>(&self, buffer: &'a mut [u8]) -> &'a [u8] {
        let missing = transfer(nr::READ, self.input, buffer.as_mut_ptr() as usize, buffer.len());
        let came = buffer.len().saturating_sub(missing);
        buffer.get(..came).unwrap_or_default()
    }

    /// Writes bytes; false if the host did not take them all.
    #[must_use]
    pub fn write(&self, bytes: &[u8]) -> bool {
        transfer(nr::WRITE, self.output, bytes.as_ptr() as usize, bytes.len()) == 0
    }
}

/// Ends the emulation.
pub fn leave() {
    debug::exit(debug::EXIT_SUCCESS);
}

fn open(name: &CStr, mode: usize) -> Option<usize> {
    let block = [name.as_ptr() as usize, mode, name.count_bytes()];
    #[expect(unsafe_code, reason = "SYS_OPEN with a terminated name and its length")]
    let handle = unsafe { cortex_m_semihosting::syscall(nr::OPEN, &block) };
    (handle != usize::MAX).then_some(handle)
}

/// Returns the number of bytes that were not transferred.
fn transfer(operation: usize, handle: usize, address: usize, length: usize) -> usize {
    let block = [handle, address, length];
    #[expect(unsafe_code, reason = "the callers pass address and length of a slice that outlives the trap")]
    unsafe {
        cortex_m_semihosting::syscall(operation, &block)
    }
}
