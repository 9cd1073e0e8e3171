//! A pin that the table of boards or a microcontroller's file names at run time.
//!
//! The types of a hardware abstraction do not allow that. So this file writes the port's registers
//! itself. Sources: RM0090 section 8.4, RM0433 section 11.4 (GPIO registers).

use core::convert::Infallible;

use controller::boards::Port;
use embedded_hal::digital::{ErrorType, OutputPin};

use super::super::microcontroller::port::{FIRST, enable};

/// Distance of two ports.
const PORT_BYTES: usize = 0x400;
/// Offset of MODER: two bits a pin, 1 is output.
const MODE: usize = 0x00;
/// Offset of BSRR: bit n sets pin n, bit n + 16 resets it.
const SET_RESET: usize = 0x18;

/// Output pin.
#[derive(Debug)]
#[allow(unreachable_pub, reason = "part of the sensors' type of the STM32H743 only")]
pub struct Pin {
    port: Port,
    pin: u8,
}

impl Pin {
    /// Makes a pin an output of a level.
    pub(in crate::boards) fn output(port: Port, pin: u8, is_high: bool) -> Self {
        let mut output = Self { port, pin };
        enable(port);
        output.set(is_high);
        output.change(MODE, 2, 1);
        output
    }

    /// Sets the level.
    pub(in crate::boards) fn set(&mut self, is_high: bool) {
        let bit = u32::from(self.pin & 15) | if is_high { 0 } else { 16 };
        #[expect(unsafe_code, reason = "BSRR changes this pin alone")]
        unsafe {
            self.register(SET_RESET).write_volatile(1 << bit);
        }
    }

    /// Changes the pin's field in a register with `bits` a pin. Once, during start-up.
    fn change(&self, offset: usize, bits: u32, value: u32) {
        let shift = u32::from(self.pin & 15).wrapping_mul(bits) & 31;
        let mask = (1_u32 << (bits & 31)).wrapping_sub(1);
        let register = self.register(offset);
        #[expect(unsafe_code, reason = "register of the port, changed during start-up only")]
        unsafe {
            register.write_volatile(register.read_volatile() & !(mask << shift) | value << shift);
        }
    }

    /// Address of a register of the pin's port.
    fn register(&self, offset: usize) -> *mut u32 {
        FIRST.wrapping_add((self.port as usize).wrapping_mul(PORT_BYTES)).wrapping_add(offset) as *mut u32
    }
}

/// Functions of pins that are no plain outputs.
#[cfg(feature = "stm32h743")]
impl Pin {
    /// Connects a pin to a peripheral.
    pub(in crate::boards) fn connect(port: Port, pin: u8, function: u32) {
        /// Offset of OSPEEDR: two bits a pin, 2 is high.
        const SPEED: usize = 0x08;
        /// Offset of AFRL, for pins 0 to 7; AFRH follows.
        const FUNCTION: usize = 0x20;
        let connected = Self { port, pin };
        enable(port);
        connected.change(SPEED, 2, 2);
        let half = if pin < 8 { 0 } else { 4 };
        Self { port, pin: pin & 7 }.change(FUNCTION.wrapping_add(half), 4, function);
        connected.change(MODE, 2, 2);
    }
}

impl ErrorType for Pin {
    type Error = Infallible;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.set(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.set(true);
        Ok(())
    }
}
