//! Start-up of the STM32F405: target, reason of the start, clocks, guard, watchdog, link, timers.

pub(super) mod bus;
mod clock_tree;
pub(super) mod port;
pub(super) mod sectors;
mod serial;

use link::{ClockSource, Target};
use stm32f4xx_hal::gpio::{GpioExt, Speed};
pub(super) use stm32f4xx_hal::pac;
use stm32f4xx_hal::rcc::RccExt;

pub(super) use super::stm32::Sectors;
pub use super::stm32::{Collector, Light, Sensors, Watchdog};
pub use serial::Receiver;
pub(super) use serial::{Inbox, Transmitter};

use super::image::{BOARD, build_id};
use super::started::{Board, Link};
use super::stm32::{Acquisition, sampler};
use super::timer::{self, Source};
use super::{Files, Probe, Storage, Timer, fault, guard};
use clock_tree::ClockTree;
use controller::boards::ExternalClock;
use controller::clock::{Clocks, INTERNAL_HZ, bring_up};
use controller::session::Identity;
use controller::supervisor::start::{ResetFlags, reason_of_flags};

/// The device for the task framework.
pub mod device {
    pub use stm32f4xx_hal::pac::{NVIC_PRIO_BITS, Peripherals};

    /// Interrupts in use, named by their purpose. The memory map binds the names to the vector
    /// table's.
    #[derive(Clone, Copy, Debug)]
    #[repr(u16)]
    pub enum Interrupt {
        /// USART6 has a byte.
        SERIAL = stm32f4xx_hal::pac::Interrupt::USART6 as u16,
        /// The words of a sample are complete.
        SAMPLED = stm32f4xx_hal::pac::Interrupt::DMA1_STREAM3 as u16,
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
pub const PACKAGES_FOR: u16 = model_package::board::STM32F405;

/// Returns the clocks of both peripherals' buses and of the timers, Hz.
fn bus_clocks(clocks: Clocks) -> [u32; 3] {
    match clocks.source {
        ClockSource::PllCrystal | ClockSource::PllInternal => {
            [4, 2, 2].map(|divider| clocks.core_hz / divider)
        }
        ClockSource::Crystal => [clocks.core_hz; 3],
        ClockSource::Internal | ClockSource::Host => [INTERNAL_HZ; 3],
    }
}

/// Starts the board. Every wait has a timeout.
#[must_use]
pub fn start(core: cortex_m::Peripherals, device: device::Peripherals) -> Board {
    guard::set(&core.MPU);
    let start = fault::start_report(reason_of_flags(&ResetFlags::STM32F405, device.RCC.csr().read().bits()));
    // The next start must find its own flags only.
    device.RCC.csr().modify(|_, w| w.rmvf().set_bit());
    // Before anything that could hang.
    device.DBGMCU.apb1_fz().modify(|_, w| {
        // The time base counts while a debugger halts the core.
        w.dbg_iwdg_stop().set_bit().dbg_tim4_stop().clear_bit().dbg_tim5_stop().clear_bit()
    });
    let watchdog = Watchdog::start(device.IWDG);

    // The device number reads 0x413 on silicon; the emulator models nothing there and gives 0.
    let target = if device.DBGMCU.idcode().read().bits() == 0 { Target::Emulator } else { Target::Silicon };
    let clocks = match target {
        Target::Silicon => {
            let crystal_mhz = BOARD.external_clock.map(ExternalClock::mhz);
            bring_up(&mut ClockTree { rcc: &device.RCC, flash: &device.FLASH }, crystal_mhz)
        }
        // The emulator ignores the clock registers.
        _ => Clocks { source: ClockSource::Internal, core_hz: controller::emulator::SYSTICK_HZ },
    };
    let files = if target == Target::Emulator { Files::open() } else { None };

    device.RCC.apb2enr().modify(|_, w| w.usart6en().set_bit());
    device.RCC.ahb1enr().modify(|_, w| w.dma1en().set_bit().dma2en().set_bit());
    device.RCC.apb1enr().modify(|_, w| w.spi2en().set_bit().tim4en().set_bit().tim5en().set_bit());
    // The clocks run two of their cycles after the write.
    let _ = (device.RCC.ahb1enr().read().bits(), device.RCC.apb1enr().read().bits());
    let [slow_hz, bus_hz, timer_hz] = bus_clocks(clocks);
    // The emulator has no DMA: no sequence runs there.
    let sensors_hz = if target == Target::Silicon { slow_hz / bus::BUS_DIVIDER } else { 0 };
    let (mut acquisition, collector) = Acquisition::start(timer_hz / 1_000_000, sensors_hz);
    let mut rcc = device.RCC.constrain();
    let (port_b, port_c) = (device.GPIOB.split(&mut rcc), device.GPIOC.split(&mut rcc));
    let _ = (port_c.pc6.into_alternate::<8>(), port_c.pc7.into_alternate::<8>());
    let light = Light::start(BOARD.light);
    let fast = Speed::High;
    let _ = (
        port_b.pb13.into_alternate::<5>().speed(fast),
        port_b.pb14.into_alternate::<5>(),
        port_b.pb15.into_alternate::<5>().speed(fast),
        port_b.pb8.into_alternate::<2>().speed(fast),
        port_b.pb9.into_alternate::<2>().speed(fast),
    );
    let is_sampling = target == Target::Silicon && acquisition.try_out();
    // The emulator has no DMA.
    let (receiver, inbox, transmitter) =
        serial::set_up(device.USART6, device.DMA2, bus_hz, target == Target::Silicon);

    let paced = files.is_none();
    let pacing = Source::of(paced, target, is_sampling.then(|| acquisition.input_interval_ns()));
    let (timer, pacer) = Timer::start(core.SYST, core.DCB, core.DWT, clocks.core_hz, pacing);
    let sensors = if target == Target::Emulator || is_sampling { sampler(acquisition) } else { None };
    let identity = Identity { build_id: build_id(), target, clock: clocks.source, core_hz: clocks.core_hz };
    let link = files.map_or(Link::Serial(transmitter, Probe::new()), Link::Files);
    // The emulator ignores stores to flash.
    let storage =
        Storage::new((target == Target::Silicon).then_some([Sectors::MODELS, Sectors::CONFIGURATION]));
    let attendance = timer::attendance(paced);
    Board {
        identity,
        start,
        link,
        receiver,
        inbox,
        timer,
        pacer,
        watchdog,
        light,
        attendance,
        storage,
        sensors,
        collector,
    }
}
