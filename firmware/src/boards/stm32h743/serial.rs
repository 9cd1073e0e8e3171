//! The link over USART3: PD8 out, PD9 in, 500 kbaud, 8N1. On a Nucleo board these pins lead to the
//! serial port of the debugger.
//!
//! The port's clock is the internal oscillator of 64 MHz, 128 times the baud rate. Its error of 1 %
//! is less than half of what a serial port tolerates.
//!
//! Stream 0 of DMA1 (request 45 of DMAMUX1, RM0433 table 121) stores received bytes in a circular
//! buffer of 20 ms. DMA1 cannot reach the data TCM, so the buffer is in SRAM1, which the data cache
//! leaves out. The interrupt reports bytes with errors only.

use controller::boards::LINK_BAUD;
use controller::clock::ClockPort;
use core::sync::atomic::{AtomicU8, Ordering};

use link::LineErrors;
use stm32h7::stm32h743v::{DMA1, DMAMUX1, USART3, usart1};

use super::clock_tree::ClockTree;
use crate::boards::receive_event::ReceiveEvent;
use crate::boards::stm32::{self, LENGTH};

/// Polls for room in the transmitter before a byte is dropped: about 20 byte times at 480 MHz.
const POLLS: u32 = 20_000;
/// DMA stream of reception.
const STREAM: usize = 0;

/// Buffer that DMA writes.
#[expect(unsafe_code, reason = "the section of the memory that DMA can reach")]
#[unsafe(link_section = ".dma.received")]
static BUFFER: [AtomicU8; LENGTH] = [const { AtomicU8::new(0) }; LENGTH];

/// Receiving half for the interrupt.
pub struct Receiver(());

/// Receiving half for the link service.
pub(in crate::boards) type Inbox = stm32::Inbox<Stream>;

/// DMA stream of reception.
pub struct Stream(DMA1);

/// Sending half.
pub struct Transmitter(());

/// Sets up the port. The clocks of port, DMA and buffer, and the pins, must be enabled.
pub(super) fn set_up(port: USART3, dma: DMA1, requests: &DMAMUX1) -> (Receiver, Inbox, Transmitter) {
    for byte in &BUFFER {
        // Start-up leaves this memory alone.
        byte.store(0, Ordering::Relaxed);
    }
    requests.ccr(STREAM).write(|w| w.dmareq_id().usart3_rx_dma());
    let stream = Stream(dma);
    stm32::Stream::start(&stream);
    let divider = u16::try_from(ClockTree::INTERNAL_HZ / LINK_BAUD).unwrap_or(u16::MAX);
    port.brr().write(|w| w.brr().set(divider));
    port.cr3().write(|w| w.dmar().set_bit().eie().set_bit());
    port.cr1().write(|w| w.ue().set_bit().te().set_bit().re().set_bit());
    (Receiver(()), Inbox::new(Some(stream), &BUFFER), Transmitter(()))
}

fn port() -> &'static usart1::RegisterBlock {
    #[expect(unsafe_code, reason = "the halves own the port: one reads its status, the other sends")]
    unsafe {
        &*USART3::ptr()
    }
}

impl stm32::Stream for Stream {
    fn start(&self) {
        let stream = self.0.st(STREAM);
        self.0.lifcr().write(|w| {
            w.cfeif0().set_bit().cdmeif0().set_bit().cteif0().set_bit().chtif0().set_bit().ctcif0().set_bit()
        });
        #[expect(unsafe_code, reason = "addresses of the port's data and of a buffer that is there for good")]
        unsafe {
            stream.par().write(|w| w.bits(port().rdr().as_ptr() as u32));
            stream.m0ar().write(|w| w.bits(BUFFER.as_ptr() as u32));
        }
        stream.ndtr().write(|w| w.ndt().set(LENGTH as u16));
        // Without buffered transfers the stream can lock up with this port (errata sheet ES0392).
        stream.cr().write(|w| w.circ().set_bit().minc().set_bit().pl().high().trbuff().set_bit());
        stream.cr().modify(|_, w| w.en().set_bit());
    }

    fn is_running(&self) -> bool {
        self.0.st(STREAM).cr().read().en().bit()
    }

    fn position(&self) -> usize {
        LENGTH.saturating_sub(self.0.st(STREAM).ndtr().read().ndt().bits().into()) % LENGTH
    }

    fn take_wrap(&self) -> bool {
        let has_wrapped = self.0.lisr().read().tcif0().bit();
        if has_wrapped {
            self.0.lifcr().write(|w| w.ctcif0().set_bit());
        }
        has_wrapped
    }
}

impl Receiver {
    /// Reads and clears the errors.
    pub(in crate::boards) fn fetch(&mut self) -> ReceiveEvent {
        let status = port().isr().read();
        port()
            .icr()
            .write(|w| w.orecf().clear_bit_by_one().fecf().clear_bit_by_one().ncf().clear_bit_by_one());
        let errors = LineErrors {
            overruns: status.ore().bit().into(),
            framing: status.fe().bit().into(),
            noise: status.nf().bit().into(),
        };
        ReceiveEvent { byte: None, errors }
    }
}

impl Transmitter {
    /// Sends bytes, with a timeout for each. Returns false if the port did not take all.
    #[must_use]
    pub(in crate::boards) fn write(&mut self, bytes: &[u8]) -> bool {
        bytes.iter().all(|&byte| {
            let room = (0..POLLS).any(|_| port().isr().read().txe().bit_is_set());
            if room {
                port().tdr().write(|w| w.tdr().set(byte.into()));
            }
            room
        })
    }
}
