//! Start-up of the STM32H743: reason of the start, watchdog, guard, caches, clocks, link, timers.
//!
//! No emulator models this microcontroller. It has been built, linked and checked for size, stack
//! and panics only.

pub(super) mod bus;
mod caches;
mod clock_tree;
pub(super) mod port;
pub(super) mod sectors;
mod serial;

use controller::boards::{ExternalClock, Port};
use controller::clock::bring_up;
use controller::session::Identity;
use controller::supervisor::start::{ResetFlags, reason_of_flags};
use link::Target;
pub(super) use stm32h7::stm32h743v as pac;

pub(super) use super::stm32::Sectors;
pub use super::stm32::{Collector, Light, Sensors, Watchdog};
pub use serial::Receiver;
pub(super) use serial::{Inbox, Transmitter};

use super::image::{BOARD, build_id};
use super::started::{Board, Link};
use super::stm32::{Acquisition, Pin, sampler};
use super::timer::{self, Source};
use super::{Probe, Storage, Timer, fault, guard};
use clock_tree::ClockTree;

/// The device for the task framework.
pub mod device {
    pub use stm32h7::stm32h743v::{NVIC_PRIO_BITS, Peripherals};

    /// Interrupts in use, named by their purpose. The memory map binds the names to the vector
    /// table's.
    #[derive(Clone, Copy, Debug)]
    #[repr(u16)]
    pub enum Interrupt {
        /// USART3 has received a byte with an error.
        SERIAL = stm32h7::stm32h743v::Interrupt::USART3 as u16,
        /// The words of a sample are complete.
        SAMPLED = stm32h7::stm32h743v::Interrupt::DMA2_STR3 as u16,
    }
    pub use Interrupt as interrupt;

    #[expect(unsafe_code, reason = "every value is the number of one interrupt")]
    unsafe impl cortex_m::interrupt::InterruptNumber for Interrupt {
        fn number(self) -> u16 {
            self as u16
        }
    }
}

/// Board code of model packages.
pub const PACKAGES_FOR: u16 = model_package::board::STM32H743;

/// Revision V in DBGMCU_IDC.
const REVISION_V: u16 = 0x2003;

/// Starts the board. Every wait has a timeout.
#[must_use]
pub fn start(mut core: cortex_m::Peripherals, device: device::Peripherals) -> Board {
    caches::protect(&core.MPU);
    guard::set(&core.MPU);
    // Before anything that could hang.
    device.DBGMCU.apb4fz1().modify(|_, w| w.dbg_iwdg1().set_bit());
    // The time base counts while a debugger halts the core.
    device.DBGMCU.apb1lfz1().modify(|_, w| w.dbg_tim4().clear_bit().dbg_tim5().clear_bit());
    let watchdog = Watchdog::start(device.IWDG);
    let start = fault::start_report(reason_of_flags(&ResetFlags::STM32H743, device.RCC.rsr().read().bits()));
    // The next start must find its own flags only.
    device.RCC.rsr().modify(|_, w| w.rmvf().set_bit());
    device.RCC.rsr().modify(|_, w| w.rmvf().clear_bit());
    caches::start(&mut core);

    let clocks = bring_up(
        &mut ClockTree {
            rcc: &device.RCC,
            flash: &device.FLASH,
            power: &device.PWR,
            system: &device.SYSCFG,
            allows_scale_0: device.DBGMCU.idc().read().rev_id().bits() == REVISION_V,
            is_signal: matches!(BOARD.external_clock, Some(ExternalClock::Signal { .. })),
            pll_hz: 0,
        },
        BOARD.external_clock.map(ExternalClock::mhz),
    );

    // Both peripherals run on the internal oscillator; that of the SPI is the default of `per_ck`.
    device.RCC.d2ccip1r().modify(|_, w| w.spi123sel().per());
    device.RCC.d2ccip2r().modify(|_, w| w.usart234578sel().hsi_ker());
    device.RCC.ahb1enr().modify(|_, w| w.dma1en().set_bit().dma2en().set_bit());
    device.RCC.ahb2enr().modify(|_, w| w.sram1en().set_bit());
    device.RCC.apb1lenr().modify(|_, w| w.usart3en().set_bit().tim4en().set_bit().tim5en().set_bit());
    device.RCC.apb2enr().modify(|_, w| w.spi1en().set_bit());
    // A clock runs two of its cycles after the write.
    let _ = (device.RCC.apb1lenr().read().bits(), device.RCC.apb2enr().read().bits());

    bus::connect(&device.DMAMUX1);
    // The timers run at half of the core's frequency.
    let (mut acquisition, collector) = Acquisition::start(clocks.core_hz / 2_000_000, bus::BUS_HZ);
    for (port, pin, function) in [
        (Port::D, 8, 7),
        (Port::D, 9, 7),
        (Port::A, 5, 5),
        (Port::A, 6, 5),
        (Port::B, 5, 5),
        (Port::D, 14, 2),
        (Port::D, 15, 2),
    ] {
        Pin::connect(port, pin, function);
    }
    let is_sampling = acquisition.try_out();
    let light = Light::start(BOARD.light);
    let (receiver, inbox, transmitter) = serial::set_up(device.USART3, device.DMA1, &device.DMAMUX1);

    // This core locks the registers of its cycle counter.
    core.DCB.enable_trace();
    cortex_m::peripheral::DWT::unlock();
    let target = Target::Silicon;
    let pacing = Source::of(true, target, is_sampling.then(|| acquisition.input_interval_ns()));
    let (timer, pacer) = Timer::start(core.SYST, core.DCB, core.DWT, clocks.core_hz, pacing);
    let identity = Identity { build_id: build_id(), target, clock: clocks.source, core_hz: clocks.core_hz };
    Board {
        identity,
        start,
        link: Link::Serial(transmitter, Probe::new()),
        receiver,
        inbox,
        timer,
        pacer,
        watchdog,
        light,
        attendance: timer::attendance(true),
        storage: Storage::new(Some([Sectors::MODELS, Sectors::CONFIGURATION])),
        sensors: if is_sampling { sampler(acquisition) } else { None },
        collector,
    }
}
