//! Boards and their microcontrollers.
//!
//! Sources: Adafruit product 4382, Olimex STM32-H405 user's manual, Netduino Plus 2 schematic,
//! RM0090 table 5 (flash sectors of the STM32F405), RM0433 sections 2.4 and 4.3 (memories and flash
//! sectors of the STM32H743), UM2407 (Nucleo-144), Arm DAI 0505 (memories of the AN505).

use super::memory_map::MemoryMap;
use super::signals::{self, Port, Signals};

/// Properties that all boards with one microcontroller share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Microcontroller {
    /// Feature of the crate `firmware`.
    pub feature: &'static str,
    /// Compilation target.
    pub target: &'static str,
    /// Memory map that the firmware links with.
    pub memory_map: MemoryMap,
    /// Start addresses of the flash sectors that an image may occupy.
    pub flash_sectors: &'static [u32],
    /// Upper bound on the cycles of a tick with own sensors; `None` if it exists in the emulator
    /// only.
    pub handler_cycles: Option<u32>,
    /// Name of the microcontroller in probe-rs; `None` if it exists in the emulator only.
    pub probe_name: Option<&'static str>,
    /// Interrupts that the firmware's board file declares itself; a device crate declares its own.
    pub declared_interrupts: &'static [&'static str],
    /// Pins of the signals; `None` if it exists in the emulator only.
    pub signals: Option<&'static Signals>,
}

impl Microcontroller {
    /// Decides whether the microcontroller exists in the emulator only.
    #[must_use]
    pub const fn is_emulated_only(&self) -> bool {
        self.probe_name.is_none()
    }

    /// Returns the shortest period of own samples in us, at a core frequency in Hz: that of
    /// [`Microcontroller::handler_cycles`], or 0 without one.
    #[must_use]
    pub fn shortest_period_us(&self, core_hz: u32) -> u32 {
        let core_mhz = (core_hz / 1_000_000).max(1);
        self.handler_cycles.unwrap_or(0).div_ceil(core_mhz)
    }
}

/// An indicator light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Light {
    /// GPIO port.
    pub port: Port,
    /// Number of the pin in the port.
    pub pin: u8,
    /// True if a low level switches the light on.
    pub is_active_low: bool,
}

/// Source of the clock outside the microcontroller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExternalClock {
    /// Crystal at the microcontroller's oscillator.
    Crystal {
        /// Frequency, MHz.
        mhz: u8,
    },
    /// Clock signal that bypasses the oscillator.
    Signal {
        /// Frequency, MHz.
        mhz: u8,
    },
}

impl ExternalClock {
    /// Frequency, MHz.
    #[must_use]
    pub const fn mhz(self) -> u8 {
        match self {
            Self::Crystal { mhz } | Self::Signal { mhz } => mhz,
        }
    }
}

/// A board that an image can be built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    /// Name for `--board`.
    pub name: &'static str,
    /// Name of the product.
    pub title: &'static str,
    /// Microcontroller.
    pub microcontroller: &'static Microcontroller,
    /// True if the emulator runs the image. It ignores stores to flash, so that the image needs RAM
    /// in place of flash.
    pub is_emulated: bool,
    /// Clock from outside; `None` if it is unknown or absent.
    pub external_clock: Option<ExternalClock>,
    /// Indicator light; `None` if there is none to use.
    pub light: Option<Light>,
    /// Header labels of [`Microcontroller::signals`], in their order; `None` for an image that
    /// serves several boards.
    pub labels: Option<[&'static str; SIGNAL_COUNT]>,
}

/// Number of signals.
const SIGNAL_COUNT: usize = size_of::<Signals>() / size_of::<super::Signal>();

/// STM32F405: Cortex-M4F.
static STM32F405: Microcontroller = Microcontroller {
    feature: "stm32f405",
    target: "thumbv7em-none-eabihf",
    memory_map: MemoryMap { path: "memory.x", text: include_str!("../../../../memory.x") },
    flash_sectors: &[
        0x0800_0000,
        0x0800_4000,
        0x0800_8000,
        0x0800_C000,
        0x0801_0000,
        0x0802_0000,
        0x0804_0000,
        0x0806_0000,
    ],
    // Above the longest tick in `tests/golden/cycles.json` by a quarter or more, for sensors and
    // supervision. Not measured on a board.
    handler_cycles: Some(50_000),
    probe_name: Some("STM32F405RGTx"),
    declared_interrupts: &[],
    signals: Some(&signals::STM32F405),
};

/// STM32H743: Cortex-M7.
static STM32H743: Microcontroller = Microcontroller {
    feature: "stm32h743",
    target: "thumbv7em-none-eabihf",
    // FLASH is bank 1; bank 2 holds what is written at run time. Stack and statics are in the data
    // TCM, which has no wait states. DMA cannot reach it: its buffers are in SRAM1 of domain D2.
    memory_map: MemoryMap {
        path: "crates/controller/src/boards/table.rs",
        text: "
MEMORY
{
  FLASH : ORIGIN = 0x08000000, LENGTH = 1024K
  STACK : ORIGIN = 0x20000000, LENGTH = 48K
  RAM   : ORIGIN = 0x2000C000, LENGTH = 80K
  DMA   : ORIGIN = 0x30000000, LENGTH = 128K
}
_stack_end = ORIGIN(STACK);
_stack_start = ORIGIN(STACK) + LENGTH(STACK);
_dma_start = ORIGIN(DMA);
SECTIONS
{
  .dma (NOLOAD) : { *(.dma .dma.*) } > DMA
}
INSERT AFTER .uninit;
/* The interrupts have the same names on every board. */
USART3 = SERIAL;
DMA2_STR3 = SAMPLED;
",
    },
    flash_sectors: &[
        0x0800_0000,
        0x0802_0000,
        0x0804_0000,
        0x0806_0000,
        0x0808_0000,
        0x080A_0000,
        0x080C_0000,
        0x080E_0000,
    ],
    // Above the longest tick with empty caches by a quarter or more, as for the STM32F405. A tick
    // from tightly coupled memory would take a third. Not measured on a board.
    handler_cycles: Some(110_000),
    probe_name: Some("STM32H743ZITx"),
    declared_interrupts: &[],
    signals: Some(&signals::STM32H743),
};

