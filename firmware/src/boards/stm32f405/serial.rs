//! The link over USART6: PC6 out, PC7 in, 500 kbaud, 8N1.
//!
//! 500 kbaud divides every possible clock without remainder. It carries about 1,000 exchanges per
//! second; the sample period of a bench on this link is 1 ms.
//!
//! On silicon stream 1 of DMA2 (channel 5, RM0090 table 43) stores received bytes in a circular
//! buffer of 20 ms, without an interrupt per byte. Then the interrupt reports bytes with errors
//! only. The emulator has no DMA; there every byte causes an interrupt.

use controller::boards::LINK_BAUD;
use core::sync::atomic::AtomicU8;

use link::LineErrors;
use stm32f4xx_hal::pac::{DMA2, USART6};

use crate::boards::receive_event::ReceiveEvent;
use crate::boards::stm32::{self, LENGTH};

/// Polls for room in the transmitter before a byte is dropped: about 20 byte times at 168 MHz.
const POLLS: u32 = 20_000;
/// DMA stream and channel of USART6 reception.
const STREAM: usize = 1;
const CHANNEL: u8 = 5;

/// Buffer that DMA writes. It is in the main RAM: DMA cannot reach the core-coupled memory.
static BUFFER: [AtomicU8; LENGTH] = [const { AtomicU8::new(0) }; LENGTH];

/// Receiving half for the interrupt.
pub struct Receiver {
    /// True if every byte arrives by interrupt.
    bytes: bool,
}

/// Receiving half for the link service.
pub(in crate::boards) type Inbox = stm32::Inbox<Stream>;

/// DMA stream of reception.
pub struct Stream(DMA2);

/// Sending half.
pub struct Transmitter(());

/// Sets up the port for a peripheral clock of `bus_hz`, receiving by DMA or by interrupt. The
/// clocks of both and the pins must be enabled.
pub(in crate::boards) fn set_up(
    port: USART6,
    dma: DMA2,
    bus_hz: u32,
    by_dma: bool,
) -> (Receiver, Inbox, Transmitter) {
    // At 16-fold oversampling the register holds the clock over the baud rate, fraction included.
    let divider = u16::try_from(bus_hz / LINK_BAUD).unwrap_or(u16::MAX);
    port.brr().write(|w| {
        #[expect(unsafe_code, reason = "the whole divider, mantissa and fraction, in one")]
        unsafe {
            w.bits(divider)
        }
    });
    let stream = by_dma.then_some(Stream(dma));
    if let Some(stream) = &stream {
        stm32::Stream::start(stream);
        port.cr3().write(|w| w.dmar().set_bit().eie().set_bit());
    }
    port.cr1().write(|w| w.ue().set_bit().te().set_bit().re().set_bit().rxneie().bit(!by_dma));
    (Receiver { bytes: !by_dma }, Inbox::new(stream, &BUFFER), Transmitter(()))
}

impl stm32::Stream for Stream {
    fn start(&self) {
        let stream = self.0.st(STREAM);
        self.0.lifcr().write(|w| {
            w.cfeif1().set_bit().cdmeif1().set_bit().cteif1().set_bit().chtif1().set_bit().ctcif1().set_bit()
        });
        #[expect(unsafe_code, reason = "addresses of the port's data and of a buffer that is there for good")]
        unsafe {
            stream.par().write(|w| w.bits(port().dr().as_ptr() as u32));
            stream.m0ar().write(|w| w.bits(BUFFER.as_ptr() as u32));
            stream.ndtr().write(|w| w.ndt().bits(LENGTH as u16));
            stream.cr().write(|w| w.chsel().bits(CHANNEL).circ().set_bit().minc().set_bit().pl().high());
        }
        stream.cr().modify(|_, w| w.en().set_bit());
    }

    fn is_running(&self) -> bool {
        self.0.st(STREAM).cr().read().en().bit()
    }

    fn position(&self) -> usize {
        LENGTH.saturating_sub(self.0.st(STREAM).ndtr().read().ndt().bits().into()) % LENGTH
    }

    fn take_wrap(&self) -> bool {
        let has_wrapped = self.0.lisr().read().tcif1().bit();
        if has_wrapped {
            self.0.lifcr().write(|w| w.ctcif1().set_bit());
        }
        has_wrapped
    }
}

fn port() -> &'static stm32f4xx_hal::pac::usart6::RegisterBlock {
    #[expect(unsafe_code, reason = "the halves own the port: one reads DR, the other writes it")]
    unsafe {
        &*USART6::ptr()
    }
}

impl Receiver {
    /// Reads the received byte and its errors. Reading clears the interrupt and the errors.
    pub(in crate::boards) fn fetch(&mut self) -> ReceiveEvent {
        let status = port().sr().read();
        let (overrun, framing, noise) = (status.ore().bit(), status.fe().bit(), status.nf().bit());
        let full = self.bytes && status.rxne().bit();
        let mut event = ReceiveEvent::default();
        if full || overrun || framing || noise {
            let [low, ..] = port().dr().read().bits().to_le_bytes();
            event.byte = full.then_some(low);
        }
        event.errors = LineErrors { overruns: overrun.into(), framing: framing.into(), noise: noise.into() };
        event
    }
}

impl Transmitter {
    /// Sends bytes, with a timeout for each. Returns false if the port did not take all.
    #[must_use]
    pub(in crate::boards) fn write(&mut self, bytes: &[u8]) -> bool {
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
