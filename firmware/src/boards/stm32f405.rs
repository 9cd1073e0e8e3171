//! STM32F405 start-up: who am I, clocks, link, timers.

use link::{BuildId, ClockSource, Target};
use stm32f4xx_hal::gpio::GpioExt;
use stm32f4xx_hal::pac;

use super::clock_tree::ClockTree;
use super::{Files, Receiver, Timer, Transmitter, serial};
use crate::clock::{Clocks, INTERNAL_HZ, bring_up};
use crate::session::Identity;

/// Name of this build: `git describe`, or the crate's version.
const BUILD_ID: &str = match option_env!("PINTLE_BUILD_ID") {
    Some(id) => id,
    None => env!("CARGO_PKG_VERSION"),
};

/// The board's crystal, MHz, when the build was told of it (`PINTLE_CRYSTAL_MHZ=8|12|25`).
const CRYSTAL_MHZ: Option<u8> = match option_env!("PINTLE_CRYSTAL_MHZ") {
    Some(mhz) => match mhz.as_bytes() {
        b"8" => Some(8),
        b"12" => Some(12),
        b"25" => Some(25),
        _ => panic!("PINTLE_CRYSTAL_MHZ must be 8, 12 or 25"),
    },
    None => None,
};

/// SysTick's frequency on the emulator, Hz, whatever the clock registers say.
const EMULATOR_HZ: u32 = 168_000_000;

/// What the link goes over.
pub enum Link {
    /// Files of the host: lockstep, a frame is a tick.
    Files(Files),
    /// The serial port: SysTick paces.
    Serial(Transmitter),
}

/// The started board.
pub struct Board {
    /// What to say in the greeting.
    pub identity: Identity,
    /// The link.
    pub link: Link,
    /// The serial port's receiving half, for its interrupt.
    pub receiver: Receiver,
    /// The counter of a tick's work.
    pub timer: Timer,
}

/// Starts the board. Every wait in here is bounded.
#[must_use]
pub fn start(core: cortex_m::Peripherals, device: pac::Peripherals) -> Board {
    // The device number reads 0x413 on silicon; the emulator models nothing there and gives 0.
    let target = if device.DBGMCU.idcode().read().bits() == 0 { Target::Emulator } else { Target::Silicon };
    let clocks = match target {
        Target::Silicon => bring_up(&mut ClockTree { rcc: &device.RCC, flash: &device.FLASH }, CRYSTAL_MHZ),
        // The emulator ignores the clock registers.
        _ => Clocks { source: ClockSource::Internal, core_hz: EMULATOR_HZ },
    };
    let files = if target == Target::Emulator { Files::open() } else { None };

    device.RCC.apb1enr().modify(|_, w| w.usart3en().set_bit());
    let bus_hz = match clocks.source {
        ClockSource::PllCrystal | ClockSource::PllInternal => clocks.core_hz / 4,
        ClockSource::Crystal => clocks.core_hz,
        ClockSource::Internal | ClockSource::Host => INTERNAL_HZ,
    };
    let pins = device.GPIOB.split(&mut stm32f4xx_hal::rcc::RccExt::constrain(device.RCC));
    let _ = (pins.pb10.into_alternate::<7>(), pins.pb11.into_alternate::<7>());
    serial::set_up(&device.USART3, bus_hz);
    let (receiver, transmitter) = serial::split(device.USART3);

    let paced = files.is_none();
    let timer = Timer::start(core.SYST, core.DCB, core.DWT, clocks.core_hz, paced);
    let identity =
        Identity { build_id: BuildId::new(BUILD_ID), target, clock: clocks.source, core_hz: clocks.core_hz };
    let link = files.map_or(Link::Serial(transmitter), Link::Files);
    Board { identity, link, receiver, timer }
}
