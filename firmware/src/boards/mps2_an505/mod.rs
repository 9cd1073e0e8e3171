//! Arm MPS2+ with image AN505 (Cortex-M33), the example of a board with another core.
//!
//! There is no hardware abstraction crate: the device is declared in [`device`]. The board runs as
//! the emulator's `mps2-an505`, in lockstep over files or, without a bench, over UART0. It has no
//! independent watchdog and no reset flags; its light is not used. Sources: Arm DAI 0505 (memory
//! map, interrupts), Arm DDI 0479 (CMSDK APB UART).

mod absent;
mod serial;

// Provides the vector table and the reset handler.
use cortex_m_rt as _;
use link::start::ResetReason;
use link::{ClockSource, Target};

pub(super) use absent::Sectors;
pub use absent::{Collector, Light, Sensors, Watchdog};
pub use serial::Receiver;
pub(super) use serial::{Inbox, Transmitter};

use super::image::build_id;
use super::started::{Board, Link};
use super::timer::{self, Source};
use super::{Files, Probe, Storage, Timer, fault, guard};
use controller::session::Identity;

/// Board code of model packages.
pub const PACKAGES_FOR: u16 = model_package::board::MPS2_AN505;

/// System clock, Hz; SysTick counts it.
const CORE_HZ: u32 = 20_000_000;

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
        /// Reserved by the board, which has no samples.
        SAMPLED = 31,
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
        fn SAMPLED();
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
        if let Some(last) = vectors.last_chunk_mut() {
            *last = [Vector { handler: SAMPLED }, Vector { handler: SERIAL }];
        }
        vectors
    };
}

/// Starts the board.
#[must_use]
pub fn start(core: cortex_m::Peripherals, _device: device::Peripherals) -> Board {
    guard::set(&core.MPU);
    let start = fault::start_report(ResetReason::Unknown);
    let (receiver, inbox, transmitter) = serial::set_up(CORE_HZ);
    let files = Files::open();
    let paced = files.is_none();
    let pacing = Source::of(paced, Target::Emulator, None);
    let (timer, pacer) = Timer::start(core.SYST, core.DCB, core.DWT, CORE_HZ, pacing);
    let identity = Identity {
        build_id: build_id(),
        target: Target::Emulator,
        clock: ClockSource::Internal,
        core_hz: CORE_HZ,
    };
    Board {
        identity,
        start,
        link: files.map_or(Link::Serial(transmitter, Probe::new()), Link::Files),
        receiver,
        inbox,
        timer,
        pacer,
        watchdog: Watchdog,
        light: Light,
        attendance: timer::attendance(paced),
        storage: Storage::new(None),
        sensors: None,
        collector: Collector,
    }
}
