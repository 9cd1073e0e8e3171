//! The link over USART6: PC6 out, PC7 in, 500 kbaud, 8N1.
//!
//! 500 kbaud divides every clock that bring-up can arrive at without remainder. It carries about 1,000 exchanges a second; the
//! sample period of a bench on this link is 1 ms.
//!
//! On silicon DMA2's stream 1 (channel 5, RM0090 table 43) stores what comes in in a circular buffer: 20 ms of a full line, without
//! an interrupt a byte. The interrupt then comes for bytes with errors only. The emulator has no DMA; there it comes for every byte.

use core::sync::atomic::{AtomicU8, Ordering};

use link::LineErrors;
use stm32f4xx_hal::pac::{DMA2, USART6};

use crate::boards::Came;
use crate::boards::ring::Ring;

/// Line speed, baud.
pub(in crate::boards) const BAUD: u32 = 500_000;

/// Polls for room in the transmitter before a byte is given up: some 20 byte times at 168 MHz.
const POLLS: u32 = 20_000;
/// Bytes of the buffer.
const LENGTH: usize = 1024;
/// Stream and channel of what USART6 receives.
const STREAM: usize = 1;
const CHANNEL: u8 = 5;

/// What DMA writes to. In the main RAM: DMA does not reach the core-coupled one.
static BUFFER: [AtomicU8; LENGTH] = [const { AtomicU8::new(0) }; LENGTH];

/// The receiving half, for the interrupt.
pub struct Receiver {
    /// Whether every byte comes by interrupt.
    bytes: bool,
}

/// The receiving half, for the link's loop.
pub struct Inbox {
    /// None without DMA.
    stream: Option<DMA2>,
    ring: Ring<LENGTH>,
}

/// The sending half.
pub struct Transmitter(());

/// Sets the port up for a peripheral clock of `bus_hz`, receiving by DMA or by interrupt. The clocks of both and the pins must be on.
pub(in crate::boards) fn set_up(
    port: USART6,
    dma: DMA2,
    bus_hz: u32,
    by_dma: bool,
) -> (Receiver, Inbox, Transmitter) {
    // At 16-fold oversampling the register holds the clock over the baud rate, fraction included.
    let divider = u16::try_from(bus_hz / BAUD).unwrap_or(u16::MAX);
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
    let inbox = Inbox { stream: by_dma.then_some(dma), ring: Ring::new() };
    (Receiver { bytes: !by_dma }, inbox, Transmitter(()))
}

/// Starts the stream at the front of the buffer.
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
    /// What has come. Reading it clears the interrupt and any line error.
    pub fn fetch(&mut self) -> Came {
        let status = port().sr().read();
        let (overrun, framing, noise) = (status.ore().bit(), status.fe().bit(), status.nf().bit());
        let full = self.bytes && status.rxne().bit();
        let mut came = Came::default();
        if full || overrun || framing || noise {
            let [low, ..] = port().dr().read().bits().to_le_bytes();
            came.byte = full.then_some(low);
        }
        came.errors =
            LineErrors { overruns: overrun.into(), framing: framing.into(), noise: noise.into() };
        came
    }
}

impl Inbox {
    /// The next byte that has come, where they come by DMA.
    pub fn take(&mut self) -> Option<u8> {
        let dma = self.stream.as_ref()?;
        let stream = dma.st(STREAM);
        if !stream.cr().read().en().bit() {
            // It stops by itself after a bus error only.
            start(dma);
        }
        let place = || LENGTH.saturating_sub(stream.ndtr().read().ndt().bits().into()) % LENGTH;
        // Between two readings of the place that go on in the buffer it has not come round, so that its flag belongs to both.
        let mut came_round = false;
        let mut before = place();
        for _ in 0..2 {
            if dma.lisr().read().tcif1().bit() {
                dma.lifcr().write(|w| w.ctcif1().set_bit());
                came_round = true;
            }
            let now = place();
            if now >= before {
                self.ring.look(now, came_round);
                break;
            }
            before = now;
        }
        self.ring.take().and_then(|place| BUFFER.get(place)).map(|byte| byte.load(Ordering::Relaxed))
    }

    /// Bytes that were written over before they were taken.
    pub fn lost(&self) -> u32 {
        self.ring.lost()
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