/// Arm MPS2+ with image AN505: Cortex-M33.
static MPS2_AN505: Microcontroller = Microcontroller {
    feature: "mps2-an505",
    target: "thumbv8m.main-none-eabihf",
    // Secure aliases of the code memory (SSRAM1) and of the internal RAM. The stack lies at the
    // bottom of the RAM, as on the other boards. The core's stack limit guards it.
    memory_map: MemoryMap {
        path: "crates/controller/src/boards/table.rs",
        text: "
MEMORY
{
  FLASH : ORIGIN = 0x10000000, LENGTH = 4M
  STACK : ORIGIN = 0x38000000, LENGTH = 48K
  RAM   : ORIGIN = 0x3800C000, LENGTH = 80K
}
_stack_end = ORIGIN(STACK);
_stack_start = ORIGIN(STACK) + LENGTH(STACK);
",
    },
    flash_sectors: &[],
    handler_cycles: None,
    probe_name: None,
    declared_interrupts: &["SERIAL", "SAMPLED"],
    signals: None,
};

/// Every board. The first one of a microcontroller is the default for its feature.
pub static BOARDS: [Board; 6] = [
    Board {
        name: "stm32f405",
        title: "any board with an STM32F405",
        microcontroller: &STM32F405,
        is_emulated: true,
        external_clock: None,
        light: None,
        labels: None,
    },
    Board {
        name: "feather-stm32f405",
        title: "Adafruit Feather STM32F405",
        microcontroller: &STM32F405,
        is_emulated: false,
        external_clock: Some(ExternalClock::Crystal { mhz: 12 }),
        light: Some(Light { port: Port::C, pin: 1, is_active_low: false }),
        labels: Some(["D6", "D5", "SCK", "MISO", "MOSI", "D10", "D9"]),
    },
    Board {
        name: "olimex-stm32-h405",
        title: "Olimex STM32-H405",
        microcontroller: &STM32F405,
        is_emulated: false,
        external_clock: Some(ExternalClock::Crystal { mhz: 8 }),
        light: Some(Light { port: Port::C, pin: 12, is_active_low: true }),
        labels: Some(["PC6", "PC7", "PB13", "PB14", "PB15", "PB9", "PB8"]),
    },
    Board {
        name: "netduino-plus-2",
        title: "Netduino Plus 2",
        microcontroller: &STM32F405,
        is_emulated: true,
        external_clock: Some(ExternalClock::Crystal { mhz: 25 }),
        light: Some(Light { port: Port::A, pin: 10, is_active_low: false }),
        labels: Some(["D1", "D0", "D13", "D12", "D11", "D6", "D5"]),
    },
    Board {
        name: "nucleo-h743zi2",
        title: "ST NUCLEO-H743ZI2",
        microcontroller: &STM32H743,
        is_emulated: false,
        external_clock: Some(ExternalClock::Signal { mhz: 8 }),
        light: Some(Light { port: Port::B, pin: 0, is_active_low: false }),
        labels: Some(["ST-LINK", "ST-LINK", "D13", "D12", "D11", "D10", "D9"]),
    },
    Board {
        name: "mps2-an505",
        title: "Arm MPS2+ with image AN505",
        microcontroller: &MPS2_AN505,
        is_emulated: true,
        external_clock: None,
        light: None,
        labels: None,
    },
];

impl Board {
    /// File name of the image that `cargo xtask firmware` builds: a board that shares its target
    /// with the default board gets a separate file.
    pub fn image_name(&self) -> impl core::fmt::Display {
        let [default, ..] = &BOARDS;
        let is_shared = self.microcontroller.target == default.microcontroller.target;
        ImageName((is_shared && self.name != default.name).then_some(self.name))
    }
}

struct ImageName(Option<&'static str>);

impl core::fmt::Display for ImageName {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self.0 {
            Some(name) => write!(f, "estimator-{name}"),
            None => f.write_str("estimator"),
        }
    }
}

/// Error of [`parse`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownBoard;

impl core::fmt::Display for UnknownBoard {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("expected one of ")?;
        for (index, board) in BOARDS.iter().enumerate() {
            write!(f, "{}{}", if index == 0 { "" } else { ", " }, board.name)?;
        }
        Ok(())
    }
}

impl core::error::Error for UnknownBoard {}

/// Parses the argument of `--board`.
///
/// # Errors
///
/// No board has this name; the error lists the names.
pub fn parse(name: &str) -> Result<Board, UnknownBoard> {
    find(name).copied().ok_or(UnknownBoard)
}

/// Returns the board of a name, also at compile time.
#[must_use]
pub const fn find(name: &str) -> Option<&'static Board> {
    let mut remaining: &[Board] = &BOARDS;
    while let [board, others @ ..] = remaining {
        if is_same(board.name.as_bytes(), name.as_bytes()) {
            return Some(board);
        }
        remaining = others;
    }
    None
}

const fn is_same(mut left: &[u8], mut right: &[u8]) -> bool {
    while let ([a, more_left @ ..], [b, more_right @ ..]) = (left, right) {
        if *a != *b {
            return false;
        }
        (left, right) = (more_left, more_right);
    }
    left.is_empty() && right.is_empty()
}
