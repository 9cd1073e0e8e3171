//! The controller's signals and their pins on the STM32F405.
//!
//! Every STM32F405 board of the table has all of these pins on its headers. USART3, for example, is
//! not used because its pins are a push button on the Netduino Plus 2.

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

/// A signal of the controller on the STM32F405.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signal {
    /// Function and direction, as in `docs/firmware.md`.
    pub name: &'static str,
    /// GPIO port.
    pub port: Port,
    /// Number of the pin in the port.
    pub pin: u8,
}

/// Every signal. [`super::Board::labels`] has the same order.
pub const SIGNALS: [Signal; 7] = [
    Signal { name: "link out (USART6 TX)", port: Port::C, pin: 6 },
    Signal { name: "link in (USART6 RX)", port: Port::C, pin: 7 },
    Signal { name: "sensor clock (SPI2 SCK)", port: Port::B, pin: 13 },
    Signal { name: "sensor data in (SPI2 MISO)", port: Port::B, pin: 14 },
    Signal { name: "sensor data out (SPI2 MOSI)", port: Port::B, pin: 15 },
    Signal { name: "select of the converter (probes, load)", port: Port::B, pin: 9 },
    Signal { name: "select of the absolute encoder", port: Port::B, pin: 8 },
];
