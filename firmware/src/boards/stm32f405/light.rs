//! The board's indicator light on the pin that the table of boards names; none for the image that
//! serves every board.
//!
//! The pin is chosen at run time, which the types of the hardware abstraction do not allow. So this
//! file writes the port's registers itself. Source: RM0090 sections 7.3.10 (AHB1ENR) and 8.4 (GPIO
//! registers).

use controller::boards::Light as Wiring;
use stm32f4xx_hal::pac::RCC;

/// Address of GPIOA; the ports follow each other in steps of [`PORT_BYTES`].
const FIRST_PORT: usize = 0x4002_0000;
const PORT_BYTES: usize = 0x400;
/// Offset of MODER: two bits a pin, 1 is output.
const MODE: usize = 0x00;
/// Offset of BSRR: bit n sets pin n, bit n + 16 resets it.
const SET_RESET: usize = 0x18;

/// The light, if the board has one.
pub struct Light(Option<Wiring>);

impl Light {
    /// Makes the pin an output and switches the light off.
    pub(in crate::boards) fn start(wiring: Option<Wiring>) -> Self {
        let mut light = Self(wiring);
        if let Some(wiring) = wiring {
            let Wiring { port, pin, .. } = wiring;
            #[expect(
                unsafe_code,
                reason = "sets one clock enable bit during start-up, where nothing else runs"
            )]
            unsafe {
                (*RCC::ptr()).ahb1enr().modify(|r, w| w.bits(r.bits() | 1 << port as u8));
            }
            light.show(false);
            let mode = register(wiring, MODE);
            let shift = u32::from(pin & 15).wrapping_mul(2);
            #[expect(unsafe_code, reason = "mode register of the port, changed during start-up only")]
            unsafe {
                mode.write_volatile(mode.read_volatile() & !(3 << shift) | 1 << shift);
            }
        }
        light
    }

    /// Switches the light on or off.
    pub fn show(&mut self, on: bool) {
        if let Some(wiring) = self.0 {
            let Wiring { pin, is_active_low, .. } = wiring;
            let bit = u32::from(pin & 15) | if on == is_active_low { 16 } else { 0 };
            #[expect(unsafe_code, reason = "BSRR changes this pin alone")]
            unsafe {
                register(wiring, SET_RESET).write_volatile(1 << bit);
            }
        }
    }
}

/// Address of a register of the light's port.
fn register(wiring: Wiring, offset: usize) -> *mut u32 {
    let port = wiring.port as usize;
    FIRST_PORT.wrapping_add(port.wrapping_mul(PORT_BYTES)).wrapping_add(offset) as *mut u32
}
