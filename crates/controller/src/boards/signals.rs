//! The controller's signals and their pins on each microcontroller.
//!
//! Every board of the table has all of its microcontroller's pins on its headers, or connects them
//! itself.

/// A GPIO port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the name is the port's letter")]
pub enum Port {
    A,
    B,
    C,
    D,
    E,
}

/// A signal of the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signal {
    /// Function and direction, as in `docs/firmware.md`.
    pub name: &'static str,
    /// GPIO port.
    pub port: Port,
    /// Number of the pin in the port.
    pub pin: u8,
}

/// Every signal of a microcontroller. [`super::Board::labels`] has the same order.
pub type Signals = [Signal; 7];

/// Signals of the STM32F405. USART3, for example, is not used because its pins are a push button on
/// the Netduino Plus 2.
pub(super) static STM32F405: Signals = [
    Signal { name: "link out (USART6 TX)", port: Port::C, pin: 6 },
    Signal { name: "link in (USART6 RX)", port: Port::C, pin: 7 },
    Signal { name: "sensor clock (SPI2 SCK)", port: Port::B, pin: 13 },
    Signal { name: "sensor data in (SPI2 MISO)", port: Port::B, pin: 14 },
    Signal { name: "sensor data out (SPI2 MOSI)", port: Port::B, pin: 15 },
    Signal { name: "select of the converter (probes, load)", port: Port::B, pin: 9 },
    Signal { name: "select of the absolute encoder", port: Port::B, pin: 8 },
];

/// Signals of the STM32H743. PD8 and PD9 lead to the debugger of a Nucleo board, PB14 to a light.
pub(super) static STM32H743: Signals = [
    Signal { name: "link out (USART3 TX)", port: Port::D, pin: 8 },
    Signal { name: "link in (USART3 RX)", port: Port::D, pin: 9 },
    Signal { name: "sensor clock (SPI1 SCK)", port: Port::A, pin: 5 },
    Signal { name: "sensor data in (SPI1 MISO)", port: Port::A, pin: 6 },
    Signal { name: "sensor data out (SPI1 MOSI)", port: Port::B, pin: 5 },
    Signal { name: "select of the converter (probes, load)", port: Port::D, pin: 14 },
    Signal { name: "select of the absolute encoder", port: Port::D, pin: 15 },
];
