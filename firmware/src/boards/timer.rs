//! Time: SysTick paces the loop, and something counts the work of a tick.
//!
//! | where | SysTick | count |
//! |---|---|---|
//! | silicon, or serial link | 10 kHz | the core's cycle counter |
//! | emulator, lockstep | full 24 bits: 10 Hz | SysTick itself, wrap removed |
//!
//! In lockstep nothing is paced: a frame is a tick. SysTick still runs, because the emulator stops without an active timer. With
//! `-icount shift=6` an instruction takes 64 ns, which SysTick at 168 MHz sees as 10.752 ticks; work of up to 1.5 million instructions is
//! counted right. The emulator has no cycle counter; there the count over the serial link is 0.

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{DCB, DWT, SCB, SYST};

use crate::session::TickSource;

/// Timer ticks a second when SysTick paces the loop.
pub const TICKS_PER_SECOND: u32 = 10_000;

const FULL: u32 = 0x00FF_FFFF;

/// The counter of a tick's work.
#[derive(Clone, Copy, Debug)]
pub enum Timer {
    /// SysTick's 24 bits, counting down.
    SysTick,
    /// The core's cycle counter.
    Cycles,
}

impl Timer {
    /// Starts SysTick and the cycle counter.
    pub(super) fn start(mut syst: SYST, mut dcb: DCB, mut dwt: DWT, core_hz: u32, paced: bool) -> Self {
        syst.set_clock_source(SystClkSource::Core);
        syst.set_reload(if paced { (core_hz / TICKS_PER_SECOND).saturating_sub(1) } else { FULL });
        syst.clear_current();
        syst.enable_counter();
        syst.enable_interrupt();
        dcb.enable_trace();
        dwt.enable_cycle_counter();
        if paced { Self::Cycles } else { Self::SysTick }
    }
}

impl TickSource for Timer {
    fn start(&mut self) -> u32 {
        match self {
            Self::SysTick => SYST::get_current(),
            Self::Cycles => DWT::cycle_count(),
        }
    }

    fn since(&mut self, start: u32) -> u32 {
        match self {
            Self::SysTick => start.wrapping_sub(SYST::get_current()) & FULL,
            Self::Cycles => DWT::cycle_count().wrapping_sub(start),
        }
    }
}

/// Whether the next timer tick is already waiting: the work of this one came too late.
#[must_use]
pub fn tick_is_pending() -> bool {
    SCB::is_pendst_pending()
}
