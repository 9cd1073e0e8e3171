//! The link over USART6: PC6 out, PC7 in, 500 kbaud, 8N1.
//!
//! 500 kbaud divides every possible clock without remainder. It carries about 1,000 exchanges per
//! second; the sample period of a bench on this link is 1 ms.
//!
//! On silicon stream 1 of DMA2 (channel 5, RM0090 table 43) stores received bytes in a circular
//! buffer of 20 ms, without an interrupt per byte. Then the interrupt reports bytes with errors
//! only. The emulator has no DMA; there every byte causes an interrupt.

use controller::boards::LINK_BAUD;
use core::sync::atomic::{AtomicU8, Ordering};

use link::LineErrors;
use stm32f4xx_hal::pac::{DMA2, USART6};

use crate::boards::receive_event::ReceiveEvent;
use controller::buffers::dma_ring::DmaRing;

/// Polls for room in the transmitter before a byte is dropped: about 20 byte times at 168 MHz.
const POLLS: u32 = 20_000;
/// Length of the buffer, bytes.
const LENGTH: usize = 1024;
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
pub struct Inbox {
    /// `None` without DMA.
    stream: Option<DMA2>,
    ring: DmaRing<LENGTH>,
}

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
    if by_dma {
        start(&dma);
        port.cr3().write(|w| w.dmar().set_bit().eie().set_bit());
    }
    port.cr1().write(|w| w.ue().set_bit().te().set_bit().re().set_bit().rxneie().bit(!by_dma));
    let inbox = Inbox { stream: by_dma.then_some(dma), ring: DmaRing::new() };
    (Receiver { bytes: !by_dma }, inbox, Transmitter(()))
}

/// Starts the stream at index 0 of the buffer.
fn start(dma: &DMA2) {
    let stream = dma.st(STREAM);
    dma.lifcr().write(|w| {
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

impl Inbox {
    /// Takes the next byte that DMA has stored.
    pub(in crate::boards) fn take(&mut self) -> Option<u8> {
        let dma = self.stream.as_ref()?;
        let stream = dma.st(STREAM);
        if !stream.cr().read().en().bit() {
            // The stream stops by itself only after a bus error.
            start(dma);
        }
        let position = || LENGTH.saturating_sub(stream.ndtr().read().ndt().bits().into()) % LENGTH;
        // If the position has not decreased between two readings, no wrap lies between them, so
        // that the flag belongs to both.
        let mut has_wrapped = false;
        let mut before = position();
        for _ in 0..2 {
            if dma.lisr().read().tcif1().bit() {
                dma.lifcr().write(|w| w.ctcif1().set_bit());
                has_wrapped = true;
            }
            let now = position();
            if now >= before {
                self.ring.update(now, has_wrapped);
                break;
            }
            before = now;
        }
        self.ring.take().and_then(|position| BUFFER.get(position)).map(|byte| byte.load(Ordering::Relaxed))
    }

    /// Returns the number of bytes that were overwritten before they were taken.
    pub(in crate::boards) fn lost(&self) -> u32 {
        self.ring.lost()
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
