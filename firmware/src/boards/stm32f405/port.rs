//! Addresses and clocks of the GPIO ports. Source: RM0090 sections 2.3 and 7.3.10 (AHB1ENR).

use controller::boards::Port;
use stm32f4xx_hal::pac::RCC;

/// Address of port A.
pub(in crate::boards) const FIRST: usize = 0x4002_0000;

/// Enables the clock of a port.
pub(in crate::boards) fn enable(port: Port) {
    #[expect(unsafe_code, reason = "sets one clock enable bit during start-up, where nothing else runs")]
    unsafe {
        (*RCC::ptr()).ahb1enr().modify(|r, w| w.bits(r.bits() | 1 << port as u8));
    }
}
