//! Arm MPS2+ with image AN505 (Cortex-M33), the example of a board with another core.
//!
//! There is no hardware abstraction crate: the device is declared in [`device`]. The board runs as
//! the emulator's `mps2-an505`, in lockstep over files or, without a bench, over UART0. It has no
//! independent watchdog and no reset flags; its light is not used. Sources: Arm DAI 0505 (memory
//! map, interrupts), Arm DDI 0479 (CMSDK APB UART).

// Provides the vector table and the reset handler.
use controller::boards::LINK_BAUD;
use cortex_m_rt as _;
use link::start::ResetReason;
use link::{ClockSource, LineErrors, Target};

use super::{Board, Files, Link, Probe, ReceiveEvent, Storage, Timer, build_id, fault, guard, timer};
use controller::session::Identity;
use controller::store::controller::FlashError;

/// Board code of model packages.
pub const PACKAGES_FOR: u16 = model_package::board::MPS2_AN505;

/// System clock, Hz; SysTick counts it.
const CORE_HZ: u32 = 20_000_000;
/// Polls for room in the transmitter before a byte is dropped.
const POLLS: u32 = 20_000;

/// The device for the task framework.
pub mod device {
    #![expect(
        unsafe_code,
        reason = "parts of a device crate: one number for each interrupt, the vector table, the only instance"
    )]

    /// Bits of an interrupt's priority.
    pub const NVIC_PRIO_BITS: u8 = 3;

    /// Interrupts in use.
    #[derive(Clone, Copy, Debug)]
    #[repr(u16)]
    pub enum Interrupt {
        /// UART0 has a byte.
        SERIAL = 32,
    }
    pub use Interrupt as interrupt;

    unsafe impl cortex_m::interrupt::InterruptNumber for Interrupt {
        fn number(self) -> u16 {
            self as u16
        }
    }

    /// The peripherals; only UART0 is used.
    pub struct Peripherals(());

    impl Peripherals {
        /// Returns a second instance.
        ///
        /// # Safety
        ///
        /// No other instance may be in use.
        #[must_use]
        pub const unsafe fn steal() -> Self {
            Self(())
        }
    }

    unsafe extern "C" {
        fn SERIAL();
    }

    /// Entry of the vector table.
    #[derive(Clone, Copy)]
    union Vector {
        handler: unsafe extern "C" fn(),
        reserved: usize,
    }

    /// Interrupts 0 to 32.
    #[unsafe(link_section = ".vector_table.interrupts")]
    #[unsafe(no_mangle)]
    static __INTERRUPTS: [Vector; 33] = {
        let mut vectors = [Vector { reserved: 0 }; 33];
        if let Some(last) = vectors.last_mut() {
            *last = Vector { handler: SERIAL };
        }
        vectors
    };
}

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
    pub fn fetch(&mut self) -> ReceiveEvent {
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
    pub fn take(&mut self) -> Option<u8> {
        None
    }

    /// Returns 0.
    pub fn lost(&self) -> u32 {
        0
    }
}

/// Sending half.
pub struct Transmitter(());

impl Transmitter {
    /// Sends bytes, with a timeout for each. Returns false if the port did not take all.
    #[must_use]
    pub fn write(&mut self, bytes: &[u8]) -> bool {
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

/// No watchdog.
pub struct Watchdog(());

impl Watchdog {
    /// Does nothing.
    pub fn kick(&mut self) {}
}

/// No sensors.
pub type Sensors = core::convert::Infallible;

/// No flash to write.
#[derive(Debug)]
pub(super) enum Sectors {}

impl Sectors {
    pub(super) const fn start(&self) -> usize {
        match *self {}
    }

    pub(super) const fn length(&self) -> usize {
        match *self {}
    }

    pub(super) fn erase(&mut self, _start: usize, _length: usize) -> Result<(), FlashError> {
        match *self {}
    }

    pub(super) fn program(&mut self, _address: usize, _bytes: &[u8]) -> Result<(), FlashError> {
        match *self {}
    }
}

/// No light.
pub struct Light(());

impl Light {
    /// Does nothing.
    pub fn show(&mut self, _on: bool) {}
}

/// Starts the board.
#[must_use]
pub fn start(core: cortex_m::Peripherals, _device: device::Peripherals) -> Board {
    guard::set(&core.MPU);
    let start = fault::start_report(ResetReason::Unknown);
    // Enables transmitter, receiver and receive interrupt.
    const CONTROL: u32 = 0b1011;
    write(register!(divider), CORE_HZ / LINK_BAUD);
    write(register!(control), CONTROL);
    let files = Files::open();
    let paced = files.is_none();
    let (timer, pacer) = Timer::start(core.SYST, core.DCB, core.DWT, CORE_HZ, Target::Emulator, paced);
    let identity = Identity {
        build_id: build_id(),
        target: Target::Emulator,
        clock: ClockSource::Internal,
        core_hz: CORE_HZ,
    };
    Board {
        identity,
        start,
        link: files.map_or(Link::Serial(Transmitter(()), Probe::new()), Link::Files),
        receiver: Receiver(()),
        inbox: Inbox(()),
        timer,
        pacer,
        watchdog: Watchdog(()),
        light: Light(()),
        attendance: timer::attendance(paced),
        storage: Storage::new(None),
        sensors: None,
    }
}
