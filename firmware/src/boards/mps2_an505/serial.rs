//! The link over UART0. Source: Arm DDI 0479 (CMSDK APB UART).

use controller::boards::LINK_BAUD;
use link::LineErrors;

use crate::boards::receive_event::ReceiveEvent;

/// Polls for room in the transmitter before a byte is dropped.
const POLLS: u32 = 20_000;

/// UART0, secure alias: data, state, control, interrupt, divider.
#[repr(C)]
struct Registers {
    data: u32,
    state: u32,
    control: u32,
    interrupt: u32,
    divider: u32,
}

const UART0: *mut Registers = 0x5020_0000 as *mut Registers;

fn read(register: *const u32) -> u32 {
    #[expect(unsafe_code, reason = "called for registers of UART0 only; the halves use different ones")]
    unsafe {
        register.read_volatile()
    }
}

fn write(register: *mut u32, value: u32) {
    #[expect(unsafe_code, reason = "called for registers of UART0 only; the halves use different ones")]
    unsafe {
        register.write_volatile(value);
    }
}

macro_rules! register {
    ($name:ident) => {
        UART0.cast::<u32>().wrapping_add(core::mem::offset_of!(Registers, $name) / size_of::<u32>())
    };
}

/// Receiving half for the interrupt.
pub struct Receiver(());

impl Receiver {
    /// Reads the received byte and its errors. This port detects overruns only.
    pub(in crate::boards) fn fetch(&mut self) -> ReceiveEvent {
        const RECEIVED: u32 = 1 << 1;
        const OVERRUN: u32 = 1 << 3;
        write(register!(interrupt), RECEIVED);
        let state = read(register!(state));
        let overruns = u32::from(state & OVERRUN != 0);
        if overruns != 0 {
            write(register!(state), OVERRUN);
        }
        let full = state & RECEIVED != 0;
        let byte = full.then(|| read(register!(data)).to_le_bytes()).map(|[byte, ..]| byte);
        ReceiveEvent { byte, errors: LineErrors { overruns, ..LineErrors::default() } }
    }
}

/// No bytes arrive without interrupts.
pub struct Inbox(());

impl Inbox {
    /// Returns no byte.
    pub(in crate::boards) fn take(&mut self) -> Option<u8> {
        None
    }

    /// Returns 0.
    pub(in crate::boards) fn lost(&self) -> u32 {
        0
    }
}

/// Sending half.
pub struct Transmitter(());

impl Transmitter {
    /// Sends bytes, with a timeout for each. Returns false if the port did not take all.
    #[must_use]
    pub(in crate::boards) fn write(&mut self, bytes: &[u8]) -> bool {
        const FULL: u32 = 1;
        bytes.iter().all(|&byte| {
            let room = (0..POLLS).any(|_| read(register!(state)) & FULL == 0);
            if room {
                write(register!(data), byte.into());
            }
            room
        })
    }
}

/// Sets up the port for a clock of `core_hz`.
pub(in crate::boards) fn set_up(core_hz: u32) -> (Receiver, Inbox, Transmitter) {
    // Enables transmitter, receiver and receive interrupt.
    const CONTROL: u32 = 0b1011;
    write(register!(divider), core_hz / LINK_BAUD);
    write(register!(control), CONTROL);
    (Receiver(()), Inbox(()), Transmitter(()))
}
