//! Addresses and clocks of the GPIO ports. Source: RM0433 sections 2.3 and 8.7.43 (AHB4ENR).

use controller::boards::Port;
use stm32h7::stm32h743v::RCC;

/// Address of port A.
pub(in crate::boards) const FIRST: usize = 0x5802_0000;

/// Enables the clock of a port.
pub(in crate::boards) fn enable(port: Port) {
    #[expect(unsafe_code, reason = "sets one clock enable bit during start-up, where nothing else runs")]
    unsafe {
        let register = (*RCC::ptr()).ahb4enr();
        register.modify(|r, w| w.bits(r.bits() | 1 << port as u8));
        // The clock runs two of its cycles after the write.
        let _ = register.read().bits();
    }
}
