//! The link over files of the host, which the emulator serves.
//!
//! The files are two named pipes in the emulator's working directory. One trap transfers one frame;
//! while it waits, the emulated time does not advance. On silicon a semihosting trap without a
//! debugger is a hard fault, so nothing here may be called there.

use core::ffi::CStr;
use core::ops::Range;

use controller::service::{Purpose, Received, Transport};
use cortex_m_semihosting::{debug, nr};
use link::MAX_FRAME;

/// Pipe that the controller reads.
const INPUT: &CStr = c"to-controller";
/// Pipe that the controller writes.
const OUTPUT: &CStr = c"to-host";

/// The two open pipes and the bytes read ahead.
pub struct Files {
    input: usize,
    output: usize,
    buffer: [u8; MAX_FRAME],
    /// Bytes of the buffer that have been read and not been taken.
    unread: Range<usize>,
}

impl Files {
    /// Opens the pipes. Returns `None` if the host has not created them.
    #[must_use]
    pub(super) fn open() -> Option<Self> {
        let input = open(INPUT, nr::open::R_BINARY)?;
        let output = open(OUTPUT, nr::open::W_TRUNC_BINARY)?;
        Some(Self { input, output, buffer: [0; MAX_FRAME], unread: 0..0 })
    }
}

impl Transport for Files {
    /// Waits for the next byte. The host closes the pipe at the end.
    fn receive(&mut self) -> Received {
        if self.unread.is_empty() {
            let address = self.buffer.as_mut_ptr() as usize;
            let missing = transfer(nr::READ, self.input, address, self.buffer.len());
            self.unread = 0..self.buffer.len().saturating_sub(missing);
        }
        let byte = self.unread.next().and_then(|index| self.buffer.get(index));
        byte.map_or(Received::Closed, |&byte| Received::Byte(byte))
    }

    fn send(&mut self, frame: &[u8], _purpose: Purpose) -> bool {
        transfer(nr::WRITE, self.output, frame.as_ptr() as usize, frame.len()) == 0
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
