//! The link over USART6: PC6 out, PC7 in, 500 kbaud, 8N1.
//!
//! 500 kbaud divides every clock that bring-up can arrive at without remainder. It carries about 1,000 exchanges a second; the
//! sample period of a bench on this link is 1 ms. A byte that nobody fetched in time is lost and shows as a bad frame.

use stm32f4xx_hal::pac::USART6;

/// Line speed, baud.
pub(in crate::boards) const BAUD: u32 = 500_000;

/// Polls for room in the transmitter before a byte is given up: some 20 byte times at 168 MHz.
const POLLS: u32 = 20_000;

/// Sets the port up for a peripheral clock of `bus_hz`. Its clock and pins must be on.
pub(in crate::boards) fn set_up(port: &USART6, bus_hz: u32) {
    // At 16-fold oversampling the register holds the clock over the baud rate, fraction included.
    let divider = u16::try_from(bus_hz / BAUD).unwrap_or(u16::MAX);
    port.brr().write(|w| {
        #[expect(unsafe_code, reason = "the whole divider, mantissa and fraction, in one")]
        unsafe {
            w.bits(divider)
        }
    });
    port.cr1().write(|w| w.ue().set_bit().te().set_bit().re().set_bit().rxneie().set_bit());
}

/// The receiving half, for the interrupt.
pub struct Receiver(());

/// The sending half.
pub struct Transmitter(());

/// Gives the halves out, once.
pub(in crate::boards) const fn split(_port: USART6) -> (Receiver, Transmitter) {
    (Receiver(()), Transmitter(()))
}

fn port() -> &'static stm32f4xx_hal::pac::usart6::RegisterBlock {
    #[expect(unsafe_code, reason = "the halves own the port: one reads DR, the other writes it")]
    unsafe {
        &*USART6::ptr()
    }
}

impl Receiver {
    /// The byte that has come, if one has. Reading it clears the interrupt and any line error.
    pub fn fetch(&mut self) -> Option<u8> {
        let status = port().sr().read();
        let pending = status.rxne().bit_is_set() || status.ore().bit_is_set();
        pending
            .then(|| port().dr().read().bits().to_le_bytes())
            .and_then(|[low, ..]| status.rxne().bit().then_some(low))
    }
}

impl Transmitter {
    /// Sends bytes, waiting a bounded time for each; false if the port did not take them all.
    #[must_use]
    pub fn write(&mut self, bytes: &[u8]) -> bool {
        bytes.iter().all(|&byte| {
            let room = (0..POLLS).any(|_| port().sr().read().txe().bit_is_set());
            if room {
                port().dr().write(|w| {
                    #[expect(unsafe_code, reason = "a raw data byte")]
                    unsafe {
                        w.bits(u16::from(byte))
                    }
                });
            }
            room
        })
    }
}
