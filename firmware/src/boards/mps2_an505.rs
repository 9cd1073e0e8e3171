//! Arm MPS2+ with the image AN505 (Cortex-M33): the whole board in one file, as another core wants it.
//!
//! No hardware abstraction crate: the device is the few lines in [`device`]. Runs on the emulator's `mps2-an505`, in lockstep over files
//! or, not paced by a bench, over UART0. The board has no independent watchdog worth the name and no reset flags; its light is left dark.
//! Sources: Arm DAI 0505 (memory map, interrupts), Arm DDI 0479 (CMSDK APB UART).

// Brings the vector table and the reset handler, which no device crate does here.
use cortex_m_rt as _;
use link::start::ResetReason;
use link::track::SensorStatus;
use link::{BuildId, ClockSource, LineErrors, SensorFrame, Target};

use super::{BUILD_ID, Board, Came, Files, Link, Probe, Storage, Timer, fault, guard, timer};
use crate::sensors::Wiring;
use crate::session::Identity;

/// The board that model packages must be made for.
pub const PACKAGES_FOR: u16 = model_package::board::MPS2_AN505;

/// The system clock, Hz, from which SysTick counts.
const CORE_HZ: u32 = 20_000_000;
/// Line speed, baud.
const BAUD: u32 = 500_000;
/// Polls for room in the transmitter before a byte is given up.
const POLLS: u32 = 20_000;

/// The device as the task framework wants it.
pub mod device {
    #![expect(
        unsafe_code,
        reason = "what a device crate is made of: interrupt numbers (each of one interrupt), the vector table, the one instance"
    )]

    /// Bits of an interrupt's priority.
    pub const NVIC_PRIO_BITS: u8 = 3;

    /// The interrupts in use.
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

    /// The peripherals: UART0 is all that is used.
    pub struct Peripherals(());

    impl Peripherals {
        /// The peripherals once more.
        ///
        /// # Safety
        ///
        /// Nobody else may hold them.
        #[must_use]
        pub const unsafe fn steal() -> Self {
            Self(())
        }
    }

    unsafe extern "C" {
        fn SERIAL();
    }

    /// A place in the vector table.
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

/// The receiving half, for the interrupt.
pub struct Receiver(());

impl Receiver {
    /// What has come. This port knows of overruns only.
    pub fn fetch(&mut self) -> Came {
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
        Came { byte, errors: LineErrors { overruns, ..LineErrors::default() } }
    }
}

/// Nothing comes in without interrupts.
pub struct Inbox(());

impl Inbox {
    /// No byte.
    pub fn take(&mut self) -> Option<u8> {
        None
    }

    /// None.
    pub fn lost(&self) -> u32 {
        0
    }
}

/// The sending half.
pub struct Transmitter(());

impl Transmitter {
    /// Sends bytes, waiting a bounded time for each; false if the port did not take them all.
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
    /// Nothing to kick.
    pub fn kick(&mut self) {}
}

/// No sensors: there is nothing to make them of.
pub enum Sensors {}

impl Sensors {
    /// Never called.
    pub fn latest(&self) -> SensorFrame {
        match *self {}
    }

    /// Never called.
    pub fn rewire(&mut self, _wiring: Wiring) {
        match *self {}
    }

    /// Never called.
    pub fn sample(&mut self, _time_us: u32) -> (SensorFrame, SensorStatus) {
        match *self {}
    }
}

/// No light.
pub struct Light(());

impl Light {
    /// Nothing to switch.
    pub fn show(&mut self, _on: bool) {}
}

/// Starts the board.
#[must_use]
pub fn start(core: cortex_m::Peripherals, _device: device::Peripherals) -> Board {
    guard::set();
    let start = fault::start_report(ResetReason::Unknown);
    // Send, receive, and an interrupt for what is received.
    const CONTROL: u32 = 0b1011;
    write(register!(divider), CORE_HZ / BAUD);
    write(register!(control), CONTROL);
    let files = Files::open();
    let paced = files.is_none();
    let timer = Timer::start(core.SYST, core.DCB, core.DWT, CORE_HZ, Target::Emulator, paced);
    let identity = Identity {
        build_id: BuildId::new(BUILD_ID),
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
        watchdog: Watchdog(()),
        light: Light(()),
        attendance: timer::attendance(paced),
        storage: Storage::in_ram(),
        sensors: None,
    }
}
